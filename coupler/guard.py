"""Runs a command for as long as the process that started it lives: `python -m coupler.guard COMMAND…`.

A chart, or a worker of a cluster, may be killed at any time, and nobody would be left to end the run that it had
started.
"""

from __future__ import annotations

import os
import subprocess
import sys

from shared.start import on_stop_signals

_LOOK_EVERY_S = 0.5
PATIENCE_S = 10.0
"""Between asking a run to end and killing it."""


def end(child: subprocess.Popen, patience: float = PATIENCE_S) -> None:
    """Ask the process to end, then kill it."""
    if child.poll() is None:
        child.terminate()
        try:
            child.wait(patience)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()


def main(command: list[str]) -> int:
    """The command's exit code; 128 and a signal's number where that ended it."""
    parent = os.getppid()
    on_stop_signals(lambda number, frame: sys.exit(128 + number))
    child = subprocess.Popen(command)
    try:
        while os.getppid() == parent:
            try:
                code = child.wait(_LOOK_EVERY_S)
                return code if code >= 0 else 128 - code
            except subprocess.TimeoutExpired:
                continue
        return 1
    finally:
        end(child)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
