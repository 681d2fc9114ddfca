"""What the tests of charts share: the loaded beam with another study, and patience."""

from __future__ import annotations

import time
from pathlib import Path

from shared.scene.reading import shipped_cases


def loaded_beam(folder: Path, study: str) -> str:
    """The shipped case udl_beam with the text `study` for its own, written to `folder`."""
    text = shipped_cases()["udl_beam"].read_text(encoding="utf-8").partition("[study]")[0]
    path = folder / "small.toml"
    path.write_text(text + study, encoding="utf-8")
    return str(path)


def wait_until(condition, within_s: float = 60.0) -> None:
    """Wait for what other processes do."""
    end = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.1)
