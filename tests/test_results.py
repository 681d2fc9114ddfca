"""Run directories, probe tables and their summaries against closed forms, and the result file."""

import json
import math
import os
import re
import subprocess
import sys
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from coupler.cli import conclude_coupled
from coupler.preflight.check import preflight
from coupler.run import run_coupled
from shared.commands import conclude
from shared.contract import BadInput, ShearwaterError
from shared.run.probes import ProbeTable, compare, probe_units, read_probes
from shared.run.record import Record
from shared.run.results import environment, make_result, new_run_directory, read_result, write_result
from shared.scene.reading import load_scene
from shared.schema.scene import Scene

OMEGA = 2.0 * math.pi * 30.25  # first frequency of the beam under a uniform load [rad/s]
STATIC = 5.986e-5  # its static deflection [m]


def scene(references=(), average_from=0.0):
    """A beam with two probes."""
    return Scene.model_validate(
        {
            "schema": 1,
            "title": "beam",
            "end_time": 1.0,
            "solid": {
                "model": "total-lagrangian",
                "dx": 0.01,
                "density": 2700.0,
                "youngs_modulus": 6.75e10,
                "bodies": [{"name": "beam", "rectangle": [0.0, 0.0, 1.0, 0.05]}],
            },
            "probes": [
                {"name": "mid_y", "quantity": "displacement-y", "body": "beam", "point": [0.5, 0.025]},
                {"name": "energy", "quantity": "kinetic-energy", "body": "beam"},
            ],
            "references": list(references),
            "output": {"average_from": average_from},
        }
    )


def ringing(path, rows=4001, end=10.0 / 30.25):
    """The undamped answer to a load switched on: STATIC (1 − cos ωt), ten whole periods."""
    table = ProbeTable(path, {"mid_y": "m", "energy": "J/m"})
    for time in np.linspace(0.0, end, rows):
        table.append(time, {"mid_y": STATIC * (1.0 - math.cos(OMEGA * time)), "energy": time**2})
    return table


# ---- the run directory ------------------------------------------------------------------------------------------


def test_runs_are_numbered_and_never_overwritten(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = [new_run_directory(None, "udl_beam") for _ in range(3)]
    assert found == [Path("runs/udl_beam"), Path("runs/udl_beam-2"), Path("runs/udl_beam-3")]
    assert all(path.is_dir() for path in found)
    named = tmp_path / "a" / "b"
    assert new_run_directory(named, "udl_beam") == named
    assert new_run_directory(named, "udl_beam") == named  # empty: fine
    record = Record(named, scene(), "beam", {}, True)
    with pytest.raises(BadInput, match="Another run has just begun in"):  # both found it empty
        Record(named, scene(), "beam", {}, True)
    record.claim.close()
    with pytest.raises(BadInput, match="not empty"):
        new_run_directory(named, "udl_beam")
    with pytest.raises(BadInput, match="cannot be made"):
        new_run_directory(named / "case.toml" / "deeper", "udl_beam")
    with pytest.raises(BadInput, match="cannot be made"):
        new_run_directory(named / "case.toml", "udl_beam")


def test_a_scene_whose_curve_cannot_be_kept_leaves_an_empty_directory(tmp_path):
    """An empty case.toml stayed behind, and the directory could not be named again."""
    gone = {"probe": "mid_y", "name": "gone", "curve": str(tmp_path / "gone.csv")}
    with pytest.raises(ShearwaterError, match=r"The copy of .*gone\.csv"):
        Record(tmp_path, scene([gone]), "beam", {}, True)
    assert list(tmp_path.iterdir()) == []


# ---- summaries --------------------------------------------------------------------------------------------------


def test_statistics_of_a_ringing_beam(tmp_path):
    row = ringing(tmp_path / "probes.csv").summary(0.0)["mid_y"]
    assert row["mean"] == pytest.approx(STATIC, rel=1e-9)
    assert row["max"] == pytest.approx(2.0 * STATIC, rel=1e-6)
    assert row["t_max"] == pytest.approx(math.pi / OMEGA, abs=1e-4)
    assert row["min"] == 0.0
    assert row["t_min"] == 0.0
    assert row["final"] == pytest.approx(0.0, abs=1e-12)
    assert row["unit"] == "m"


# ---- probes -----------------------------------------------------------------------------------------------------


def test_probe_rows_are_on_disk_at_once_and_exact(tmp_path):
    path = tmp_path / "probes.csv"
    with ProbeTable(path, {"mid_y": "m", "energy": "J/m"}) as table:
        table.append(0.1 + 0.2, {"mid_y": 1.0 / 3.0})
        time, values = read_probes(path)  # before it is closed
    assert path.read_text().splitlines()[0] == "time,mid_y,energy"
    assert time[0] == 0.1 + 0.2
    assert values["mid_y"][0] == 1.0 / 3.0
    assert math.isnan(values["energy"][0])
    path.write_text(path.read_text() + "0.5,1.0")  # killed in the middle of a row
    assert len(read_probes(path)[0]) == 1
    with pytest.raises(ShearwaterError, match="cannot be written"):
        ProbeTable(tmp_path / "missing" / "probes.csv", {})


@pytest.mark.parametrize(
    "harm", [lambda path: path.unlink(), lambda path: os.truncate(path, 20), lambda path: os.truncate(path, 0)]
)
def test_lines_that_another_program_took_are_told_of(tmp_path, capsys, harm):
    """They were not: the run had finished, with zeros where its lines had been, or with no table at all."""
    path = tmp_path / "probes.csv"
    with ProbeTable(path, {"mid_y": "m"}) as table:
        table.append(0.1, {"mid_y": 1.0})
        table.append(0.2, {"mid_y": 2.0})
        harm(path)
        table.append(0.3, {"mid_y": 3.0})
    assert capsys.readouterr().err.startswith(f"warning: {path} holds ")
    assert not path.exists() or b"\0" not in path.read_bytes()
    with ProbeTable(path, {"mid_y": "m"}) as table:
        table.append(0.1, {"mid_y": 1.0})
    assert capsys.readouterr().err == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_full_disk_is_explained():
    with pytest.raises(ShearwaterError, match="disk may be full"):
        ProbeTable("/dev/full", {"mid_y": "m"})


def test_probes_have_the_units_of_their_quantities():
    assert probe_units(scene()) == {"mid_y": "m", "energy": "J/m"}


# ---- references -------------------------------------------------------------------------------------------------


def reference(**keys):
    return {"probe": "mid_y", "name": "theory", **keys}


def test_values_are_compared(tmp_path):
    table = ringing(tmp_path / "probes.csv")
    rows = compare(
        scene(
            [
                reference(value=1.1 * STATIC, statistic="mean"),
                reference(value=0.0, statistic="min"),
                reference(value=0.5, statistic="max", between=[0.0, 0.4]),  # the run ends at 0.331 s
                reference(value=0.1, statistic="t_max", between=[0.0, 0.03]),
                {"probe": "energy", "name": "x", "value": 0.2, "statistic": "slope", "between": [0.0, 0.2]},
            ]
        ),
        table,
    )
    assert rows[0]["error"] == pytest.approx(-0.1 / 1.1, rel=1e-6)
    assert rows[1] == {
        "probe": "mid_y",
        "name": "theory",
        "statistic": "min",
        "value": 0.0,
        "computed": 0.0,
        "error": 0.0,
    }
    assert rows[2]["computed"] is None
    assert rows[2]["error"] is None
    assert rows[3]["computed"] == pytest.approx(0.5 / 30.25, abs=1e-4)
    # Least squares through a parabola over [0, T]: slope T.
    assert rows[4]["computed"] == pytest.approx(0.2, rel=1e-3)


def test_mean_reference_starts_at_average_from(tmp_path):
    table = ProbeTable(tmp_path / "probes.csv", {"mid_y": "m", "energy": "J/m"})
    for time in np.linspace(0.0, 1.0, 101):
        table.append(time, {"mid_y": time, "energy": 0.0})
    references = [reference(value=0.75, statistic="mean"), reference(value=1.0, statistic="max")]
    rows = compare(scene(references, average_from=0.5), table)
    assert [row["error"] for row in rows] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert table.summary(0.5)["mid_y"]["mean"] == pytest.approx(0.75)
    assert table.summary(2.0)["mid_y"]["mean"] is None  # cut off before its means began


@pytest.mark.parametrize("header", ["", "time [s],deflection\n"])
def test_curves_are_compared_where_both_are(tmp_path, header):
    """A curve in ms and mm that begins late and goes on after the run: its later, higher peak does not count."""
    time = np.linspace(0.002, 1.0, 2000)
    value = 1.02 * STATIC * (1.0 - np.cos(OMEGA * time)) * np.where(time > 0.5, 2.0, 1.0)
    curve = tmp_path / "curve.csv"
    lines = (f"{1e3 * t},{1e3 * v}" for t, v in zip(time, value, strict=True))
    curve.write_text(header + "\n".join(lines))
    keys = {"curve": str(curve), "scale": [1e-3, 1e-3]}
    table = ringing(tmp_path / "probes.csv")
    peak, mean, outside = compare(
        scene(
            [
                reference(**keys, statistic="max"),
                reference(**keys, statistic="mean"),
                reference(**keys, between=[0.6, 0.9]),
            ]
        ),
        table,
    )
    assert peak["value"] == pytest.approx(2.04 * STATIC, rel=1e-3)
    assert peak["error"] == pytest.approx(-0.02 / 1.02, abs=1e-3)
    assert mean["error"] == pytest.approx(-0.02 / 1.02, abs=1e-3)
    assert outside["value"] is None
    assert outside["computed"] is None


def test_a_curve_that_is_gone_is_named(tmp_path):
    with pytest.raises(BadInput, match=r"absent\.csv of reference 'theory'"):
        compare(scene([reference(curve=str(tmp_path / "absent.csv"))]), ringing(tmp_path / "probes.csv"))


# ---- the result -------------------------------------------------------------------------------------------------

SIDE = {"model": "ctvf", "particles": 10, "steps": 5, "particle_steps_per_s": 1e6, "peak_MiB": 100.0}


def result(tmp_path, **keys):
    table = ringing(tmp_path / "probes.csv", rows=11)
    fixed = {"case": "udl_beam", "status": "finished", "reason": "", "t_end": 0.3, "threads": {"solid": 1}}
    return make_result(scene(), "schema = 1\n", table, **fixed, **keys)


def test_result_has_every_documented_key(tmp_path):
    alone = result(tmp_path, cost={"wall_s": 1.0, "core_s": 1.0, "solid": SIDE})
    coupling = {"scheme": "serial-explicit", "windows": 7}
    coupled = result(
        tmp_path,
        cost={"wall_s": 1.0, "core_s": 2.0, "solid": SIDE, "fluid": SIDE, "coupling": coupling},
        ledger={"impulse_error": 0.0, "work_error": 0.0, "energy_injected_fraction": 0.0},
    )
    for found in (alone, coupled):
        assert list(found) == [
            *("schema", "case", "case_hash", "status", "reason", "t_end", "probes", "references", "goal"),
            *("cost", "ledger", "preflight", "environment"),
        ]
        assert list(found["cost"]) == ["wall_s", "core_s", "fluid", "solid", "coupling"]
    assert alone["cost"]["fluid"] is None
    assert alone["cost"]["coupling"] is None
    assert alone["ledger"] is None
    assert coupled["cost"]["fluid"] == SIDE
    assert coupled["cost"]["coupling"]["wait_s"] is None
    assert coupled["case_hash"] == alone["case_hash"]


def keys_of(value, path=""):
    """Paths of a result's values, as cases/RESULT.md writes them; pre-flight's and the environment's to one level."""
    if isinstance(value, list) and value and path == "references":
        return keys_of(value[0], "references[]")
    if not isinstance(value, dict) or (path.count(".") and path.startswith(("preflight", "environment"))):
        return {path}
    name = {"probes": lambda key: "NAME", "cost": lambda key: "SIDE" if key in ("fluid", "solid") else key}
    steps = {name.get(path, str)(key): inner for key, inner in value.items()}
    return set().union(*(keys_of(inner, f"{path}.{key}".lstrip(".")) for key, inner in steps.items()))


def test_every_key_of_a_run_is_documented_and_no_other(tmp_path):
    run = load_scene("piston", ["end_time=0.01"])
    record = run_coupled(
        run, "piston", tmp_path / "run", {"fluid": 1, "solid": 1}, True, "inprocess", preflight(run).as_dict()
    )
    conclude_coupled(record, run, True)
    rows = [line.split("|")[1] for line in (files("cases") / "RESULT.md").read_text().splitlines() if "| `" in line]
    documented = {key for row in rows for key in re.findall("`([^`]+)`", row)}
    lost = {f"cost.fluid.{key}" for key in ("lost", "lost_fraction", "lost_near")}  # of particles alone
    assert keys_of(read_result(tmp_path / "run")) == documented - lost


@pytest.mark.parametrize("quiet", [False, True])
def test_lost_fluid_is_said_where_a_run_ends(tmp_path, capsys, quiet):
    losses = {"lost": 120, "lost_fraction": 0.25, "lost_near": [0.5, -0.02]}
    said = []
    for more in (losses, {"lost": 0, "lost_fraction": 0.0}, {}):
        found = result(tmp_path, cost={"wall_s": 1.0, "core_s": 1.0, "fluid": SIDE | more})
        conclude(SimpleNamespace(result=found, run_dir=tmp_path, pictures=[]), quiet)
        said.append(capsys.readouterr().err)
    assert said[0].startswith("warning: 120 fluid particles (25 % of all)")
    assert "near (0.5, -0.02) m" in said[0]
    assert said[0].count("\n") == 1
    assert said[1:] == ["", ""]


def test_windows_accepted_unconverged_are_said_where_a_run_ends(tmp_path, capsys):
    coupling = {"scheme": "serial-implicit", "windows": 50, "not_converged": 3, "change_left": 0.127}
    said = []
    for more in ({}, {"not_converged": 0, "change_left": 0.0}):
        found = result(tmp_path, cost={"wall_s": 1.0, "core_s": 1.0, "fluid": SIDE, "coupling": coupling | more})
        conclude(SimpleNamespace(result=found, run_dir=tmp_path, pictures=[]), True)
        said.append(capsys.readouterr().err)
    assert said[0].startswith("warning: 3 of 50 coupling windows were accepted before they had converged")
    assert "up to 0.13 of themselves" in said[0]
    assert said[1] == ""


def test_result_file_is_strict_json_and_replaced_whole(tmp_path, monkeypatch):
    found = result(tmp_path, cost={"wall_s": np.float64(1.5), "core_s": math.nan}, preflight={"mach": math.inf})
    path = write_result(tmp_path, found)

    def refuse(constant):
        raise AssertionError(f"{constant} is not JSON")

    read = json.loads(path.read_text(), parse_constant=refuse)
    assert read["cost"]["wall_s"] == 1.5
    assert read["cost"]["core_s"] is None
    assert read["preflight"]["mach"] is None
    assert read["probes"]["energy"]["unit"] == "J/m"
    monkeypatch.setattr(os, "fsync", lambda descriptor: (_ for _ in ()).throw(OSError(28, "No space left")))
    with pytest.raises(ShearwaterError, match="No space left"):
        write_result(tmp_path, {"schema": 1})
    assert json.loads(path.read_text()) == read  # the earlier file is untouched


def test_environment_names_what_a_result_depends_on():
    found = environment({"fluid": 2})
    assert set(found["versions"]) == {"python", "sources", "shearwater", "numpy", "numba", "h5py", "zenoh"}
    assert found["versions"]["numpy"] == np.__version__
    assert found["threads"] == {"fluid": 2}
    assert "nnan" not in found["numba"]["fastmath"]  # checks for NaN must work
    assert found["cpu"]
    json.dumps(found, allow_nan=False)


GROW = """
import numpy
from shared.run.results import peak_mib
before = peak_mib()
held = numpy.ones(200 << 17)
print(peak_mib() - before)
"""


def test_peak_memory_is_the_process_own():
    held = np.ones(500 << 17)  # 500 MiB that a process started from here must not count
    run = subprocess.run([sys.executable, "-c", GROW], capture_output=True, text=True, check=True, timeout=60)
    assert held[-1] == 1.0
    assert 150.0 < float(run.stdout) < 250.0
