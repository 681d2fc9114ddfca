"""Text files that grow line by line, and that a run may go on with."""

from __future__ import annotations

import os
from pathlib import Path

from shared.checkpoint import AGAIN
from shared.contract import BadInput


class Lines:
    """The text file `path`, new, or gone on with behind its first `kept` lines, which are then `first`.

    What such a file holds beyond them goes with the first line written, not before. `buffering` as of `open`. Raises
    BadInput where the file does not hold so many lines.
    """

    def __init__(self, path: Path, kept: int | None = None, buffering: int = -1):
        self._path, self._buffering = path, buffering
        self.first = [] if kept is None else _first_lines(path, kept)
        self._size = sum(len(line.encode()) for line in self.first)
        self._file = self._open("w") if kept is None else None

    def write(self, line: str) -> None:
        """Add a line; raises OSError."""
        if self._file is None:
            os.truncate(self._path, self._size)
            self._file = self._open("a")
        self._file.write(line + "\n")

    def flush(self) -> None:
        """Bring all lines to the disk."""
        if self._file is not None:
            self._file.flush()

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()

    def _open(self, mode: str):
        return self._path.open(mode, buffering=self._buffering, newline="\n", encoding="utf-8")


def _first_lines(path: Path, count: int) -> list[str]:
    try:
        with path.open(newline="\n", encoding="utf-8") as file:
            lines = file.readlines()
    except FileNotFoundError:
        raise BadInput(f"{path} is gone, and had {count} lines at the checkpoint. {AGAIN}") from None
    except (OSError, ValueError) as error:
        raise BadInput(f"{path} cannot be read ({error}): the run cannot go on. {AGAIN}") from None
    if len(lines) < count:
        raise BadInput(f"{path} has {len(lines)} lines, and had {count} at the checkpoint. {AGAIN}")
    return lines[:count]
