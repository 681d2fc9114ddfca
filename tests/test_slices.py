"""Time slices: those who are woken for a moment ask for short ones, those who compute keep the system's."""

from __future__ import annotations

import ctypes
import os
import platform
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from shared.slices import SHORTEST, set_slice
from tests.scenes import tiny_coupled

_GETATTR = {"x86_64": 315, "aarch64": 275, "riscv64": 275}
_KNOWN = sys.platform == "linux" and platform.machine() in _GETATTR


def slice_of(thread: int) -> float:
    """Time slice [s] of a thread by its number; 0 for the calling one."""
    attributes = (ctypes.c_uint64 * 7)()
    ctypes.CDLL(None).syscall(_GETATTR[platform.machine()], thread, attributes, ctypes.sizeof(attributes), 0)
    return 1e-9 * attributes[3]


def granted() -> bool:
    """Whether this system gives threads slices of their own."""
    found = []
    thread = threading.Thread(target=lambda: (set_slice(SHORTEST), found.append(slice_of(0))))
    thread.start()
    thread.join()
    return found == [pytest.approx(SHORTEST)]


needs_slices = pytest.mark.skipif(not _KNOWN or not granted(), reason="the system gives no slices to threads")


def test_a_slice_can_be_asked_for_anywhere():
    thread = threading.Thread(target=lambda: [set_slice(seconds) for seconds in (SHORTEST, 0.0)])
    thread.start()
    thread.join()


@needs_slices
def test_threads_inherit_the_slice_of_who_starts_them():
    found = []

    def starts():
        set_slice(SHORTEST)
        child = threading.Thread(target=lambda: found.append(slice_of(0)))
        child.start()
        child.join()
        set_slice(0.0)
        found.append(slice_of(0))

    thread = threading.Thread(target=starts)
    thread.start()
    thread.join()
    assert found[0] == pytest.approx(SHORTEST)
    assert found[1] > 2.0 * SHORTEST


@needs_slices
@pytest.mark.timeout(120)
def test_of_a_coupled_run_all_but_the_fluids_sweeps_are_short(tmp_path):
    """All threads of the structure's process; of the fluid's, those of zenoh."""
    case = tiny_coupled(tmp_path)
    command = [sys.executable, "-m", "coupler", "run", str(case), "--quiet", "--out", str(tmp_path / "run")]
    command += ["--set", "end_time=1000.0", "--threads", "fluid=2", "--set", "output.frames=1"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
        try:
            sides = {}
            while len(sides) < 2 or max(len(os.listdir(f"/proc/{pid}/task")) for pid in sides.values()) < 4:
                time.sleep(0.2)
                assert run.poll() is None
                sides = solvers_of(run.pid)
            time.sleep(2.0)
            slices = {
                side: [slice_of(int(thread.name)) for thread in Path(f"/proc/{pid}/task").iterdir()]
                for side, pid in sides.items()
            }
        finally:
            run.terminate()
            run.wait(30)
    assert max(slices["solid"]) == pytest.approx(SHORTEST)
    assert min(slices["fluid"]) == pytest.approx(SHORTEST)
    assert max(slices["fluid"]) > 2.0 * SHORTEST


def solvers_of(coupler: int) -> dict[str, int]:
    """Process numbers of the two solvers that a coupler has started."""
    children = Path(f"/proc/{coupler}/task/{coupler}/children").read_text().split()
    lines = {pid: Path(f"/proc/{pid}/cmdline").read_bytes() for pid in children}
    sides = ("fluid", "solid")
    return {side: int(pid) for side in sides for pid, line in lines.items() if f"{side}_solver\0serve".encode() in line}
