"""Pre-flight of water by itself: what models that are not made of particles cannot say, and bounds of what flows."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from coupler.preflight_ladder import ladder, smallest
from fluid_solver.models import make_model
from shared.commands import conclude
from shared.contract import BadInput, Kinematics
from shared.probes import ProbeTable, probe_units
from shared.results import make_result
from shared.scene import load_scene
from tests.test_column import SPRUNG

TANK = """\
schema = 1
title = "Water at rest"
end_time = 1.0
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 0.02
h_over_dx = 2.0
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.5, 0.5] }]
[[walls]]
name = "tank"
polyline = [[0.0, 0.75], [0.0, 0.0], [0.5, 0.0], [0.5, 0.75]]
[[probes]]
name = "push"
quantity = "force-y"
body = "tank"
[goal]
probe = "push"
statistic = "mean"
error = 0.05
[output]
average_from = 0.5
"""
WINDOW = (
    TANK.replace("[0.5, 0.0], [0.5, 0.75]", "[0.51, 0.0]")
    + """
[solid]
model = "beam"
dx = 5e-3
density = 1190.0
youngs_modulus = 3.2e9
bodies = [{ name = "window", rectangle = [0.5, 0.0, 0.51, 0.5] }]
clamps = [{ body = "window", face = "bottom" }, { body = "window", face = "top" }]
"""
)


def scene_of(text, folder, sets=()):
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return load_scene(folder / "case.toml", sets)


def left_out(scene):
    return {rung.fluid: rung.reason for rung in ladder(scene) if rung.standing == "cannot"}


def test_water_without_a_structure_is_not_left_to_models_that_load_one(tmp_path):
    """Found: named as the smallest, and then refused as the run began."""
    scene = scene_of(TANK, tmp_path)
    assert "a structure, and there is none" in left_out(scene)["still"]
    assert smallest(ladder(scene)).fluid in ("wcsph", "ctvf")
    with pytest.raises(BadInput, match="no fluid body touches a face"):
        scene_of(TANK.replace('force-y"\nbody = "tank"', 'level"'), tmp_path, ["fluid.model=still"])


def test_water_that_touches_no_structure_is_not_left_to_them_either(tmp_path):
    text = WINDOW.replace("rectangle = [0.5, 0.0, 0.51, 0.5]", "rectangle = [0.7, 0.0, 0.71, 0.5]")
    text = text.replace('body = "tank"', 'body = "window"')
    assert "no fluid body touches a face" in left_out(scene_of(text, tmp_path))["still"]


def test_the_force_on_a_wall_is_nothing_that_resting_water_knows(tmp_path):
    """Found: 0.46 % promised, and no value. The force on the structure it does know."""
    assert {"still", "column"} <= set(left_out(scene_of(WINDOW, tmp_path)))
    assert smallest(ladder(scene_of(WINDOW, tmp_path))).fluid in ("wcsph", "ctvf")
    on_it = scene_of(WINDOW, tmp_path, ["probes.push.body=window", "probes.push.quantity=force-x"])
    assert smallest(ladder(on_it)).fluid == "still"


def test_columns_leave_the_force_on_a_wall_out(tmp_path):
    text = SPRUNG + '[[walls]]\nname = "bed"\npolyline = [[0.0, -1.0], [1.0, -1.0]]\n'
    text += '[[probes]]\nname = "bed"\nbody = "bed"\nquantity = "force-y"\n'
    model = make_model(scene_of(text, tmp_path), True, 1)
    model.begin(Kinematics.at_rest(model.describe().position))
    assert "bed" not in model.probe_values()


@pytest.mark.parametrize(("value", "said"), [(math.nan, "no such probe"), (1.0, "did not happen")])
def test_a_run_without_a_value_of_its_goal_says_so(tmp_path, capsys, value, said):
    scene = scene_of(WINDOW, tmp_path, ["goal.statistic=period"])
    table = ProbeTable(tmp_path / "probes.csv", probe_units(scene))
    for time in (0.0, 1.0):
        table.append(time, {"push": value})
    given = {"case": "case", "status": "finished", "reason": "", "t_end": 1.0, "cost": {}, "threads": {}}
    conclude(SimpleNamespace(result=make_result(scene, "", table, **given)), quiet=True)
    said_of_it = capsys.readouterr().err
    assert "no value of its goal, the period of push" in said_of_it
    assert said in said_of_it
