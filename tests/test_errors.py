"""Every mistake and failure that a user can meet: one paragraph, the documented exit code, no traceback, nothing left.

Exit codes: 2 bad input, 3 a solver failed. All through the command lines of the three programs.
"""

from __future__ import annotations

import errno
import json
import os
import resource
import subprocess
import sys
from importlib.resources import files

import pytest

import shared.commands
import shared.solo
from coupler.report import write_report
from shared.run.results import read_result
from tests.scenes import tiny_coupled

PROGRAMS = ("coupler", "fluid_solver", "solid_solver")
FIVE_MISTAKES = """\
schema = 1
title = "Five mistakes"
end_time = -1.0
gravty = [0.0, -9.81]

[fluid]
model = "wcsp"
dx = 4.0e-3
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.1, 0.1] }]

[solid]
model = "total-lagrangian"
dx = 4.0e-3
density = 2500.0
youngs_modulus = 1.0e6
bodies = [{ name = "plate", rectangle = [0.08, 0.0, 0.2, 0.08] }]
"""
# A misspelt key, a negative time, an unknown model, an overlap, a plate without clamp.
FOUND = ("gravty", "end_time = -1.0", "did you mean 'wcsph'", "overlaps", "no clamp")


@pytest.fixture
def command(command):
    """Runs `program run CASE …`; returns exit code and error text."""

    def run(program, *words):
        code, _, errors = command(program, "run", *words)
        assert "Traceback" not in errors
        return code, errors

    return run


def process(program, *words, limit_file=None):
    """Runs `program run …` as a process, which may write files of `limit_file` bytes at most."""

    def limit():
        if limit_file is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit_file, limit_file))

    done = subprocess.run(
        [sys.executable, "-m", program, "run", *map(str, words)],
        capture_output=True,
        text=True,
        timeout=200,
        preexec_fn=limit,
    )
    assert "Traceback" not in done.stdout + done.stderr
    return done.returncode, done.stderr


def processes_naming(text) -> list[str]:
    """Command lines of living processes, other than this one, that hold `text`."""
    lines = subprocess.run(["ps", "-eo", "pid,args"], capture_output=True, text=True, check=True).stdout.splitlines()
    return [
        line for line in lines if str(text) in line and int(line.split()[0]) != os.getpid() and "ps -eo" not in line
    ]


@pytest.mark.parametrize("program", PROGRAMS)
def test_five_mistakes_are_five(command, tmp_path, program):
    scene = tmp_path / "five.toml"
    scene.write_text(FIVE_MISTAKES)
    code, errors = command(program, scene)
    assert code == 2
    assert "5 mistakes" in errors
    assert [word for word in FOUND if word not in errors] == []
    assert os.listdir(tmp_path) == ["five.toml"]


@pytest.mark.parametrize("program", PROGRAMS)
def test_missing_and_unreadable_files(command, tmp_path, program):
    assert command(program, "nowhere.toml")[0] == 2
    code, errors = command(program, "udl_bean")
    assert (code, "did you mean 'udl_beam'" in errors) == (2, True)
    (tmp_path / "broken.toml").write_text("title = = 1")
    code, errors = command(program, "broken.toml")
    assert (code, "not TOML" in errors, "line 1" in errors) == (2, True, True)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    code, errors = command(program, "binary.toml")
    assert (code, "cannot be read" in errors) == (2, True)
    assert command(program, tmp_path)[0] == 2


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["solid.clamps=[]"], ["'plate' has no clamp"]),
        (["solid.bodies.plate.rectangle=[0.1,0.0,0.15,0.08]"], ["overlaps", "water"]),
        (["solid.dx=0.2"], ["larger than body 'plate'", "0.012"]),
        (["fluid.dx=0.5"], ["larger than body 'water'"]),
        (["fluid.dx=1e-9"], ["'water' would hold", "wall 'tank' would hold"]),
        (["walls.tank.polyline=[[0.0,1.0],[0.0,0.0],[0.0,0.0],[0.584,0.0]]"], ["same corner twice"]),
        (["walls.tank.polyline=[[0.0,1.0],[0.0,1e-17],[0.0,0.0],[0.584,0.0]]"], ["corners 1 and 2"]),
        (["walls.tank.polyline=[[0.584,1.0],[0.584,0.0],[0.0,0.0],[0.0,1.0]]"], ["fluid on its left"]),
        (["domain={lower=[1.0,1.0],upper=[0.0,0.0]}"], ["domain: lower"]),
        (["domain={lower=[0.0,0.0],upper=[0.1,0.1]}"], ["'water' reaches out of the domain"]),
        (["solid.bodies.0=[0, 0]"], ["solid.bodies[0] = [0, 0]"]),
        (["fluid.dx=nan"], ["fluid.dx"]),
        (["fluid.dx"], ["write path.to.key=value"]),
        (["fluid.dxx=1"], ["unknown key; did you mean 'dx'"]),
        (["solid.bodies.plat.free=true"], ["no item named 'plat'; did you mean 'plate'"]),
        (["title.x=3"], ["title is a value, not a table"]),
        (['""=3'], ["unknown key"]),
        (["solid.bodies.².free=true"], ["no item named '²'"]),
    ],
)
def test_mistakes_on_the_command_line(command, tmp_path, changes, words):
    code, errors = command("coupler", "dam_break_plate", *(word for text in changes for word in ("--set", text)))
    assert code == 2
    assert [word for word in words if word not in errors] == []
    assert os.listdir(tmp_path) == []


def test_threads_and_directories(command, tmp_path):
    for text in ("fluid=0", "water=1", "fluid=x", "fluid=²", "2"):
        code, errors = command("coupler", "dam_break_plate", "--threads", text)
        assert (code, text in errors) == (2, True)
    code, errors = command("coupler", "dam_break_plate", "--threads", "fluid=0", "--threads", "solid=1")
    assert (code, "fluid=0" in errors) == (2, True)  # given twice, both count
    assert command("fluid_solver", "dam_break", "--threads", "0")[0] == 2
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").touch()
    for program, case in (("coupler", "soft_plate"), ("fluid_solver", "dam_break"), ("solid_solver", "udl_beam")):
        code, errors = command(program, case, "--out", "full")
        assert (code, "not empty" in errors) == (2, True)
    code, errors = command("solid_solver", "udl_beam", "--out", "full/thesis.tex")
    assert (code, "cannot be made" in errors) == (2, True)
    assert os.listdir(tmp_path / "full") == ["thesis.tex"]


@pytest.mark.parametrize(
    ("program", "case", "missing"),
    [
        ("coupler", "dam_break", "[solid]"),
        ("coupler", "udl_beam", "[fluid]"),
        ("fluid_solver", "udl_beam", "[fluid]"),
        ("solid_solver", "dam_break", "[solid]"),
    ],
)
def test_side_that_the_scene_lacks(command, tmp_path, program, case, missing):
    code, errors = command(program, case)
    assert (code, missing in errors) == (2, True)
    assert os.listdir(tmp_path) == []


TOO_MUCH = 'solid.loads=[{body="plate",face="top",traction=[0.0,-1e12]}]'


@pytest.mark.timeout(200)
@pytest.mark.parametrize(
    ("program", "change", "words"),
    [
        ("solid_solver", TOO_MUCH, ["The solid failed at t =", "loads"]),
        ("fluid_solver", "fluid.sound_speed=0.2", ["not weakly compressible", "fluid.sound_speed"]),
    ],
)
def test_side_that_fails_alone(command, tmp_path, program, change, words):
    scene = tiny_coupled(tmp_path, end_time=0.02)
    code, errors = command(program, scene, "--out", "out", "--threads", "1", "--quiet", "--set", change)
    assert code == 3
    assert [word for word in words if word not in errors] == []
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert (result["status"], result["reason"] in errors) == ("failed", True)


@pytest.mark.timeout(400)
@pytest.mark.parametrize(("change", "words"), [(TOO_MUCH, "The solid failed"), ("fluid.sound_speed=0.2", "fluid")])
def test_side_that_fails_in_a_coupled_run(tmp_path, change, words):
    out = tmp_path / "out"
    scene = tiny_coupled(tmp_path, end_time=0.02)
    code, errors = process(
        "coupler", scene, "--out", out, "--threads", "fluid=1,solid=1", "--quiet", "--force", "--set", change
    )
    assert code == 3
    assert words in errors
    result = json.loads((out / "result.json").read_text())
    assert (result["status"], result["reason"] in errors) == ("failed", True)
    assert processes_naming(tmp_path) == []


@pytest.mark.timeout(200)
@pytest.mark.parametrize("program", ["fluid_solver", "solid_solver"])
def test_full_disk(tmp_path, program):
    """Files stop growing at 20 kB, as on a full disk: the frames so far are kept."""
    scene = tiny_coupled(tmp_path, end_time=0.02)
    words = (scene, "--out", tmp_path / "out", "--threads", "1", "--quiet", "--set", "output.frames=100")
    assert process(program, *words[:1], "--out", tmp_path / "warm", *words[3:])[0] == 0  # the cache of compiled code
    code, errors = process(program, *words, limit_file=20_000)
    assert code == 3
    assert "disk may be full" in errors
    assert json.loads((tmp_path / "out" / "result.json").read_text())["status"] == "lost"


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (MemoryError("Unable to allocate 497. MiB"), "memory (Unable to allocate 497. MiB): a larger fluid.dx"),
        (RuntimeError("can't start new thread"), "new thread): end other programs, or allow more processes"),
        (BlockingIOError(errno.EAGAIN, "Try again"), "Try again: end other programs, or allow more processes"),
        (OSError(errno.EMFILE, "Too many open files", "x"), "open files: 'x': end other programs, or allow more"),
    ],
)
def test_no_memory_left(command, monkeypatch, tmp_path, error, words):
    """Nor processes, threads, open files: none of them is what a full disk is, nor what was computed."""

    def refused(*_):
        raise error

    monkeypatch.setattr(shared.solo, "fill_cache", refused)
    code, errors = command("fluid_solver", "dam_break", "--out", tmp_path / "run")
    assert (code, words in errors) == (3, True), errors
    result = read_result(tmp_path / "run")
    assert (result["status"], words in result["reason"]) == ("lost", True)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("import shared.nothing", "No module named 'shared.nothing'"),
        ("raise ValueError('Number of threads')", "Number of threads"),  # numba's, of NUMBA_NUM_THREADS=0
        ("raise MemoryError", "MemoryError"),
    ],
)
def test_a_program_that_cannot_be_loaded_says_so(line, words):
    lines = f"from shared.start import loading\nwith loading():\n    {line}"
    done = subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, timeout=60)
    assert done.returncode == 3
    assert f"error: this program cannot be loaded ({words})" in done.stderr
    assert "Traceback" not in done.stderr


LOADING = """
import signal, sys
from shared.start import loading
with loading():
    signal.raise_signal(signal.{})
print("still here")
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_interrupted_while_loading(name):
    """Ctrl-C, a request to end or a closed terminal in the second or two in which the libraries load."""
    done = subprocess.run([sys.executable, "-c", LOADING.format(name)], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_a_terminal_that_knows_ascii_alone():
    environment = os.environ | {"LC_ALL": "POSIX", "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        [sys.executable, "-m", "coupler", "check", "piston"], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert "\\u" in done.stdout


def test_a_scene_whose_name_is_not_utf_8(command, tmp_path):
    scene = tmp_path / os.fsdecode(b"sz\xfc.toml")
    scene.write_text((files("cases") / "piston.toml").read_text())
    sets = ("end_time=0.01", "references=[]", "output.checkpoint_every=1e-9")
    code, _ = command("coupler", scene, "--link", "inprocess", *(w for text in sets for w in ("--set", text)))
    assert code == 0
    folder = tmp_path / "runs" / scene.stem
    assert read_result(folder)["case"] == scene.stem
    assert write_report(folder).exists()
