"""Pre-flight of scenes that were not used in making its rules: sensible verdicts, no crash."""

from __future__ import annotations

import json
import math

import pytest

from coupler.preflight.bounds.error import error_parts
from coupler.preflight.check import preflight
from coupler.preflight.measures.numbers import scene_numbers
from shared.run.plain import plain
from shared.scene.reading import load_scene
from tests.scenes import SPRUNG, scene_of

HEAD = """\
schema = 1
title = "A stranger's scene"
end_time = 1.0
gravity = [0.0, -9.81]
"""
STEEL_SIDE = """
[fluid]
model = "wcsph"
dx = 5e-3
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.4, 0.3] }]
[[walls]]
name = "floor"
polyline = [[0.0, 0.5], [0.0, 0.0], [0.41, 0.0]]
[solid]
model = "total-lagrangian"
dx = 2.5e-3
density = 7850.0
youngs_modulus = 2.1e11
poisson_ratio = 0.3
bodies = [{ name = "sheet", rectangle = [0.4, 0.0, 0.41, 0.5] }]
clamps = [{ body = "sheet", face = "bottom" }]
[[probes]]
name = "top"
body = "sheet"
point = [0.4, 0.5]
quantity = "displacement-x"
[goal]
probe = "top"
statistic = "GOAL"
error = 0.05
[output]
average_from = 0.5
"""
DROP_ON_RUBBER = """
[fluid]
model = "ctvf"
dx = 4e-3
bodies = [{ name = "drop", circle = { centre = [0.0, 0.2], radius = 0.05 }, velocity = [0.0, -1.0] }]
[solid]
model = "total-lagrangian"
dx = 4e-3
density = 1100.0
youngs_modulus = 1e6
poisson_ratio = 0.45
clamps = [{ body = "bridge", face = "left" }, { body = "bridge", face = "right" }]
[[solid.bodies]]
name = "bridge"
union = [{ rectangle = [-0.2, 0.0, 0.2, 0.03] }, { circle = { centre = [0.0, 0.0], radius = 0.05 } }]
[[solid.bodies]]
name = "ball"
circle = { centre = [0.5, 0.0], radius = 0.04 }
free = true
[[probes]]
name = "middle"
body = "bridge"
point = [0.0, 0.0]
quantity = "displacement-y"
[goal]
probe = "middle"
statistic = "min"
"""
TILTED_IN_SPACE = """
[fluid]
model = "ctvf"
dx = 5e-3
sound_speed = 10.0
bodies = [{ name = "water", polygon = [[0.0, 0.0], [0.2, 0.0], [0.1, 0.2]] }]
[solid]
model = "beam"
dx = 5e-3
density = 500.0
youngs_modulus = 1e8
bodies = [{ name = "wing", rectangle = [0.5, 0.0, 0.9, 0.02], rotate = { angle = 30.0, about = [0.5, 0.0] } }]
clamps = [{ body = "wing", face = "left" }]
[[probes]]
name = "kick"
body = "wing"
quantity = "force-y"
"""


def report(tmp_path, text, *sets):
    scene = scene_of(HEAD + text, tmp_path, sets)
    found = preflight(scene)
    json.dumps(plain(found.as_dict()), allow_nan=False)
    return found


def test_a_steel_sheet_that_holds_back_water_at_rest_needs_resting_water_and_a_beam(tmp_path):
    found = report(tmp_path, STEEL_SIDE.replace("GOAL", "mean"))
    assert {f.rule for f in found.findings if f.verdict != "ok"} == {"thickness/support"}  # 1 cm, particles of 5 mm
    assert found.numbers.water.rests
    assert (found.choice.fluid, found.choice.solid) == ("still", "beam")


def test_the_same_sheet_swinging_needs_water_that_moves(tmp_path):
    found = report(tmp_path, STEEL_SIDE.replace("GOAL", "max"))
    reasons = {rung.fluid: rung.reason for rung in found.ladder if rung.solid == "beam"}
    assert "mass of the water" in reasons["still"]
    assert found.choice is None or found.choice.fluid in ("wcsph", "ctvf")


def test_columns_are_not_replaced_by_particles_that_no_wall_holds(tmp_path):
    text = SPRUNG[SPRUNG.index("[fluid]") :] + '[goal]\nprobe = "y"\nstatistic = "min"\nerror = 0.1\n'
    ladder = report(tmp_path, text).ladder
    cannot = {rung.fluid: rung.reason for rung in ladder if rung.standing == "cannot"}
    assert "nothing holds the water; add [[walls]]" in cannot["wcsph"]
    assert "nothing holds the water; add [[walls]]" in cannot["ctvf"]


def test_without_the_sheet_held_up_the_water_falls(tmp_path):
    found = report(tmp_path, STEEL_SIDE.replace("GOAL", "mean"), "fluid.bodies.water.rectangle=[0.0, 0.0, 0.3, 0.3]")
    assert not found.numbers.water.rests
    assert found.choice.fluid in ("wcsph", "ctvf")


def test_water_that_falls_away_has_no_bound(tmp_path):
    found = report(tmp_path, STEEL_SIDE.replace("GOAL", "mean"), "gravity=[0.0, 9.81]")
    assert found.choice is None
    assert math.isinf(found.error)
    assert any("falls away" in rung.reason for rung in found.ladder)


def test_a_drop_on_a_bridge_of_odd_shape_needs_particles_on_both_sides(tmp_path):
    found = report(tmp_path, DROP_ON_RUBBER, "goal.error=0.4")
    assert found.choice.fluid == "wcsph"
    assert found.choice.solid == "total-lagrangian"
    assert any("rectangle" in rung.reason for rung in found.ladder if rung.solid == "beam")


def test_a_scene_without_goal_or_weight_gets_numbers_and_no_ladder(tmp_path):
    found = report(tmp_path, TILTED_IN_SPACE, "gravity=[0.0, 0.0]")
    assert found.ladder == []
    assert found.choice is None
    assert found.verdict in ("ok", "warn")


@pytest.mark.parametrize(("density", "depth"), [(50.0, 0.45), (20000.0, 0.05)])
@pytest.mark.parametrize("modulus", [1e5, 2e11])
def test_other_materials_and_depths_do_not_break_it(tmp_path, density, depth, modulus):
    sets = (
        f"solid.density={density}",
        f"solid.youngs_modulus={modulus}",
        f"fluid.bodies.water.rectangle=[0.0, 0.0, 0.4, {depth}]",
    )
    found = report(tmp_path, STEEL_SIDE.replace("GOAL", "mean"), *sets)
    assert found.cost.core_s > 0.0
    assert found.verdict in ("ok", "warn", "refuse")


def test_a_plate_that_water_nearly_carries_feels_more_of_its_error(tmp_path):
    """Buoyancy leaves 800 of 1800 kg/m³, and 100 of 1100: its error counts 1.25 and 10 times."""
    bounds = {}
    for density in (1800.0, 1100.0, 1000.0):
        scene = load_scene("cantilever_in_water", [f"solid.density={density}"])
        bounds[density] = error_parts(scene, scene_numbers(scene))[f"fluid {scene.fluid.model}"]
    assert bounds[1100.0] == pytest.approx(8.0 * bounds[1800.0], rel=0.01)
    assert math.isinf(bounds[1000.0])
