"""Pauses: those of this process, which count against nobody, and those of its children, which it bears for a while.

A process is stopped by Ctrl-Z or SIGSTOP, and goes on after `fg` or SIGCONT as if nothing had been.
"""

from __future__ import annotations

import os
import subprocess
import threading
import time
from collections.abc import Mapping

from shared.contract import ParticipantLost

PAUSE_S = 20.0
"""Longest pause of a child that a run bears."""

_LOOK_EVERY_S = 0.2
_LONGEST_STEP_S = 2.0  # between two looks at the clock on a busy machine; the rest of a longer one was a pause


class _Clock:
    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._seconds, self._last = 0.0, time.monotonic()

    def now(self) -> float:
        with self._lock:
            last, self._last = self._last, time.monotonic()
            self._seconds += min(self._last - last, _LONGEST_STEP_S)
            return self._seconds


awake = _Clock().now
"""Time [s] in which this process was not stopped, as far as somebody looks at this clock every second or so."""


class Halt:
    """How long the child process `pid` has been stopped."""

    def __init__(self, pid: int):
        self._pid = pid
        self._since: float | None = None

    def seconds(self) -> float:
        """Time [s] since it was first seen stopped; 0 while it runs."""
        now = awake()
        if not _stopped(self._pid):
            self._since = None
            return 0.0
        self._since = now if self._since is None else self._since
        return now - self._since

    def too_long(self) -> str:
        """What to say where the pause is longer than a run bears; else nothing."""
        if self.seconds() < PAUSE_S:
            return ""
        return (
            f"has been stopped for {PAUSE_S:g} s (SIGSTOP or Ctrl-Z), longer than a run waits for one of its processes"
        )


def wait_for(children: Mapping[str, subprocess.Popen]) -> None:
    """Wait until all children, named by what they do, have ended. Raises ParticipantLost where one is stopped."""
    halts = {name: Halt(child.pid) for name, child in children.items()}
    while any([child.poll() is None for child in children.values()]):
        for name, halt in halts.items():
            if words := halt.too_long():
                raise ParticipantLost(f"the process that {name} ({children[name].pid}) {words}")
        time.sleep(_LOOK_EVERY_S)


def _stopped(pid: int) -> bool:
    """Whether a child is stopped; nobody knows on a system without `waitid`."""
    if not hasattr(os, "waitid"):
        return False
    try:
        return os.waitid(os.P_PID, pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None
    except ChildProcessError:
        return False
