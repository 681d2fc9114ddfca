"""Pre-flight of water by itself: what models that are not made of particles cannot say, and bounds of what flows."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from coupler.preflight_afloat import to_equilibrium
from coupler.preflight_error import error_bound
from coupler.preflight_ladder import ladder, smallest
from coupler.preflight_numbers import scene_numbers
from coupler.preflight_rules import findings
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


def test_no_pair_is_named_that_a_run_would_refuse(tmp_path):
    """The window that the scene asks for is too long for water that bears sound, not for water at rest."""
    asked = ["coupling.window=0.05", "probes.push.body=window", "probes.push.quantity=force-x"]
    rungs = ladder(scene_of(WINDOW, tmp_path, asked))
    reasons = {rung.fluid: rung.reason for rung in rungs if rung.solid == "beam"}
    assert "window α" in reasons["wcsph"]
    assert smallest(rungs).fluid == "still"
    text = WINDOW.replace(
        'name = "push"', 'name = "p"\nquantity = "pressure"\npoint = [0.25, 0.1]\n[[probes]]\nname = "push"'
    )
    assert smallest(ladder(scene_of(text, tmp_path, ["coupling.window=0.05"]))) is None


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


# ---- speeds of structures --------------------------------------------------------------------------------------------

BLOCK = """\
schema = 1
title = "A block in a tank"
end_time = 0.5
[fluid]
model = "wcsph"
dx = 0.02
bodies = [{ name = "w", difference = [{ rectangle = [0, 0, 1.0, 0.6] }, { rectangle = [0.3, 0.2, 0.5, 0.4] }] }]
[[walls]]
name = "tank"
polyline = [[0, 0.6], [0, 0], [1.0, 0], [1.0, 0.6]]
closed = true
[solid]
model = "spring"
dx = 0.02
density = 2000.0
bodies = [{ name = "b", rectangle = [0.3, 0.2, 0.5, 0.4], MOVES, free = true }]
[[probes]]
name = "x"
body = "b"
point = [0.4, 0.3]
quantity = "displacement-x"
"""


@pytest.mark.parametrize(
    ("moves", "sets", "speed"),
    [
        ("velocity = [3.0, 0.0]", [], 3.0),
        ("spin = 10.0", [], 10.0 * math.hypot(0.1, 0.1)),
        ("velocity = [0.0, 0.0]", ["solid.loads=[{ body = 'b', acceleration = [0.4, 0.0] }]"], 0.2),
        ("velocity = [0.0, 0.0]", ["solid.loads=[{ body = 'b', acceleration = [80.0, 0.0] }]"], math.sqrt(160.0)),
        ("velocity = [0.0, 0.0]", ["solid.loads=[{ body = 'b', face = 'left', traction = [200.0, 0.0] }]"], 0.25),
        (
            "velocity = [0.0, 0.0]",
            ["solid.loads=[{ body = 'b', acceleration = [0.4, 0.0] }]", "solid.spring.stiffness=[8000.0, 0.0, 0.0]"],
            0.4 / 10.0,
        ),
    ],
)
def test_what_moves_in_the_water_tells_its_sound_speed(tmp_path, moves, sets, speed):
    """Found: a block at 3 m/s in water whose sound ran at 3.46 m/s; 2412 kg/m³."""
    scene = scene_of(BLOCK.replace("MOVES", moves), tmp_path, sets)
    water = scene_numbers(scene).water
    assert water.speed == pytest.approx(speed)
    assert make_model(scene, True, 1).describe().numbers["sound_speed"] == pytest.approx(10.0 * speed)
    slow = scene_of(BLOCK.replace("MOVES", moves), tmp_path, [*sets, f"fluid.sound_speed={speed}"])
    assert {f.rule: f.verdict for f in findings(slow, scene_numbers(slow))}["Mach"] == "refuse"


def test_water_in_which_a_body_drifts_does_not_rest(tmp_path):
    rests = {}
    for held in (0.0, 1e4):
        sets = [f"solid.spring.stiffness=[{held}, {held}, 0.0]"]
        scene = scene_of(BLOCK.replace("MOVES", "velocity = [1.0, 0.0]"), tmp_path, sets)
        rests[held] = scene_numbers(scene).water.rests
    assert rests == {0.0: False, 1e4: True}


def test_a_body_that_falls_into_water_tells_a_speed(tmp_path):
    text = BLOCK.replace("MOVES", "velocity = [0.0, 0.0]").replace("rectangle = [0.3, 0.2, 0.5, 0.4],", "HIGH,")
    text = text.replace("HIGH", "rectangle = [0.3, 1.0, 0.5, 1.2]").replace("[0.4, 0.3]", "[0.4, 1.1]")
    scene = scene_of(text, tmp_path, ["gravity=[0.0, -9.81]"])
    assert scene_numbers(scene).water.speed == pytest.approx(math.sqrt(2.0 * 9.81 * 1.0))


# ---- bounds ----------------------------------------------------------------------------------------------------------

VORTICES = """\
schema = 1
title = "Small vortices, Re 50"
end_time = 1.5
[fluid]
model = "ctvf"
dx = 2.5e-3
viscosity = 2e-4
alpha = 0.0
shake = 0.2
h_over_dx = 3.0
periodic = { x = [0.0, 0.1], y = [0.0, 0.1] }
[[fluid.bodies]]
name = "water"
rectangle = [0.0, 0.0, 0.1, 0.1]
velocity_field = { kind = "taylor-green", speed = 0.1, wavelength = 0.1 }
[[probes]]
name = "e"
quantity = "kinetic-energy"
body = "water"
[goal]
probe = "e"
statistic = "decay"
error = 0.05
"""
CHANNEL = """\
schema = 1
title = "Flow in a channel"
end_time = 1.5
gravity = [0.08, 0.0]
[fluid]
model = "wcsph"
dx = 1e-3
viscosity = 1e-4
alpha = 0.0
h_over_dx = 2.0
initial_pressure = "zero"
periodic = { x = [0.0, 0.01] }
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.01, 0.01] }]
[[walls]]
name = "low"
slip = "no"
polyline = [[0.0, 0.0], [0.01, 0.0]]
[[walls]]
name = "up"
slip = "no"
polyline = [[0.01, 0.01], [0.0, 0.01]]
[[probes]]
name = "u"
quantity = "velocity-x"
point = [0.005, 0.005]
[goal]
probe = "u"
statistic = "final"
error = 0.05
"""
SLAB = """\
schema = 1
title = "A slab of water falls"
end_time = 0.3
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 0.01
bodies = [{ name = "water", rectangle = [0.4, 0.6, 0.6, 0.8] }]
[[walls]]
name = "tank"
polyline = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
[[probes]]
name = "v"
quantity = "max-speed"
body = "water"
[goal]
probe = "v"
statistic = "final"
error = 0.1
"""
FLOOR = """\
schema = 1
title = "A tank on a sprung floor"
end_time = 2.0
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 0.025
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.5, 1.0] }]
[[walls]]
name = "left"
polyline = [[0.0, 1.5], [0.0, -0.5]]
[[walls]]
name = "right"
polyline = [[0.5, -0.5], [0.5, 1.5]]
[solid]
model = "spring"
dx = 0.025
density = 2000.0
bodies = [{ name = "floor", rectangle = [0.0, -0.1, 0.5, 0.0] }]
spring = { stiffness = [0.0, 94748.2, 0.0] }
[[probes]]
name = "y"
quantity = "displacement-y"
body = "floor"
point = [0.25, 0.0]
[goal]
probe = "y"
statistic = "min"
error = 0.05
"""
RAFT = """\
schema = 1
title = "A raft finds its draught"
end_time = 6.0
gravity = [0.0, -9.81]
[fluid]
model = "ctvf"
dx = 0.015
bodies = [{ name = "water", difference = [{ rectangle = [0.0, 0.0, 1.0, 0.5] },
  { rectangle = [0.35, 0.42, 0.65, 0.52] }] }]
[[walls]]
name = "tank"
polyline = [[0.0, 0.8], [0.0, 0.0], [1.0, 0.0], [1.0, 0.8]]
[solid]
model = "spring"
dx = 0.01
density = 600.0
bodies = [{ name = "raft", rectangle = [0.35, 0.42, 0.65, 0.52], free = true }]
[[probes]]
name = "y"
quantity = "displacement-y"
body = "raft"
point = [0.5, 0.47]
[goal]
probe = "y"
statistic = "mean"
error = 0.1
[output]
average_from = 4.0
"""
PRESSURE = TANK.replace('quantity = "force-y"\nbody = "tank"', 'quantity = "pressure"\npoint = [0.25, 0.45]')
MEASURED = [
    *(
        (VORTICES, [f"fluid.dx={dx}", f"fluid.h_over_dx={ratio}", f"goal.statistic={statistic}"], error)
        for dx, ratio, statistic, error in (
            (5e-3, 3.0, "decay", 0.0706),
            (2.5e-3, 3.0, "decay", 0.0185),
            (5e-3, 2.0, "decay", 0.0381),
            (5e-3, 1.3, "decay", 0.0346),
            (2.5e-3, 1.3, "decay", 0.0430),
            (5e-3, 3.0, "final", 0.384),
            (2.5e-3, 3.0, "final", 0.0878),
            (5e-3, 2.0, "final", 0.177),
        )
    ),
    (VORTICES, ["fluid.model=wcsph", "fluid.h_over_dx=2.0"], 0.186),
    (VORTICES, ["fluid.model=wcsph", "fluid.h_over_dx=1.3"], 0.389),
    *(("taylor_green", [f"fluid.dx={dx}"], error) for dx, error in ((0.04, 0.0365), (0.02, 0.0096), (0.01, 0.0026))),
    (CHANNEL, [], 0.0185),
    *(
        (PRESSURE, [f"fluid.model={model}", f"fluid.dx={dx}", f"probes.push.point=[0.25, {0.5 - depth}]"], error)
        for model, dx, depth, error in (
            ("ctvf", 0.04, 0.025, 0.366),
            ("ctvf", 0.04, 0.05, 0.122),
            ("ctvf", 0.04, 0.1, 0.0115),
            ("wcsph", 0.04, 0.05, 0.095),
            ("ctvf", 0.02, 0.025, 0.096),
            ("ctvf", 0.02, 0.1, 0.0099),
            ("ctvf", 0.02, 0.2, 0.0042),
            ("ctvf", 0.01, 0.05, 0.0243),
            ("ctvf", 0.01, 0.2, 0.0054),
            ("wcsph", 0.01, 0.1, 0.0118),
        )
    ),
    (SLAB, [], 0.0117),
    (SLAB, ["fluid.dx=0.003333"], 0.0058),
    (SLAB, ["fluid.sound_speed=40"], 0.0050),
    (SLAB, ["fluid.model=ctvf", "fluid.dx=0.02"], 0.0004),
    (FLOOR, [], 0.0251),
    (RAFT, [], 0.257),
]


@pytest.mark.parametrize(("text", "sets", "error"), MEASURED)
def test_bounds_of_water_hold_what_was_measured(tmp_path, text, sets, error):
    """Bound at least the error, at most four times it or 0.3 %."""
    scene = scene_of(text, tmp_path, sets) if "\n" in text else load_scene(text, sets)
    assert error <= error_bound(scene, scene_numbers(scene)) <= max(4.0 * error, 0.003)


def test_the_motion_of_water_at_rest_has_no_relative_error(tmp_path):
    text = TANK.replace('quantity = "force-y"\nbody = "tank"', 'quantity = "max-speed"\nbody = "water"')
    rungs = ladder(scene_of(text, tmp_path))
    assert smallest(rungs) is None
    assert any("the water rests" in rung.reason for rung in rungs)


def test_a_pressure_above_the_water_has_no_bound(tmp_path):
    scene = scene_of(PRESSURE, tmp_path, ["probes.push.point=[0.25, 0.52]"])
    assert smallest(ladder(scene)) is None


def test_the_way_of_a_raft_is_that_of_archimedes(tmp_path):
    """From 8 to 6 cm of draught, while the level of a tank three tenths of which it covers falls by 6 mm."""
    assert to_equilibrium(scene_of(RAFT, tmp_path), "raft") == pytest.approx(0.014)
    sprung = scene_of(RAFT, tmp_path, [f"solid.spring.stiffness=[0.0, {1000 * 9.81 * 0.3 / 0.7}, 0.0]"])
    assert to_equilibrium(sprung, "raft") == pytest.approx(0.007)


def test_what_falls_on_something_is_no_free_fall(tmp_path):
    bounds = [error_bound(scene, scene_numbers(scene)) for scene in
              (scene_of(SLAB, tmp_path, [f"end_time={end}"]) for end in (0.3, 0.36))]  # fmt: skip
    assert bounds[0] < 0.03
    assert bounds[1] == pytest.approx(0.25)


def test_water_that_its_weight_drives_along_a_period_does_not_rest(tmp_path):
    """Found: a warning that it starts without its hydrostatic pressure, of which there is none along a period."""
    scene = scene_of(CHANNEL, tmp_path)
    numbers = scene_numbers(scene)
    assert not numbers.water.rests
    assert {f.rule for f in findings(scene, numbers) if f.verdict != "ok"} == set()
