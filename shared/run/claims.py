"""Claims: one command at a time writes to a run, or makes a chart in a folder.

A claim is the lock of a file of its own: whoever edits a run's case.toml may put another file in its place. It is open
for writing, without which network file systems lock nothing; where a file system knows no locks at all, a warning says
so, and nothing is kept from anybody.
"""

from __future__ import annotations

import fcntl
import time
from pathlib import Path
from typing import TextIO

from shared.contract import BadInput
from shared.streams import say
from shared.unwritable import cannot_write

_PATIENCE_S = 20.0  # the solvers of a coupler that was killed end by themselves within seconds
_LOCK = "run.lock"


def is_free(file: TextIO) -> bool:
    """Whether nobody else has claimed what `file` stands for, which is claimed from now on."""
    try:
        return _locks(file)
    except OSError as error:
        say(
            f"warning: {file.name} cannot be locked, for its file system knows no locks ({error}): see that no two "
            "commands work there at once"
        )
        return True


def is_claimed(run_dir: Path) -> bool:
    """Whether somebody writes to this run, as far as one can tell."""
    try:
        with (run_dir / _LOCK).open(encoding="utf-8") as file:
            return not _locks(file)
    except OSError:  # never claimed, or without locks
        return False


def claim(run_dir: Path) -> TextIO:
    """Keep everybody else from writing to this run until the file returned, and every copy of it that a process
    inherits, is closed. Raises BadInput where somebody else does, ShearwaterError where nobody can."""
    path = run_dir / _LOCK
    try:
        file = path.open("a", encoding="utf-8")
    except OSError as error:
        raise cannot_write("The claim to the run,", path, error) from error
    deadline = time.monotonic() + _PATIENCE_S
    while not is_free(file):
        if time.monotonic() > deadline:
            file.close()
            raise BadInput(f"The run in {run_dir} is still going on in another process; wait for it, or end it.")
        time.sleep(0.1)
    return file


def _locks(file: TextIO) -> bool:
    """Whether nobody else has locked `file`, which is locked from now on. Raises OSError where there are no locks."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True
