"""Pre-flight: silent on good scenes, each rule tripped by a small change, its numbers those of the models."""

from __future__ import annotations

import json
import math
import re
import sys
from typing import get_args

import pytest

import coupler.cli
import shared.commands
from coupler.preflight.check import preflight
from coupler.preflight.cost import predicted_cost
from coupler.preflight.error import error_bound
from coupler.preflight.ladder import ladder, smallest
from coupler.preflight.numbers import scene_numbers
from coupler.preflight.rules import RULES, findings
from coupler.preflight.table import near_miss_line
from fluid_solver.models import make_model as make_fluid
from shared.scene import load_scene, shipped_cases
from shared.schema_fluid import Fluid
from solid_solver.models import make_model as make_solid
from tests.scenes import tiny_coupled

RESTING = {"still", "column"} & set(get_args(Fluid.model_fields["model"].annotation))


def verdicts(case, *sets):
    scene = load_scene(case, sets)
    return {f.rule: f.verdict for f in findings(scene, scene_numbers(scene))}


@pytest.mark.parametrize("case", shipped_cases())
def test_no_false_alarm_on_a_shipped_case(case):
    assert {rule for rule, verdict in verdicts(case).items() if verdict != "ok"} == set()


ARCH = (
    'solid.bodies=[{ name = "beam", difference = [{ rectangle = [0.0, 0.0, 0.2, 0.012] }, '
    "{ rectangle = [0.02, 0.0, 0.18, 0.0055] }] }]"
)
TRIPPED = (
    ("mach", "dam_break", ["fluid.sound_speed=10"], "Mach", "warn"),
    ("mach", "dam_break", ["fluid.sound_speed=4"], "Mach", "refuse"),
    ("mach", "dam_break", ["fluid.sound_speed=1480"], "Mach", "warn"),
    ("mach", "dam_break", ["gravity=[0.0, -9.81e6]", "fluid.sound_speed=auto"], "Mach", "warn"),
    ("helmholtz", "hydrostatic_plate", ["goal.statistic=min"], "Helmholtz", "refuse"),
    ("froude", "dam_break", ["domain={ lower = [-0.1, -0.1], upper = [2.0, 0.6] }",
                             "fluid.bodies.water.velocity=[4.0, 0.0]"], "Froude", "warn"),
    ("slenderness", "udl_beam", ["solid.model=beam", "solid.bodies.beam.rectangle=[0.0, 0.0, 0.048, 0.012]",
                                 "probes.mid_y.point=[0.024, 0.006]"], "slenderness", "warn"),
    ("cauchy", "dam_break_plate", ["solid.youngs_modulus=5e4"], "Cauchy", "warn"),
    ("cauchy", "dam_break_plate", ["solid.youngs_modulus=1e3"], "Cauchy", "refuse"),
    ("density_ratio", "hydrostatic_plate", ["solid.density=2.7"], "density ratio", "warn"),
    ("density_ratio", "hydrostatic_plate", ["fluid.density=1.0"], "density ratio", "warn"),
    ("mass_ratio", "hydrostatic_plate", ["solid.density=500", "coupling.scheme=serial-explicit"], "mass ratio", "warn"),
    ("window_number", "hydrostatic_plate", ["coupling.window=1e-3"], "window α", "warn"),
    ("window_number", "hydrostatic_plate", ["coupling.window=1e-2"], "window α", "refuse"),
    ("window_number", "hydrostatic_plate", ["coupling.window=1e-2", "coupling.scheme=serial-explicit"],
     "window α", "refuse"),
    ("euler", "dam_break_plate", ["solid.youngs_modulus=1e5"], "Euler", "warn"),
    ("pressed", "udl_beam", ['solid.loads=[{ body="beam", face="right", traction=[1.1e6, 0.0] }]',
                             'solid.clamps=[{ body="beam", face="left" }]'], "strain", "warn"),
    ("across", "udl_beam", ["solid.dx=4e-3"], "particles across", "warn"),
    ("support", "dam_break_plate", ["fluid.dx=5e-3"], "thickness/support", "warn"),
    ("support", "dam_break_plate", ["fluid.dx=1e-2"], "thickness/support", "refuse"),
    ("support", "dam_break_plate", ["fluid.dx=5e-3", "coupling.loads=pressure"], "thickness/support", "refuse"),
    ("face_pressures", "cantilever_in_water", ["coupling.loads=pressure"], "face pressures", "warn"),
    ("drag", "cantilever_in_water", ["goal.statistic=min"], "drag", "warn"),
    ("water_holds", "cantilever_in_water", ["fluid.h_over_dx=1.3"], "water's hold", "warn"),
    ("ghost_acceleration", "light_gate", ["fluid.structure_acceleration=true"], "ghost acceleration", "warn"),
    ("ghost_acceleration", "dam_break_plate", ["coupling.scheme=parallel-explicit", "coupling.predictor=2",
                                               "fluid.structure_acceleration=true"], "ghost acceleration", "warn"),
    ("step_ratio", "dam_break_plate", ["solid.youngs_modulus=2e14"], "step ratio", "warn"),
    ("courant_fluid", "dam_break", ["fluid.courant=1.35"], "Courant, fluid", "warn"),
    ("courant_fluid", "dam_break", ["fluid.courant=1.45"], "Courant, fluid", "refuse"),
    ("courant_solid", "udl_beam", ["solid.courant=0.7"], "Courant, solid", "warn"),
    ("courant_solid", "udl_beam", ["solid.courant=0.9"], "Courant, solid", "refuse"),
    ("water_across", "dam_break", ["fluid.dx=0.03"], "water across", "warn"),
    ("neighbours", "dam_break", ["fluid.h_over_dx=0.8"], "h/dx", "warn"),
    ("neighbours", "dam_break", ["fluid.kernel=quintic-spline", "fluid.h_over_dx=2.0"], "h/dx", "warn"),
    ("neighbours", "standing_wave", ["fluid.h_over_dx=1.3"], "h/dx", "warn"),
    ("viscosity", "lid_cavity", ["fluid.alpha=0.1"], "Reynolds", "warn"),
    ("viscosity", "lid_cavity", ["fluid.viscosity=0.1"], "Reynolds", "warn"),
    ("viscosity", "dam_break", ["fluid.dx=0.02", "fluid.sound_speed=40"], "Reynolds", "warn"),
    ("falls_out", "still_tank", ["gravity=[0.0, 9.81]"], "nothing below", "warn"),
    ("falls_out", "dam_break", ["walls.tank.polyline=[[0.0,0.45],[0.0,0.0],[0.1,0.0]]"], "nothing below", "warn"),
    ("start_up", "still_tank", ["fluid.initial_pressure=zero"], "start-up", "warn"),
    ("poisson", "udl_beam", ["solid.poisson_ratio=0.495"], "Poisson's ratio", "warn"),
    ("periods_seen", "oscillating_plate", ["goal.statistic=period", "end_time=0.4"], "periods seen", "refuse"),
    ("filled_area", "submerged_block", ["solid.bodies=[{ name='block', circle={ centre=[0.2, 0.16], radius=0.02 } }]",
                                        "solid.dx=0.014"], "filled area", "warn"),
    ("filled_limbs", "udl_beam", [ARCH], "filled limbs", "warn"),
    ("steps", "udl_beam", ["end_time=1e5"], "steps", "warn"),
    ("steps", "dam_break", ["end_time=1e32"], "steps", "refuse"),
    ("printed_gradient", "udl_beam", ["solid.model=ctvf", "solid.gradient=printed"], "gradient order", "warn"),
)  # fmt: skip


@pytest.mark.parametrize(("rule", "case", "sets", "name", "verdict"), TRIPPED)
def test_rule_is_tripped(rule, case, sets, name, verdict):
    assert verdicts(case, *sets)[name] == verdict


def test_a_long_window_that_auto_iterates_is_no_lagged_one():
    """It was refused for the lag that it has not; a sprung float in 10 ms windows is 0.6 % off."""
    tuned = ["solid.youngs_modulus=1e7", "solid.density=2000", "coupling.window=2e-3"]
    assert verdicts("hydrostatic_plate", *tuned)["window α"] == "ok"
    assert verdicts("hydrostatic_plate", *tuned, "coupling.scheme=serial-explicit")["window α"] == "warn"


def test_every_rule_has_a_scene_that_trips_it():
    assert {rule for rule, *_ in TRIPPED} == {rule.__name__ for rule in RULES}


@pytest.mark.parametrize("case", ["dam_break_plate", "soft_plate", "udl_beam", "oscillating_plate", "still_tank"])
@pytest.mark.parametrize("fluid", ["wcsph", "ctvf"])
def test_steps_and_particles_are_those_of_the_models(case, fluid):
    scene = load_scene(case)
    if scene.fluid is not None:
        scene = load_scene(case, [f"fluid.model={fluid}", f"fluid.dx={2 * scene.fluid.dx}"])
        model = make_fluid(scene, True, 1)
        water = scene_numbers(scene).water
        assert water.step == pytest.approx(model.stable_step(), rel=0.02)
        assert water.sound_speed == pytest.approx(model.describe().numbers["sound_speed"], rel=1e-12)
        assert water.particles == pytest.approx(model.particles(), rel=0.15)
    if scene.solid is not None:
        model = make_solid(scene, True, 1)
        plate = scene_numbers(scene).plate
        assert plate.step == pytest.approx(model.stable_step(), rel=0.2)
        assert plate.particles == pytest.approx(model.particles(), rel=0.1)


@pytest.mark.parametrize("model", ["beam", "ctvf"])
def test_steps_of_the_other_structures(model):
    scene = load_scene("oscillating_plate", [f"solid.model={model}"])
    assert scene_numbers(scene).plate.step == pytest.approx(make_solid(scene, True, 1).stable_step(), rel=0.1)


def test_wet_frequency_is_that_of_the_plate_under_incompressible_water():
    """79 Hz for the aluminium plate under 2 m of water, 269 Hz dry (both with shear, which a thin plate leaves out)."""
    numbers = scene_numbers(load_scene("hydrostatic_plate"))
    assert numbers.joint.wet_frequency / numbers.plate.frequency == pytest.approx(79.0 / 269.0, rel=0.03)


@pytest.mark.parametrize(
    ("sets", "rests", "boxed"),
    [
        ([], True, False),
        (["gravity=[9.81, 0.0]"], False, False),  # falls out of the open top, which is now a side
        (["fluid.bodies.water.rectangle=[0.0, 0.0, 0.4, 0.5]"], False, False),
        (["walls.tank.closed=true", "walls.tank.polyline=[[0,0.5],[0,0],[0.5,0],[0.5,0.5]]"], True, True),
        (["fluid.bodies.water.velocity=[0.1, 0.0]"], False, False),
        (["walls=[{ name = 'tank', polyline = [[0.0, 0.0], [0.5, 0.0]] }]"], False, False),
        (
            ["walls=[{ name = 'tank', polyline = [[0.0, 0.0], [0.5, 0.0]] }]", "fluid.periodic.x=[0.0, 0.5]"],
            True,
            False,
        ),
    ],
)
def test_water_at_rest_is_told_from_water_that_falls(sets, rests, boxed):
    water = scene_numbers(load_scene("still_tank", sets)).water
    assert (water.rests, water.boxed) == (rests, boxed)


# ---- the ladder ------------------------------------------------------------------------------------------------------


def test_a_loaded_beam_needs_a_beam():
    choice = smallest(ladder(load_scene("udl_beam")))
    assert (choice.name, choice.error) == ("beam", pytest.approx(0.00108, rel=0.1))


def test_a_tighter_goal_needs_particles():
    """And a cliff is named: what just misses the goal for a tenth of the cost."""
    wide = "solid.poisson_ratio=0.34"
    found = preflight(load_scene("udl_beam", [wide, "goal.error=0.008"]))
    assert found.choice.name == "total-lagrangian"
    assert found.choice.error <= 0.008
    assert found.near_miss.name == "beam"
    assert "bound 0.974 % for 0.8 %, misses by 0.17 %" in near_miss_line(found)
    assert preflight(load_scene("udl_beam", [wide, "goal.error=0.006"])).near_miss is None


def test_a_force_on_an_elastic_wall_may_be_had_from_a_rigid_one():
    scene = load_scene("dam_break_plate", ["solid.youngs_modulus=2.1e11"])
    probe = scene.probes[0].model_copy(update={"quantity": "force-x", "point": None})
    goal = scene.goal.model_copy(update={"error": 0.5})
    scene = scene.model_copy(update={"probes": [probe], "references": [], "goal": goal})
    assert smallest(ladder(scene)).solid == "rigid"


def test_a_mean_of_a_creeping_plate_is_as_wrong_as_it_is_slow():
    """Damped a hundred times too much: found the answer 73 % short, where 2 % was promised."""
    damped = load_scene("hydrostatic_plate", ["fluid.model=still", "solid.model=beam", "solid.damping=3e6"])
    assert error_bound(damped, scene_numbers(damped)) > 0.3


def test_a_plate_without_a_modulus_is_rigid_and_that_is_enough():
    choice = smallest(ladder(load_scene("two_levels")))
    assert (choice.fluid, choice.solid) == ("still", "rigid")


def test_a_free_block_is_not_asked_whether_it_rings():
    """It moves as a whole; sound that leaves it is what its case is about."""
    scene = load_scene("water_tube")
    numbers = scene_numbers(scene)
    assert numbers.joint.wet_frequency is None
    assert "Helmholtz" not in {finding.rule for finding in findings(scene, numbers)}


def test_a_static_goal_under_water_needs_no_moving_water():
    choice = smallest(ladder(load_scene("hydrostatic_plate")))
    assert choice.solid == "beam"
    assert choice.fluid in RESTING


@pytest.mark.parametrize(("error", "offered"), [(0.05, False), (0.35, True)])
def test_a_way_out_is_offered_where_its_bound_reaches_the_goal(error, offered):
    """Columns are bounded by 30 %."""
    scene = load_scene("hydrostatic_plate", ["goal.statistic=min", f"goal.error={error}"])
    found = {f.rule: f for f in findings(scene, scene_numbers(scene))}["Helmholtz"]
    assert ("column" in found.way_out) == offered
    assert (smallest(ladder(scene)) is not None) == offered


def test_a_faster_sound_that_helps_is_named_and_what_it_costs():
    """A little above the limit a little more does, and the way out leads below it."""

    def helmholtz(sound):
        scene = load_scene("hydrostatic_plate", ["goal.statistic=min", f"fluid.sound_speed={sound}"])
        return {f.rule: f for f in findings(scene, scene_numbers(scene))}["Helmholtz"]

    far = helmholtz(100.0)
    assert "times the cost" in far.way_out
    near = helmholtz(100.0 * far.value / 0.8003)
    assert near.verdict == "warn"
    assert "% more than the cost" in near.way_out
    assert helmholtz(re.search(r"sound_speed = (\S+)", near.way_out)[1]).verdict == "ok"


def test_a_transient_under_deep_water_is_beyond_the_low_sound_speed():
    rungs = ladder(load_scene("hydrostatic_plate", ["goal.statistic=min"]))
    assert smallest(rungs) is None
    reasons = {rung.reason for rung in rungs if rung.fluid in ("ctvf", "wcsph") and rung.standing == "not enough"}
    assert reasons
    assert all("low sound speed" in reason for reason in reasons)


def test_a_dam_break_on_a_plate_needs_moving_water_and_no_shifting():
    choice = smallest(ladder(load_scene("dam_break_plate")))
    assert choice.fluid == "wcsph"
    assert choice.solid in ("beam", "total-lagrangian")


def test_a_light_plate_that_closes_a_box_is_iterated():
    sets = ["coupling.scheme=auto", "coupling.window=auto"]
    choice = smallest(ladder(load_scene("light_gate", sets)))
    assert choice.fluid in ("wcsph", "ctvf")
    assert {"coupling.scheme=serial-implicit", "coupling.acceleration=iqn-ils"} <= set(choice.sets)
    assert verdicts("light_gate", "coupling.scheme=serial-explicit")["mass ratio"] == "refuse"


def test_a_square_is_no_beam():
    rungs = {rung.solid: rung for rung in ladder(load_scene("spinning_square"))}
    assert rungs["beam"].standing == "cannot"
    assert "rectangle" in rungs["beam"].reason
    assert rungs["total-lagrangian"].standing == "smallest"


def test_bounds_hold_what_was_measured():
    """Errors of the table of structures and of README.md: bound at least the error, at most four times it or 0.3 %."""
    measured = (
        ("udl_beam", [], 0.0068),
        ("udl_beam", ["solid.dx=2e-3"], 0.0129),
        ("udl_beam", ["solid.dx=6e-4"], 0.0030),
        ("udl_beam", ["solid.poisson_ratio=0.34"], 0.0122),
        ("udl_beam", ["solid.model=beam"], 0.0001),
        ("hydrostatic_plate", ["fluid.model=still", "solid.model=beam", "solid.damping=2400"], 0.0061),
        ("oscillating_plate", ["solid.model=beam"], 0.0060),
        ("plate_step_load", [], 0.0037),
        ("plate_step_load", ["solid.model=beam"], 0.0092),
        ("oscillating_plate", [], 0.0040),
        ("oscillating_plate", ["solid.model=ctvf", "solid.gradient=quadratic"], 0.0144),
        ("udl_beam", ["solid.model=ctvf", "solid.gradient=linear"], 0.042),
        ("udl_beam", ["solid.model=ctvf", "solid.gradient=linear", "solid.dx=2e-3"], 0.131),
        ("udl_beam", ["solid.model=ctvf", "solid.gradient=linear", "solid.dx=3e-3"], 0.307),
        ("soft_plate", [], 0.0095),
        ("hydrostatic_plate", [], 0.0095),
        ("dam_break_plate", [], 0.058),
        ("dam_break_plate", ["fluid.dx=1e-3", "solid.dx=1e-3"], 0.027),
        ("dam_break", [], 0.017),
        ("dam_break", ["fluid.dx=8e-3"], 0.052),
        ("dam_break", ["fluid.dx=8e-3", "fluid.alpha=0.02"], 0.023),
        ("dam_break", ["fluid.model=ctvf", "fluid.dx=4e-3"], 0.025),
        ("standing_wave", [], 0.0014),
        ("standing_wave", ["fluid.dx=0.04"], 0.023),
        ("standing_wave", ["fluid.dx=0.01"], 0.005),
        ("standing_wave", ["fluid.dx=0.005"], 0.0065),
        ("standing_wave", ["fluid.dx=0.01", "fluid.h_over_dx=2.6"], 0.0062),
        ("standing_wave", ["fluid.model=wcsph", "fluid.dx=0.01"], 0.0068),
        ("standing_wave", ["fluid.model=wcsph", "fluid.dx=0.025"], 0.0081),
        ("standing_wave", ["fluid.h_over_dx=1.3"], 0.061),
        ("standing_wave", ["fluid.h_over_dx=1.3", "fluid.kernel=quintic-spline", "fluid.dx=0.05"], 0.028),
        ("still_tank", [], 0.0004),
        ("still_tank", ["fluid.h_over_dx=1.3", "fluid.dx=5e-3"], 0.0047),
    )
    for case, sets, error in measured:
        scene = load_scene(case, sets)
        bound = preflight(scene).error
        assert error <= bound <= max(4.0 * error, 0.003), (case, sets, bound)


def test_cost_grows_with_the_cube_of_the_resolution():
    """Four times the particles and twice the steps; walls and what a step costs by itself grow less."""
    coarse, fine = (load_scene("dam_break", [f"fluid.dx={dx}"]) for dx in (2e-3, 1e-3))
    stepping = [cost.core_s - cost.start_s for cost in (predicted_cost(s, scene_numbers(s)) for s in (coarse, fine))]
    assert 5.5 < stepping[1] / stepping[0] < 8.0


# ---- the commands ----------------------------------------------------------------------------------------------------


@pytest.fixture
def command(monkeypatch, capsys, tmp_path):
    """Runs `coupler …` in this process; returns exit code, standard output and errors."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shared.commands, "on_stop_signals", lambda handler: None)

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["coupler", *map(str, words)])
        with pytest.raises(SystemExit) as end:
            coupler.cli.main()
        return end.value.code, *capsys.readouterr()

    return run


def test_check_prints_numbers_and_the_smallest_pair(command):
    code, out, _ = command("check", "udl_beam")
    assert code == 0
    assert "Smallest that meets the goal: beam" in " ".join(out.split())


def test_check_as_json_is_strict_json(command):
    code, out, _ = command("check", "hydrostatic_plate", "--set", "goal.statistic=min", "--json")
    report = json.loads(out, parse_constant=lambda word: pytest.fail(word))
    assert code == 2
    assert report["verdict"] == "refuse"
    assert report["smallest"] is None
    assert all(f["reason"] for f in report["findings"])


def test_a_refused_scene_does_not_run(command, tmp_path):
    case = tiny_coupled(tmp_path)
    code, _, errors = command("run", case, "--set", "coupling.window=0.02", "--out", "run")
    assert code == 2
    assert "window α" in errors
    assert "--force" in errors
    assert not (tmp_path / "run").exists()


def test_a_run_keeps_what_was_predicted_and_what_came(command, tmp_path):
    case = tiny_coupled(tmp_path, end_time=0.02)
    code, *_ = command("run", case, "--out", "run", "--quiet", "--link", "inprocess", "--threads", "fluid=1,solid=1")
    kept = json.loads((tmp_path / "run" / "result.json").read_text())["preflight"]
    assert code == 0
    assert kept["verdict"] == "warn"  # a peak under this water would not be resolved, and nobody said what is wanted
    assert kept["predicted"]["core_s"] > 0.0
    assert kept["actual"]["core_s"] > 0.0
    assert kept["window"] == pytest.approx(kept["predicted"]["window"], rel=0.1)


def test_models_auto_asks_before_it_takes_hours(command, tmp_path):
    code, _, errors = command("run", "udl_beam", "--models", "auto", "--out", "run", "--set", "goal.error=2.5e-4")
    assert code == 2
    assert "core-hours, more than one and more than the scene as it stands; --force runs it" in errors
    assert not (tmp_path / "run").exists()


def test_models_auto_heeds_refusals_of_one_side(command, tmp_path):
    sets = ("--set", "goal.error=1e-12", "--set", "solid.courant=0.9", "--set", "end_time=0.01")
    code, *_ = command("run", "spinning_square", "--models", "auto", *sets, "--out", "run")
    assert code == 2
    assert not (tmp_path / "run").exists()


def test_models_auto_runs_the_choice_and_writes_it_down(command, tmp_path):
    code, *_ = command("run", "udl_beam", "--models", "auto", "--out", "run", "--quiet", "--set", "end_time=0.15")
    assert code == 0
    scene = load_scene(tmp_path / "run" / "case.toml")
    assert scene.solid.model == "beam"
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert math.isclose(result["references"][0]["error"], 0.0, abs_tol=0.002)
    kept = result["preflight"]
    assert kept["actual"] == {"core_s": result["cost"]["core_s"], "error": abs(result["references"][0]["error"])}
    assert kept["actual"]["error"] <= kept["predicted"]["error_bound"] <= 0.003
