"""Pre-flight: silent on good scenes, each rule tripped by a small change, its numbers those of the models."""

from __future__ import annotations

import pytest

from coupler.preflight.bounds.error import error_bound
from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.rules.findings import RULES
from fluid_solver.models import make_model as make_fluid
from shared.scene.reading import load_scene, shipped_cases
from solid_solver.models import make_model as make_solid
from tests.preflights import verdicts_of


def verdicts(case, *sets):
    return verdicts_of(load_scene(case, sets))


@pytest.mark.parametrize("case", shipped_cases())
def test_no_false_alarm_on_a_shipped_case(case):
    assert {rule for rule, verdict in verdicts(case).items() if verdict != "ok"} == set()


STEP = (
    'fluid.bodies=[{ name = "water", difference = [{ rectangle = [0.0, 0.0, 0.5, 0.5] }, '
    "{ rectangle = [0.075, 0.0, 0.5, 0.1] }] }]"
)
ARCH = (
    'solid.bodies=[{ name = "beam", difference = [{ rectangle = [0.0, 0.0, 0.2, 0.012] }, '
    "{ rectangle = [0.02, 0.0, 0.18, 0.0055] }] }]"
)
LIFTED = (
    'solid.clamps=[{ body="beam", face="left", motion={ times=[0.0, 0.1, 0.2, 0.3], '
    "translation=[[0.0, 0.0], [0.0, 0.1], [0.0, 0.2], [0.0, 0.3]] } }]"
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
    ("window_number", "piston", ["coupling.scheme=serial-explicit"], "window α", "warn"),
    ("window_number", "piston", ["coupling.scheme=parallel-explicit", "coupling.predictor=2"], "window α", "refuse"),
    ("mass_ratio", "piston", ["coupling.scheme=serial-explicit", "coupling.predictor=1",
                              "fluid.column.compressible=false"], "mass ratio", "refuse"),
    ("euler", "dam_break_plate", ["solid.youngs_modulus=1e5"], "Euler", "warn"),
    ("pressed", "udl_beam", ['solid.loads=[{ body="beam", face="right", traction=[1.1e6, 0.0] }]',
                             'solid.clamps=[{ body="beam", face="left" }]'], "strain", "warn"),
    ("carried_along", "udl_beam", [LIFTED], "damping drag", "warn"),
    ("across", "udl_beam", ["solid.dx=4e-3"], "particles across", "warn"),
    ("support", "dam_break_plate", ["fluid.dx=5e-3"], "thickness/support", "warn"),
    ("support", "dam_break_plate", ["fluid.dx=1e-2"], "thickness/support", "refuse"),
    ("support", "dam_break_plate", ["fluid.dx=5e-3", "coupling.loads=pressure"], "thickness/support", "refuse"),
    ("support", "hydrostatic_plate", ["fluid.model=still", "fluid.dx=6e-2", "coupling.loads=pressure"],
     "thickness/support", "refuse"),
    ("support", "two_levels", ["fluid.dx=1.2e-2"], "thickness/support", "refuse"),  # as its run does
    ("wall_ends", "light_gate", ["walls.box.polyline=[[0.12,0.06],[0.0,0.06],[0.0,0.0],[0.12,0.0]]"],
     "open wall ends", "warn"),
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
    ("slopes", "hydrostatic_plate", ["fluid.model=still", "gravity=[0.86, -9.77]"], "level", "refuse"),
    ("jolt", "still_tank", ["goal.statistic=max", "walls.tank.motion={ times = [0.0, 0.1, 0.2], translation = "
                            "[[0.0, 0.0], [1e-3, 0.0], [0.0, 0.0]] }"], "jolt", "warn"),
    ("start_up", "still_tank", ["fluid.initial_pressure=zero"], "start-up", "warn"),
    ("poisson", "udl_beam", ["solid.poisson_ratio=0.495"], "Poisson's ratio", "warn"),
    ("periods_seen", "oscillating_plate", ["goal.statistic=period", "end_time=0.4"], "periods seen", "refuse"),
    ("filled_area", "submerged_block", ["solid.bodies=[{ name='block', circle={ centre=[0.2, 0.16], radius=0.02 } }]",
                                        "solid.dx=0.014"], "filled area", "warn"),
    ("filled_gaps", "still_tank", [STEP], "filled gaps", "warn"),
    ("filled_limbs", "udl_beam", [ARCH], "filled limbs", "warn"),
    ("steps", "udl_beam", ["end_time=1e5"], "steps", "warn"),
    ("steps", "dam_break", ["end_time=1e32"], "steps", "refuse"),
    ("printed_gradient", "udl_beam", ["solid.model=ctvf", "solid.gradient=printed"], "gradient order", "warn"),
)  # fmt: skip


@pytest.mark.parametrize(("rule", "case", "sets", "name", "verdict"), TRIPPED)
def test_rule_is_tripped(rule, case, sets, name, verdict):
    assert verdicts(case, *sets)[name] == verdict


@pytest.mark.parametrize(("low", "warned"), [(0.0, True), (-0.01, False), (-0.05, False)])
def test_walls_that_stop_at_a_corner_leave_no_bound(low, warned):
    """Water was stirred there by up to 3 m/s, and leaked, under bounds of 0.1 to 0.9 %."""
    scene = load_scene("hydrostatic_plate", [f"walls.left_wall.polyline=[[0.0, 2.3], [0.0, {low}]]"])
    assert ("open wall ends" in verdicts_of(scene)) == warned
    assert (error_bound(scene, scene_numbers(scene)) > 1.0) == warned


def test_water_at_rest_has_no_mass_that_lag_feels():
    """`--models auto` warned of its own choice for a gate of foam."""
    light = ["solid.density=30", "coupling.scheme=serial-explicit", "fluid.model=still"]
    assert verdicts("hydrostatic_plate", *light)["mass ratio"] == "ok"


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
