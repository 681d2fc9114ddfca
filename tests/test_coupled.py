"""Coupled runs across processes: the same bytes over both links and with one or two threads; action and reaction."""

from __future__ import annotations

import csv
import json
import subprocess
import sys

import numpy as np
import pytest

from shared.run.vtkhdf import read_frame
from tests.scenes import tiny_coupled

pytestmark = pytest.mark.timeout(240)


def run(scene, out, *options):
    command = [sys.executable, "-m", "coupler", "run", str(scene), "--out", str(out), "--quiet", *options]
    subprocess.run(command, check=True, timeout=200)
    return out


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The same scene over zenoh with 1 and 2 threads, and in-process."""
    folder = tmp_path_factory.mktemp("coupled")
    scene = tiny_coupled(folder, end_time=0.04)
    return {
        "zenoh": run(scene, folder / "zenoh", "--threads", "fluid=1,solid=1"),
        "two threads": run(scene, folder / "two", "--threads", "fluid=2,solid=2"),
        "in-process": run(scene, folder / "inprocess", "--threads", "fluid=1,solid=1", "--link", "inprocess"),
    }


@pytest.mark.parametrize("other", ["two threads", "in-process"])
def test_same_bytes(runs, other):
    first, second = runs["zenoh"], runs[other]
    assert (first / "probes.csv").read_bytes() == (second / "probes.csv").read_bytes()
    assert (first / "ledger.csv").read_bytes() == (second / "ledger.csv").read_bytes()
    for side in ("fluid", "solid"):
        (time_a, a), (time_b, b) = (read_frame(folder / f"{side}.vtkhdf") for folder in (first, second))
        assert time_a == time_b
        assert a.position.tobytes() == b.position.tobytes()
        for name in a.fields:
            assert a.fields[name].tobytes() == b.fields[name].tobytes(), f"{side} {name}"


def test_action_equals_reaction_in_every_window(runs):
    with (runs["zenoh"] / "ledger.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 20
    for row in rows:
        total = [float(row["force_fluid_x"]), float(row["force_fluid_y"])]
        mapped = [float(row["force_mapped_x"]), float(row["force_mapped_y"])]
        np.testing.assert_allclose(mapped, total, rtol=0, atol=1e-12 * np.linalg.norm(total))


def test_water_presses_with_its_weight(runs):
    """0.1 m × 0.06 m of water weighs 58.9 N/m; the structure's side sees the same load, a window later."""
    result = json.loads((runs["zenoh"] / "result.json").read_text())
    assert result["status"] == "finished"
    assert result["probes"]["load_y"]["mean"] == pytest.approx(-0.1 * 0.06 * 9810.0, rel=0.05)
    assert result["ledger"]["impulse_error"] < 0.05
    assert result["probes"]["mid_y"]["min"] < 0.0


def test_run_directory_is_complete(runs):
    names = {path.name for path in runs["zenoh"].iterdir()}
    assert {"case.toml", "fluid.vtkhdf", "solid.vtkhdf", "probes.csv", "ledger.csv", "log", "result.json"} <= names
    assert {path.name for path in (runs["zenoh"] / "log").iterdir()} == {"coupler.txt", "fluid.txt", "solid.txt"}
    assert [name for name in names if name.endswith(".png")]


@pytest.mark.parametrize(
    ("fluid", "solid", "solid_dx"),
    [("wcsph", "total-lagrangian", 3.0e-3), ("ctvf", "total-lagrangian", 4.0e-3), ("wcsph", "ctvf", 2.0e-3)],
)
def test_every_pair_of_models_and_unlike_spacings(tmp_path, fluid, solid, solid_dx):
    scene = tiny_coupled(tmp_path, end_time=0.02, fluid=fluid, solid=solid, solid_dx=solid_dx)
    out = run(scene, tmp_path / "run", "--link", "inprocess")
    result = json.loads((out / "result.json").read_text())
    assert result["probes"]["load_y"]["mean"] == pytest.approx(-0.1 * 0.06 * 9810.0, rel=0.05)
    assert result["ledger"]["mapping_error"] < 1e-12
    assert result["probes"]["mid_y"]["min"] < -1e-6
