"""Ways in which methods fail, each provoked on purpose: named before the run or within it, never by NaN; cured nearby.

Each mode is a shipped case with changes that spoil it. `flagged`: pre-flight's rule that warns or refuses. `said`:
words of the diagnosis that ends the run, None where the run goes on and is only wrong. `cure`: changes by which it
passes.
"""

from __future__ import annotations

import logging
import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from coupler.run import run_coupled
from fluid_solver.models import make_model as make_fluid
from shared.contract import BadInput, ShearwaterError
from shared.scene.reading import load_scene, shipped_cases
from shared.solo import run_alone
from solid_solver.models import make_model as make_solid
from tests.preflights import verdicts_of


@dataclass(frozen=True)
class Mode:
    name: str
    case: str
    spoil: tuple[str, ...]
    cure: tuple[str, ...]
    flagged: str | None = None
    said: str | None = None
    shorten: tuple[str, ...] = ()


LAGGED = ("coupling.scheme=serial-explicit", "coupling.window=2e-2", "fluid.column.reflection=0.5")
COARSE = ("fluid.dx=8e-3", "end_time=0.3", "output.probe_interval=0.01", "references=[]")
MODES = (
    Mode(
        "lagged exchange",
        "piston",
        spoil=LAGGED,
        cure=("coupling.scheme=serial-implicit",),
        flagged="window α",
        said=r"ledger is past its limit .* energy",
        shorten=("end_time=1.0", "references=[]"),
    ),
    Mode(
        "plain iteration on heavy water",
        "piston",
        spoil=(
            "coupling.acceleration=constant",
            "coupling.relaxation=1.0",
            "solid.density=5e3",
            "coupling.window=2e-2",
        ),
        cure=("coupling.acceleration=iqn-ils",),
        said=r"loads still change by .* after 30 iterations",
        shorten=("end_time=0.2", "references=[]"),
    ),
    Mode(
        "explicit exchange under deep water, long windows",
        "hydrostatic_plate",
        spoil=("coupling.scheme=serial-explicit", "coupling.window=1e-2"),
        cure=("coupling.window=auto",),
        flagged="window α",
    ),
    Mode(
        "both sides at once under deep water",
        "hydrostatic_plate",
        spoil=("coupling.scheme=parallel-explicit", "coupling.predictor=2", "coupling.window=1e-3"),
        cure=("coupling.window=auto",),
        flagged="window α",
    ),
    Mode(
        "sound speed too low",
        "dam_break",
        spoil=("fluid.sound_speed=4.0",),
        cure=("fluid.sound_speed=auto",),
        flagged="Mach",
        said="not weakly compressible any more",
        shorten=COARSE,
    ),
    Mode(
        "sound speed too high",
        "dam_break",
        spoil=("fluid.sound_speed=1480.0",),
        cure=("fluid.sound_speed=auto",),
        flagged="Mach",
    ),
    Mode(
        "fluid step too long",
        "dam_break",
        spoil=("fluid.courant=1.5", "fluid.alpha=0.01"),
        cure=("fluid.courant=auto",),
        flagged="Courant, fluid",
        shorten=COARSE,
    ),
    Mode(
        "solid step too long",
        "udl_beam",
        spoil=("solid.courant=0.95",),
        cure=("solid.courant=auto",),
        flagged="Courant, solid",
        said=r"turned inside out or lost.*[Ll]ower solid\.courant",
        shorten=("solid.dx=2e-3", "end_time=0.01", "output.average_from=0.0", "output.probe_interval=2e-3"),
    ),
    Mode(
        "tensile instability",
        "stretched_strip",
        spoil=("solid.model=ctvf", "solid.gradient=printed", "solid.shifting=false"),
        cure=("solid.gradient=quadratic",),
        flagged="gradient order",  # within a run: see test_fracture_is_reported of the updated-Lagrangian solid
    ),
    Mode(
        "quadratic fit with few neighbours",
        "stretched_strip",
        spoil=("solid.model=ctvf", "solid.gradient=quadratic", "solid.h_over_dx=1.0"),
        cure=("solid.h_over_dx=1.3",),
        said=r"The solid failed at t = .*raise solid\.h_over_dx",
        shorten=("solid.dx=4e-3", "end_time=0.1", "output.average_from=0.0", "references=[]"),
    ),
    Mode(
        "pairing",
        "dam_break",
        spoil=("fluid.kernel=quintic-spline", "fluid.h_over_dx=2.0"),
        cure=("fluid.h_over_dx=1.0",),
        flagged="h/dx",
    ),
    Mode("see-through plate", "dam_break_plate", ("fluid.dx=1e-2",), ("fluid.dx=2e-3",), flagged="thickness/support"),
    Mode(
        "see-through plate between two waters",
        "two_levels",
        spoil=("fluid.dx=1.5e-2",),
        cure=("fluid.dx=5e-3",),
        flagged="thickness/support",
        said=r"stands in water on both faces.*Make fluid\.dx at most",
        shorten=("end_time=0.005", "output.average_from=0.0", "references=[]"),
    ),
    Mode(
        "acceleration of a light plate in its ghosts",
        "light_gate",
        spoil=("fluid.structure_acceleration=true",),
        cure=("fluid.structure_acceleration=auto",),
        flagged="ghost acceleration",
    ),
    Mode(
        "start-up shock",
        "still_tank",
        spoil=("fluid.initial_pressure=zero",),
        cure=("fluid.initial_pressure=hydrostatic",),
        flagged="start-up",
    ),
    Mode(
        "nearly incompressible solid",
        "udl_beam",
        spoil=("solid.poisson_ratio=0.499",),
        cure=("solid.poisson_ratio=0.45",),
        flagged="Poisson's ratio",
    ),
    Mode(
        "water that radiates instead of moving along",
        "hydrostatic_plate",
        spoil=("goal.statistic=min",),
        cure=("goal.statistic=mean",),
        flagged="Helmholtz",
    ),
    Mode(
        "waves on a lattice that bears shear",
        "standing_wave",
        spoil=("fluid.h_over_dx=1.3",),
        cure=("fluid.h_over_dx=1.52",),
        flagged="h/dx",
    ),
    Mode(
        "viscous stresses of few neighbours",
        "lid_cavity",
        spoil=("fluid.viscosity=0.1",),
        cure=("fluid.h_over_dx=2.0",),
        flagged="Reynolds",
    ),
    Mode(
        "artificial viscosity beside the fluid's own",
        "lid_cavity",
        spoil=("fluid.alpha=0.1",),
        cure=("fluid.alpha=0.0",),
        flagged="Reynolds",
    ),
    Mode(
        "load far too large",
        "udl_beam",
        spoil=("solid.model=beam", "solid.loads[0].traction=[0.0, -2e9]"),
        cure=("solid.loads[0].traction=[0.0, -20.0]",),
        flagged="Cauchy",
        said="found no equilibrium",
        shorten=("end_time=0.02", "output.average_from=0.0"),
    ),
)
ENDING = [pytest.param(m, id=m.name) for m in MODES if m.said]


def verdict(mode: Mode, sets) -> str | None:
    scene = load_scene(mode.case, sets)
    found = verdicts_of(scene)
    return found.get(mode.flagged)


def run(mode: Mode, sets, folder):
    """Run a case as its command line would, in this process."""
    scene = load_scene(mode.case, [*mode.shorten, "output.frames=1", *sets])
    if scene.fluid is not None and scene.solid is not None:
        return run_coupled(scene, mode.case, folder, {"fluid": 1, "solid": 1}, True, "inprocess")
    side, factory = ("solid", make_solid) if scene.fluid is None else ("fluid", make_fluid)
    return run_alone(scene, mode.case, side, factory, folder, 1, True)


@pytest.mark.parametrize("mode", [m for m in MODES if m.flagged], ids=[m.name for m in MODES if m.flagged])
def test_preflight_flags_it_and_not_its_cure(mode):
    assert verdict(mode, mode.spoil) in ("warn", "refuse")
    assert verdict(mode, (*mode.spoil, *mode.cure)) == "ok"


@pytest.mark.parametrize("mode", ENDING)
def test_the_run_ends_with_its_diagnosis(mode, tmp_path):
    with pytest.raises(ShearwaterError) as error:
        run(mode, mode.spoil, tmp_path / "run")
    assert re.search(mode.said, str(error.value), re.DOTALL), str(error.value)
    assert (tmp_path / "run" / "result.json").exists()


@pytest.mark.parametrize("mode", ENDING)
def test_the_cure_one_set_away_passes(mode, tmp_path):
    assert run(mode, (*mode.spoil, *mode.cure), tmp_path / "run").result["status"] == "finished"


def test_water_that_gets_out_is_counted(tmp_path):
    """A tank without its right wall in a domain that ends there loses water; the closed tank keeps it."""
    text = ("fluid.dx=2.5e-2", "end_time=0.4", "references=[]", "output.average_from=0.0", "goal.error=0.1")
    box = ("domain={ lower = [-0.1, -0.1], upper = [0.6, 2.0] }",)
    hole = ("walls.tank.polyline=[[0.0, 0.75], [0.0, 0.0], [0.5, 0.0]]",)
    mode = Mode("open tank", "still_tank", spoil=hole, cure=(), shorten=(*text, *box))
    results = [run(mode, sets, tmp_path / str(len(sets))).result for sets in (hole, ())]
    leaked = [result["probes"]["leaked"]["max"] for result in results]
    assert leaked[0] > 10
    assert leaked[1] == 0.0
    assert results[0]["cost"]["fluid"]["lost"] > 10
    assert results[1]["cost"]["fluid"]["lost"] == 0


def test_the_table_of_failures_names_tests_and_cases_that_exist():
    tests = Path(__file__).parent
    known = set(
        re.findall(r"^def (test_\w+)", "".join(path.read_text() for path in tests.glob("test_*.py")), re.MULTILINE)
    )
    rows = [line for line in (tests.parent / "cases" / "FAILURES.md").read_text().splitlines() if line.startswith("| ")]
    assert len(rows) > 20
    for row in rows[1:]:
        assert set(re.findall(r"`(test_\w+)`", row)) & known, row
        assert set(re.findall(r"`(\w+) --set", row)) <= set(shipped_cases()), row


def test_one_particle_across_is_refused():
    with pytest.raises(BadInput, match="particles across"):
        load_scene("udl_beam", ["solid.dx=0.012"])


@pytest.mark.slow
def test_a_light_gate_on_a_box_is_named_before_and_within_an_explicit_run(tmp_path):
    mode = Mode("light gate", "light_gate", ("coupling.scheme=serial-explicit",), (), flagged="mass ratio")
    assert verdict(mode, mode.spoil) == "refuse"
    with pytest.raises(ShearwaterError):
        run(mode, mode.spoil, tmp_path / "run")


@pytest.mark.slow
@pytest.mark.parametrize("case", shipped_cases())
def test_nothing_is_diagnosed_in_the_first_tenth_of_a_shipped_case(case, tmp_path, caplog):
    """Whole runs of all of them make the tables in cases/results; pre-flight: test_no_false_alarm_on_a_shipped_case."""
    tenth = 0.1 * load_scene(case).end_time
    sets = (f"end_time={tenth!r}", "output.average_from=0.0", "references=[]")
    result = run(Mode("good", case, (), ()), sets, tmp_path / "run").result
    assert result["status"] == "finished"
    assert [r.getMessage() for r in caplog.records if r.levelno >= logging.WARNING] == []


def test_every_mode_is_detected():
    assert all(mode.flagged or mode.said for mode in MODES)
