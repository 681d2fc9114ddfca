"""Paths as words of a command line."""

from __future__ import annotations

from pathlib import Path


def word(path: str | Path) -> str:
    """`path` as an argument of a program, which would take one that begins with a dash for an option."""
    return f"./{path}" if str(path).startswith("-") else str(path)
