"""A side of one's own, started by a command: the shipped example couples, goes on, and answers as the shipped model."""

from __future__ import annotations

import json
import sys
from importlib.resources import files
from pathlib import Path

import pytest

import coupler.run
from coupler.chart.runs import command
from coupler.cli import parse_programs
from coupler.run import resume_coupled, run_coupled
from coupler.supervisor import _command
from shared.contract import BadInput, ParticipantLost
from shared.run.probes import ProbeTable, probe_units
from shared.run.resume import unfinished
from shared.scene.reading import load_scene
from tests.test_resume import OFTEN, ONE, cut_short, same_output

SPRING = [sys.executable, str(files("cases") / "participant" / "spring.py")]
SETS = ("end_time=0.1", "coupling.window=5e-3", "references=[]", "output.probe_interval=1e-2", OFTEN)
pytestmark = pytest.mark.timeout(120)


def piston(folder, **how):
    scene = load_scene("piston", SETS)
    return run_coupled(scene, "piston", folder, ONE, True, **how), scene


def histories(folder, scene):
    with ProbeTable(folder / "probes.csv", probe_units(scene), 11) as table:
        return {name: table.values(name) for name in table.units}


def test_the_example_answers_as_the_shipped_model(tmp_path, monkeypatch):
    own, scene = piston(tmp_path / "own", programs={"solid": SPRING})
    piston(tmp_path / "ours", link="inprocess")
    for name, expected in histories(tmp_path / "ours", scene).items():
        assert histories(tmp_path / "own", scene)[name] == pytest.approx(expected, rel=1e-9)
    assert abs(own.result["probes"]["piston_x"]["max"]) > 1e-3
    assert own.result["cost"]["solid"]["model"] == "one-mass"
    assert own.result["cost"]["core_s"] > 0.0
    given = (scene, "piston", tmp_path / "cut", ONE, True, "zenoh", None, {"solid": SPRING})
    cut_short(monkeypatch, coupler.run, "probes", 9, run_coupled, *given)
    resume_coupled(unfinished(tmp_path / "cut"), ONE, "zenoh", True)
    same_output(tmp_path / "own", tmp_path / "cut")


def test_a_command_that_cannot_be_started_is_named(tmp_path):
    with pytest.raises(BadInput, match=r"solid side's command nowhere/spring cannot be started"):
        piston(tmp_path / "run", programs={"solid": ["nowhere/spring"]})
    assert json.loads((tmp_path / "run" / "result.json").read_text())["status"] == "failed"
    with pytest.raises(BadInput, match="leave --link inprocess away"):
        piston(tmp_path / "other", link="inprocess", programs={"solid": SPRING})


def test_a_side_that_ends_before_the_first_checkpoint_leaves_nothing_to_go_on_from(tmp_path):
    with pytest.raises(ParticipantLost, match="there is no checkpoint yet to go on from: run it again from the start"):
        piston(tmp_path / "run", programs={"solid": ["false"]})


def test_a_command_is_taken_apart_as_by_a_shell():
    assert parse_programs(fluid=None, solid="python 'my spring.py' -v") == {"solid": ["python", "my spring.py", "-v"]}
    for text, words in (("", "is empty"), ("python 'x", "is not a command")):
        with pytest.raises(BadInput, match=words):
            parse_programs(solid=text)


def test_a_folder_that_begins_with_a_dash_is_no_option():
    """`--out=-x` ended with a solver's usage."""
    own = _command(["spring"], "solid", "tcp/here", "run", Path("-x"), 1)
    assert own[:3] == ["spring", "serve", "./-x/case.toml"]
    assert command("resume", load_scene("udl_beam"), "-x")[:3] == ["solid_solver", "resume", "./-x"]
    assert command("run", load_scene("udl_beam"), "udl_beam")[2] == "udl_beam"
