"""What one side of a coupled run was told, kept in a file, so that it can be told again without the partner.

A recording is the coupler's requests to that side (wire.py) for the windows as they were accepted, one after the other:
describe, start, then one final advance per window. Each stands behind a head of 16 bytes, little-endian: its length
(8), its CRC-32 (4), and the CRC-32 of these twelve (4), so that a changed byte is told from a file cut short.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from zlib import crc32

from shared.contract import BadInput
from shared.run.checkpoint import AGAIN
from shared.run.lines import tell_of_loss
from shared.wire import Message, encode

RUN = "recorded"
"""Identity of the run in the messages of every recording."""

_HEAD = struct.Struct("<QI")
_SUM = struct.Struct("<I")
BEFORE_WINDOWS = 2  # describe and start


def recording_of(run_dir: Path, side: str) -> Path:
    """File of one side's recording in a run directory."""
    return run_dir / f"{side}.exchange"


class Recorder:
    """Writes the recording `path`. `windows`: go on with the file that is there, behind this many windows."""

    def __init__(self, path: Path, windows: int | None = None):
        self._path = path
        self._sequence = self._size = 0
        self._beyond = windows is not None  # whether the file may hold more than it is gone on behind
        if windows is None:
            self._file = path.open("ab")
            return
        try:
            path.stat()  # one that is gone is not to be made
            self._file = path.open("a+b")
        except OSError as error:
            raise BadInput(f"The recording {path} cannot be gone on with ({error}). {AGAIN}") from error
        self._file.seek(0)
        for _ in range(BEFORE_WINDOWS + windows):
            if not _next(self._file):
                raise BadInput(f"The recording {path} ends after {self._sequence} messages. {AGAIN}")
            self._sequence += 1
        self._size = self._file.tell()

    def add(self, verb: str, **parts) -> None:
        """Add a request; `parts` as of `Message`."""
        if self._beyond:
            self._file.truncate(self._size)
            self._beyond = False
        data = encode(Message(RUN, "coupler", verb, self._sequence, **parts))
        head = _HEAD.pack(len(data), crc32(data))
        self._size += self._file.write(head + _SUM.pack(crc32(head)) + data)
        self._sequence += 1

    def flush(self) -> None:
        """Bring it to the disk."""
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        if not self._beyond:
            tell_of_loss(self._path, self._size, "nothing can be replayed from there on")


def messages(path: Path) -> Iterator[bytes]:
    """The messages of a recording; one cut short at the end is left out. Raises BadInput."""
    try:
        with path.open("rb") as file:
            while data := _next(file):
                yield data
    except OSError as error:
        raise BadInput(
            f"There is no recording to replay ({error}): make one by the coupled run with --set output.exchange=true."
        ) from error


def _next(file) -> bytes:
    """The next whole message, or nothing. Raises BadInput where bytes have been changed."""
    place = file.tell()
    head, own = file.read(_HEAD.size), file.read(_SUM.size)
    if len(own) < _SUM.size:
        return b""
    length, sum_ = _HEAD.unpack(head)
    whole = _SUM.unpack(own)[0] == crc32(head)
    data = file.read(length) if whole else b""
    if whole and len(data) < length:
        return b""
    if not whole or crc32(data) != sum_:
        raise BadInput(
            f"The recording {file.name} is damaged in the message at byte {place}, or another version wrote it: record "
            "the run again, with --set output.exchange=true and --out in a new directory."
        )
    return data
