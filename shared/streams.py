"""Standard output and error that nobody needs to listen to: a terminal that was closed, a pipe whose reader has ended
or a full disk behind them takes what is said, and ends no run."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys


class _Unheard(io.FileIO):
    """A file whose writes never fail; the first error other than of a reader that has gone is kept in `lost`."""

    lost: OSError | None = None

    def write(self, data) -> int:
        try:
            return super().write(data)
        except OSError as error:
            if error.errno not in (errno.EPIPE, errno.EIO):  # a pipe without a reader, a terminal that was closed
                self.lost = self.lost or error
            return len(data)


def open_streams() -> None:
    """To be called before anything opens a file: a standard stream that is closed leads nowhere from now on, so that
    no file of a run gets its number, and what is said in vain ends nothing."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    sys.stdout, sys.stderr = _stream(1, sys.stdout), _stream(2, sys.stderr)


def _stream(number: int, like: io.TextIOWrapper | None) -> io.TextIOWrapper:
    options = {} if like is None else {k: getattr(like, k) for k in ("encoding", "line_buffering", "write_through")}
    return io.TextIOWrapper(io.BufferedWriter(_Unheard(number, "w", closefd=False)), **options)


def say(text: str) -> None:
    """Print a line on standard error, at once."""
    print(text, file=sys.stderr, flush=True)


def lost_output() -> OSError | None:
    """Why not all that was printed has arrived where somebody could read it, if so."""
    with contextlib.suppress(AttributeError):  # not one of ours
        sys.stdout.flush()
        return sys.stdout.buffer.raw.lost
    return None
