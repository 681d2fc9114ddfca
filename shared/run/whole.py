"""Files that are whole or not there."""

from __future__ import annotations

import os
from pathlib import Path

from shared.unwritable import cannot_write


def write_whole(what: str, path: Path, data: bytes, instead: str = "") -> None:
    """Write `data` to the file `path`: all of it or nothing. Raises the error of `cannot_write`, which tells of `what`
    it is and of another way out `instead`."""
    unfinished = path.with_name(path.name + ".tmp")
    try:
        with unfinished.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, path)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise cannot_write(what, path, error, instead) from error
