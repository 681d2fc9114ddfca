"""Text files that grow line by line, and that a run may go on with."""

from __future__ import annotations

from pathlib import Path

from shared.contract import BadInput
from shared.run.checkpoint import AGAIN
from shared.streams import say


class Lines:
    """The text file `path`, new, or gone on with behind its first `kept` lines, which are then `first`.

    What such a file holds beyond them goes with the first line written, not before. `buffering` as of `open`. Raises
    BadInput where the file does not hold so many lines. A file that another program has cut or removed meanwhile is
    told of when it is closed.
    """

    def __init__(self, path: Path, kept: int | None = None, buffering: int = -1):
        self._path, self._buffering = path, buffering
        self.first = [] if kept is None else _first_lines(path, kept)
        self._size = sum(len(line.encode()) for line in self.first)
        self._file = self._open() if kept is None else None

    def write(self, line: str) -> None:
        """Add a line; raises OSError."""
        if self._file is None:
            self._file = self._open()
        self._file.write(line + "\n")
        self._size += len(line.encode()) + 1

    def flush(self) -> None:
        """Bring all lines to the disk."""
        if self._file is not None:
            self._file.flush()

    def close(self) -> None:
        """Close the file."""
        if self._file is None or self._file.closed:
            return
        self._file.close()
        tell_of_loss(self._path, self._size, "its lines are lost")

    def _open(self):
        """The file as it was after `_size` bytes; what is added stands at its end, wherever others put that."""
        file = self._path.open("a", buffering=self._buffering, newline="\n", encoding="utf-8")
        if file.tell() > self._size:
            file.truncate(self._size)
        return file


def tell_of_loss(path: Path, size: int, consequence: str) -> None:
    """Warn where a file that grows at its end holds less than the `size` bytes written to it."""
    left = path.stat().st_size if path.exists() else 0
    if left < size and path.parent.exists():  # a folder that is gone is told of by who writes there
        say(
            f"warning: {path} holds {left} bytes, and {size} were written to it: another program has removed it or cut "
            f"it short since the run began, and {consequence}."
        )


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
