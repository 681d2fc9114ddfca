"""Pre-flight on the command line: `coupler check`, runs that it refuses, and `--models auto`."""

from __future__ import annotations

import json
import math
from functools import partial

import pytest

from shared.scene.reading import load_scene
from tests.scenes import tiny_coupled


@pytest.fixture
def coupler(command):
    """Runs `coupler …`, see `command`."""
    return partial(command, "coupler")


def test_check_prints_numbers_and_the_smallest_pair(coupler):
    code, out, _ = coupler("check", "udl_beam")
    assert code == 0
    assert "Smallest that meets the goal: beam" in " ".join(out.split())


def test_check_as_json_is_strict_json(coupler):
    code, out, _ = coupler("check", "hydrostatic_plate", "--set", "goal.statistic=min", "--json")
    report = json.loads(out, parse_constant=lambda word: pytest.fail(word))
    assert code == 2
    assert report["verdict"] == "refuse"
    assert report["smallest"] is None
    assert all(f["reason"] for f in report["findings"])


def test_a_refused_scene_does_not_run(coupler, tmp_path):
    case = tiny_coupled(tmp_path)
    code, _, errors = coupler("run", case, "--set", "coupling.window=0.02", "--out", "run")
    assert code == 2
    assert "window α" in errors
    assert "--force" in errors
    assert not (tmp_path / "run").exists()


def test_a_run_keeps_what_was_predicted_and_what_came(coupler, tmp_path):
    case = tiny_coupled(tmp_path, end_time=0.02)
    code, *_ = coupler("run", case, "--out", "run", "--quiet", "--link", "inprocess", "--threads", "fluid=1,solid=1")
    kept = json.loads((tmp_path / "run" / "result.json").read_text())["preflight"]
    assert code == 0
    assert kept["verdict"] == "warn"  # a peak under this water would not be resolved, and nobody said what is wanted
    assert kept["predicted"]["core_s"] > 0.0
    assert kept["actual"]["core_s"] > 0.0
    assert kept["window"] == pytest.approx(kept["predicted"]["window"], rel=0.1)


def test_models_auto_asks_before_it_takes_hours(coupler, tmp_path):
    code, _, errors = coupler("run", "udl_beam", "--models", "auto", "--out", "run", "--set", "goal.error=2.5e-4")
    assert code == 2
    assert "core-hours, more than one and more than the scene as it stands; --force runs it" in errors
    assert not (tmp_path / "run").exists()


def test_models_auto_heeds_refusals_of_one_side(coupler, tmp_path):
    sets = ("--set", "goal.error=1e-12", "--set", "solid.courant=0.9", "--set", "end_time=0.01")
    code, *_ = coupler("run", "spinning_square", "--models", "auto", *sets, "--out", "run")
    assert code == 2
    assert not (tmp_path / "run").exists()


def test_models_auto_runs_the_choice_and_writes_it_down(coupler, tmp_path):
    code, *_ = coupler("run", "udl_beam", "--models", "auto", "--out", "run", "--quiet", "--set", "end_time=0.15")
    assert code == 0
    scene = load_scene(tmp_path / "run" / "case.toml")
    assert scene.solid.model == "beam"
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert math.isclose(result["references"][0]["error"], 0.0, abs_tol=0.002)
    kept = result["preflight"]
    assert kept["actual"] == {"core_s": result["cost"]["core_s"], "error": abs(result["references"][0]["error"])}
    assert kept["actual"]["error"] <= kept["predicted"]["error_bound"] <= 0.003
