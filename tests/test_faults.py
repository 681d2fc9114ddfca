"""Killed, stopped and interrupted runs: the right exit code, the results so far readable, no process left behind."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import shared.awake
from shared.contract import ParticipantLost
from shared.run.checkpoint import newest
from shared.run.vtkhdf import read_frame
from tests.scenes import tiny_coupled

START_WITHIN_S = 100.0  # a first run compiles
pytestmark = pytest.mark.timeout(180)


def children(pid: int) -> dict[str, int]:
    """Process ids of a coupler's solvers, by package."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
                command = (entry / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if parent == pid:
                found |= {n: int(entry.name) for n in ("fluid_solver", "solid_solver") if n.encode() in command}
    return found


def gone(pid: int) -> bool:
    """Whether the process has ended (a zombie has)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def all_gone(pids, within: float) -> bool:
    deadline = time.monotonic() + within
    while time.monotonic() < deadline:
        if all(map(gone, pids)):
            return True
        time.sleep(0.1)
    return False


@pytest.fixture
def running(tmp_path):
    """A coupled run that has passed its first windows: the coupler's process, its solvers' pids, the run directory."""
    out = tmp_path / "run"
    command = [sys.executable, "-m", "coupler", "run", str(tiny_coupled(tmp_path, end_time=60.0)), "--out", str(out)]
    command += ["--threads", "fluid=1,solid=1", "--set", "output.frames=10000", "--set", "output.probe_interval=0.005"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for_rows(process, out)
    solvers = children(process.pid)
    assert set(solvers) == {"fluid_solver", "solid_solver"}
    yield process, solvers, out
    for pid in [process.pid, *solvers.values()]:
        if not gone(pid):
            os.kill(pid, signal.SIGKILL)
    process.communicate()


def wait_for_rows(process, out: Path) -> None:
    """Until the run has written a few rows of probes."""
    probes, deadline = out / "probes.csv", time.monotonic() + START_WITHIN_S
    while not (probes.exists() and probes.read_text().count("\n") > 5):
        assert process.poll() is None, process.communicate()[1]
        assert time.monotonic() < deadline, "the run did not start"
        time.sleep(0.2)


def ended(process) -> tuple[int, str]:
    """Exit code and error text."""
    _, errors = process.communicate(timeout=60.0)
    assert "Traceback" not in errors
    return process.returncode, errors


def readable(out: Path) -> dict:
    """The result, after a look at everything else in the run directory."""
    for side in ("fluid", "solid"):
        now, frame = read_frame(out / f"{side}.vtkhdf")
        assert now > 0.0
        assert len(frame.position) > 0
    assert (out / "ledger.csv").read_text().count("\n") > 2
    return json.loads((out / "result.json").read_text())


@pytest.mark.parametrize("victim", ["fluid", "solid"])
def test_killed_solver(running, victim):
    process, solvers, out = running
    os.kill(solvers[f"{victim}_solver"], signal.SIGKILL)
    code, errors = ended(process)
    assert code == 4
    assert f"{victim} solver" in errors
    assert "killed by signal 9" in errors
    assert "(empty)" not in errors
    assert f"coupler resume {out}\n" in errors
    assert readable(out)["status"] == "lost"
    assert all_gone(solvers.values(), within=10.0)


def test_nobody_compiles_for_a_run_that_was_killed(tmp_path):
    command = [sys.executable, "-m", "coupler", "run", str(tiny_coupled(tmp_path)), "--out", str(tmp_path / "run")]
    empty = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    process, deadline, compiling = subprocess.Popen(command, env=empty), time.monotonic() + START_WITHIN_S, {}
    while len(compiling) < 2 and time.monotonic() < deadline:
        time.sleep(0.05)
        compiling = children(process.pid)
    process.kill()
    process.wait()
    assert len(compiling) == 2
    assert all_gone(compiling.values(), within=15.0)


def test_interrupted_run(running):
    process, solvers, out = running
    process.send_signal(signal.SIGINT)
    code, errors = ended(process)
    assert code == 130
    assert f"coupler resume {out}\n" in errors
    result = readable(out)
    assert result["status"] == "interrupted"
    assert result["t_end"] > 0.0
    assert result["probes"]["mid_y"]["final"] is not None
    assert newest(out).time == result["t_end"]  # nothing is lost to one that goes on
    assert all_gone(solvers.values(), within=10.0)


@pytest.mark.parametrize("words", ["fluid_solver run dam_break", "coupler run udl_beam --models auto --force"])
def test_an_interrupted_side_alone_keeps_all_it_has(tmp_path, words):
    out = tmp_path / "run"
    command = [sys.executable, "-m", *words.split(), "--out", str(out), "--set", "end_time=600"]
    command += ["--set", "references=[]", "--set", "output.probe_interval=0.01"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        wait_for_rows(process, out)
        process.send_signal(signal.SIGINT)
        code, errors = ended(process)
    finally:
        for pid in [*children(process.pid).values(), process.pid]:
            if not gone(pid):
                os.kill(pid, signal.SIGKILL)
    assert code == 130
    assert "stopping after this window" in errors
    assert f"coupler resume {out}\n" in errors
    result = json.loads((out / "result.json").read_text())
    assert result["status"] == "interrupted"
    assert newest(out).time == result["t_end"] > 0.0


def test_killed_coupler_leaves_no_solver(running):
    process, solvers, _ = running
    process.kill()
    process.wait()
    assert all_gone(solvers.values(), within=15.0)


SOON = "import shared.awake; shared.awake.PAUSE_S = 3.0; from coupler.cli import main; main()"
"""The coupler, which bears shorter pauses than it otherwise does."""


@pytest.fixture
def starting(tmp_path):
    """Starts a coupled run; returns the coupler's process and its solvers' pids as they appear."""
    started = []

    def start():
        words = ["run", str(tiny_coupled(tmp_path, end_time=60.0)), "--out", str(tmp_path / "run")]
        command = [sys.executable, "-c", SOON, *words, "--threads", "fluid=1,solid=1", "--quiet"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        started.append(process.pid)
        deadline = time.monotonic() + START_WITHIN_S
        while len(solvers := serving(process.pid)) < 2:
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < deadline, "the solvers did not start"
            time.sleep(0.02)
        started.extend(solvers.values())
        return process, solvers

    yield start
    for pid in started:
        if not gone(pid):
            os.kill(pid, signal.SIGKILL)


def serving(pid: int) -> dict[str, int]:
    """Those of a coupler's children that are to serve it, not to compile."""
    found = children(pid)
    return {n: p for n, p in found.items() if b"serve" in Path(f"/proc/{p}/cmdline").read_bytes().split(b"\0")}


@pytest.mark.parametrize(("side", "after"), [("fluid", 0.0), ("solid", 2.5)])
def test_a_solver_that_is_stopped_as_it_starts_ends_the_run(starting, side, after):
    process, solvers = starting()
    time.sleep(after)
    os.kill(solvers[f"{side}_solver"], signal.SIGSTOP)
    begun = time.monotonic()
    code, errors = ended(process)
    assert (code, time.monotonic() - begun < 15.0) == (4, True)
    assert f"the {side} solver" in errors
    assert "has been stopped for 3 s" in errors
    assert all_gone(solvers.values(), within=5.0)


def test_a_run_of_stopped_solvers_can_be_interrupted(starting):
    process, solvers = starting()
    for pid in solvers.values():
        os.kill(pid, signal.SIGSTOP)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    assert all_gone([process.pid, *solvers.values()], within=5.0)
    assert ended(process)[0] == 130


def test_a_run_whose_solver_is_stopped_stops_at_once_when_asked_twice(running):
    process, solvers, out = running
    os.kill(solvers["solid_solver"], signal.SIGSTOP)
    time.sleep(0.5)
    for _ in range(2):
        process.send_signal(signal.SIGINT)
        time.sleep(1.5)
    assert all_gone([process.pid, *solvers.values()], within=6.0)
    code, errors = ended(process)
    assert code == 130
    assert "ask again to stop at once" in errors
    assert readable(out)["status"] == "interrupted"


def test_a_solver_that_is_killed_as_it_starts_had_not_begun(starting):
    process, solvers = starting()
    os.kill(solvers["solid_solver"], signal.SIGKILL)
    code, errors = ended(process)
    assert code == 4
    assert "was killed by signal 9; it had not begun yet" in errors


def test_a_run_bears_pauses_of_either_side(running):
    """Longer ones than the lease that zenoh has by default."""
    process, solvers, out = running
    for pid in (solvers["solid_solver"], process.pid):
        os.kill(pid, signal.SIGSTOP)
        time.sleep(12.0)
        os.kill(pid, signal.SIGCONT)
        rows, deadline = (out / "probes.csv").read_text().count("\n"), time.monotonic() + 10.0
        while (out / "probes.csv").read_text().count("\n") < rows + 5:
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < deadline, "the run does not go on"
            time.sleep(0.2)


def test_a_child_that_compiles_and_is_stopped_is_named(monkeypatch):
    monkeypatch.setattr(shared.awake, "PAUSE_S", 0.5)
    child = subprocess.Popen(["sleep", "60"])
    try:
        child.send_signal(signal.SIGSTOP)
        with pytest.raises(ParticipantLost, match=r"compiles .* has been stopped"):
            shared.awake.wait_for({"compiles the fluid side": child})
    finally:
        child.kill()
        child.wait()


@pytest.mark.slow
def test_stopped_solver_is_noticed(running):
    process, solvers, out = running
    os.kill(solvers["solid_solver"], signal.SIGSTOP)
    code, errors = ended(process)
    assert code == 4
    assert "has been stopped for 20 s" in errors
    assert readable(out)["status"] == "lost"
    assert all_gone(solvers.values(), within=10.0)
