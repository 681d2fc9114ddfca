"""Pre-flight of upright plates beside water with a surface, which gives way upward and not along the tank.

Truth: potential flow without waves of a wall that moves as one, 0.543 ρ H² of water (Westergaard); for the plate
between two levels Hermite elements under its own weight, with levels that keep the water's volume.
"""

from __future__ import annotations

import math

import pytest

from coupler.preflight.bounds.error import error_bound
from coupler.preflight.ladder import ladder
from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.rules.joint import helmholtz
from tests.preflights import bound_of
from tests.scenes import scene_of

GATE = """\
schema = 1
title = "A sprung gate at the end of an open tank"
end_time = 0.8
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 0.01
h_over_dx = 2.0
alpha = 0.02
sound_speed = 30.0
bodies = [{ name = "water", rectangle = [0.0, 0.0, LENGTH, 0.2] }]
[[walls]]
name = "tank"
polyline = [[-0.06, 0.0], [LENGTH, 0.0], [LENGTH, 0.35]]
[solid]
model = "spring"
dx = 0.01
density = 1500.0
bodies = [{ name = "gate", rectangle = [-0.04, 0.0, 0.0, 0.3] }]
spring = { stiffness = [6e4, 1e8, 1e6] }
[[probes]]
name = "x"
body = "gate"
point = [0.0, 0.1]
quantity = "displacement-x"
[goal]
probe = "x"
statistic = "period"
error = 0.1
"""
BENDS = [
    "solid.model=beam",
    "solid.youngs_modulus=2e7",
    "solid.poisson_ratio=0.3",
    "solid.spring.stiffness=[0.0, 0.0, 0.0]",
    "solid.bodies.gate.rectangle=[-0.04, 0.0, 0.0, 0.25]",
    "solid.clamps=[{ body = 'gate', face = 'bottom' }]",
    "fluid.sound_speed=auto",
    "probes.x.point=[0.0, 0.25]",
]
LEVELS = [
    "fluid.bodies=[{ name = 'high', rectangle = [0.0, 0.0, 0.2, 0.2] }, "
    "{ name = 'low', rectangle = [0.23, 0.0, 0.43, 0.1] }]",
    "fluid.dx=0.00666667",
    "fluid.model=column",
    "fluid.column.compressible=false",
    "walls.tank.polyline=[[0.0, 0.35], [0.0, 0.0], [0.43, 0.0], [0.43, 0.35]]",
    "solid.model=beam",
    "solid.dx=0.005",
    "solid.density=2000.0",
    "solid.youngs_modulus=2e7",
    "solid.poisson_ratio=0.3",
    "solid.damping=40.0",
    "solid.spring.stiffness=[0.0, 0.0, 0.0]",
    "solid.bodies.gate.rectangle=[0.2, 0.0, 0.23, 0.25]",
    "solid.clamps=[{ body = 'gate', face = 'bottom' }]",
    "probes.x.point=[0.215, 0.25]",
    "goal.statistic=mean",
    "end_time=1.5",
    "output.average_from=0.75",
]

PRESSED = [
    "fluid.model=still",
    "fluid.bodies.water.rectangle=[0.0, 0.0, 0.2, 0.1]",
    "walls.tank.polyline=[[-0.07, 0.0], [0.2, 0.0], [0.2, 0.19]]",
    "solid.density=1500.0",
    "solid.damping=96.0",
    "solid.gravity=false",
    "solid.bodies.gate.rectangle=[-0.014, 0.0, 0.0, 0.14]",
    "probes.x.point=[-0.007, 0.14]",
    "goal.statistic=mean",
    "end_time=0.75",
    "output.average_from=0.4",
]
COUNTER = 'solid.loads=[{ body = "gate", face = "left", traction = [83.42, 0.0] }]'


def gate(tmp_path, length, *sets):
    return scene_of(GATE.replace("LENGTH", str(length)), tmp_path, list(sets))


@pytest.mark.parametrize("length", [0.6, 3.0])
def test_a_gate_moves_the_water_that_gives_way_upward(tmp_path, length):
    """Particles found a period of 0.160 s, 1.3 % off; columns, which were called right to 0.1 %, 0.301 s."""
    scene = gate(tmp_path, length)
    numbers = scene_numbers(scene)
    moved = 1500.0 * 0.04 * 0.3 + 0.543 * 1000.0 * 0.2**2
    assert numbers.joint.wet_frequency == pytest.approx(math.sqrt(6e4 / moved) / (2.0 * math.pi), rel=5e-3)
    assert 0.0128 < error_bound(scene, numbers) < 4.0 * 0.0128
    columns = next(rung for rung in ladder(scene) if rung.name == "column + spring")
    assert columns.error == math.inf
    assert "gives way upward" in columns.reason


def test_a_gate_that_water_reaches_half_up_is_beside_it_too(tmp_path):
    scene = gate(tmp_path, 0.6, "fluid.bodies.water.rectangle=[0.0, 0.0, 0.6, 0.1]", "fluid.model=column")
    assert bound_of(scene) == math.inf


def test_a_dam_is_not_refused_for_the_length_of_its_reservoir(tmp_path):
    """Found: refused, for sound that needs a third of a period to cross 3 m; 10.9 Hz by the beam's own mode."""
    scene = gate(tmp_path, 3.0, *BENDS)
    numbers = scene_numbers(scene)
    assert numbers.joint.wet_frequency == pytest.approx(10.94, rel=0.02)
    assert helmholtz(scene, numbers).verdict == "ok"


@pytest.mark.parametrize(("low", "error"), [(0.18, 0.0346), (0.193333, 0.0390)])
def test_columns_beside_an_upright_plate_do_not_level_out(tmp_path, low, error):
    """Found: 3.5 and 3.9 % under bounds of 2.2 and 1.6 %."""
    sets = [*LEVELS, f"fluid.bodies.low.rectangle=[0.23, 0.0, 0.43, {low}]"]
    scene = gate(tmp_path, 0.43, *sets)
    assert error < bound_of(scene) < 4.0 * error


def test_columns_beside_a_sprung_gate_do_not_level_out(tmp_path):
    """ρ g H²/(T k): what its level, which falls as it yields, takes off."""
    sets = ["fluid.model=column", "fluid.column.compressible=false", "goal.statistic=mean"]
    bounds = [bound_of(s) for s in (gate(tmp_path, length, *sets) for length in (0.6, 300.0))]
    assert bounds[0] - bounds[1] == pytest.approx(9810.0 * 0.2**2 / (0.6 * 6e4), rel=0.01)


@pytest.mark.parametrize(
    ("sets", "error"),
    [
        (("solid.dx=0.007",), 0.0508),
        (("solid.dx=0.007", "probes.x.point=[-0.007, 0.07]"), 0.0238),
        (("solid.dx=0.0028", "solid.model=total-lagrangian"), 0.0671),
        (("solid.dx=0.0028", "solid.model=total-lagrangian", "probes.x.point=[-0.007, 0.07]"), 0.0539),
    ],
)
def test_what_is_left_of_water_by_a_load_on_the_dry_side_feels_more_of_its_error(tmp_path, sets, error):
    """Half of the water's moment at the foot leaves a fifth of its way at the tip: told were 2.0 to 3.5 %."""
    bound = bound_of(gate(tmp_path, 0.2, *BENDS, *PRESSED, COUNTER, *sets))
    assert error <= bound <= 4.0 * error


def test_a_force_of_water_at_rest_feels_little_of_the_plate(tmp_path):
    """0.1 % off; all of the plate's error was counted, 0.9 to 2.6 %."""
    probe = 'probes=[{ name = "x", quantity = "force-x", body = "gate" }]'
    assert 0.001 <= bound_of(gate(tmp_path, 0.2, *BENDS, *PRESSED, "solid.dx=0.007", probe)) < 0.005
