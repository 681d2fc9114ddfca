"""Time slices, by which a thread that has been woken for a moment need not wait for those that compute.

A core goes to whoever has slept as soon as he asks for a shorter slice than the one who computes (Linux 6.12 and on);
else only when that one's slice is over, which may be as long as a window takes.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys

SHORTEST = 1e-4  # s; what Linux grants
_SCHED_SETATTR = {"x86_64": 314, "aarch64": 274, "riscv64": 274}
"""Number of the system call: no library of Python's has it."""
_ATTRIBUTES = struct.Struct("=IIQiIQQQ")
"""Size, policy (0: the common one), flags, nice, priority, slice [ns], and two of no meaning here."""


def set_slice(seconds: float) -> None:
    """Ask for time slices of `seconds` for the calling thread and for those that it starts; 0 for the system's own.

    Does nothing on a system that has no such thing.
    """
    number = _SCHED_SETATTR.get(platform.machine()) if sys.platform == "linux" else None
    if number is not None:
        nice = os.getpriority(os.PRIO_PROCESS, 0)  # stays as it is
        attributes = _ATTRIBUTES.pack(_ATTRIBUTES.size, 0, 0, nice, 0, round(1e9 * seconds), 0, 0)
        ctypes.CDLL(None).syscall(number, 0, attributes, 0)
