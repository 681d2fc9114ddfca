"""Pre-flight of forces on structures that stand in a corner with walls, against ρ g H L and ρ g H²/2."""

from __future__ import annotations

import pytest

from shared.scene.reading import load_scene
from tests.preflights import bound_of
from tests.scenes import scene_of
from tests.test_preflight_swing import FLOOR
from tests.test_preflight_upright import BENDS, PRESSED, gate

PUSH = "probes=[{{ name = 'mid_y', quantity = '{}', body = 'floor' }}]"
DEEP = (
    "fluid.bodies.water.rectangle=[0.0, 0.0, 0.2, 0.1]",
    "walls.left.polyline=[[0.0, 0.16], [0.0, -0.01]]",
    "walls.right.polyline=[[0.2, -0.01], [0.2, 0.16]]",
    "solid.bodies.floor.rectangle=[0.0, -0.01, 0.2, 0.0]",
    "fluid.dx=0.005",
    "solid.dx=0.005",
    "solid.damping=1478.0",
    "solid.youngs_modulus=5e7",
    "solid.density=1200.0",
    "end_time=0.555",
    "output.average_from=0.333",
)


@pytest.mark.parametrize(
    ("model", "quantity", "error"),
    [("wcsph", "force-y", 0.0168), ("ctvf", "force-y", 0.0191), ("ctvf", "reaction-y", 0.0167)],
)
def test_walls_take_a_strip_of_what_presses_a_floor(tmp_path, model, quantity, error):
    """3.4 to 3.8 mm of 200 at 5 mm; 0.5 and 1.1 % were told with ctvf."""
    scene = scene_of(FLOOR, tmp_path, [*DEEP, f"fluid.model={model}", PUSH.format(quantity)])
    assert error <= bound_of(scene) <= 4.0 * error


@pytest.mark.parametrize(("model", "error"), [("wcsph", 0.0437), ("ctvf", 0.0413)])
def test_a_floor_takes_a_strip_of_what_presses_a_gate(tmp_path, model, error):
    """2.2 mm at the foot, where the pressure is twice the mean."""
    probe = 'probes=[{ name = "x", quantity = "force-x", body = "gate" }]'
    sets = [*BENDS, *PRESSED, f"fluid.model={model}", "fluid.dx=0.005", "solid.youngs_modulus=2e7", probe]
    sets += ["solid.bodies.gate.rectangle=[-0.03, 0.0, 0.0, 0.14]"]
    sets += ["walls.tank.polyline=[[-0.09, 0.0], [0.2, 0.0], [0.2, 0.19]]"]
    assert error <= bound_of(gate(tmp_path, 0.2, *sets)) <= 4.0 * error


@pytest.mark.parametrize(
    ("width", "quantity", "error"),
    [(0.03, "reaction-x", 0.614), (0.06, "reaction-x", 0.267), (0.03, "force-x", 0.0393)],
)
def test_clamps_of_a_gate_that_closes_a_box_bear_what_the_water_leaves(width, quantity, error):
    """A sixteenth or a ninth of the push: reactions 22 to 61 % too large, told as 16 to 45; a force 4 % too low."""
    walls = f"walls.box.polyline=[[{width + 0.012}, 0.06], [0.0, 0.06], [0.0, 0.0], [{width + 0.012}, 0.0]]"
    sets = [f"fluid.bodies.water.rectangle=[0.0, 0.0, {width}, 0.06]", walls, "references=[]"]
    sets += [f"solid.bodies.gate.rectangle=[{width}, 0.0, {width + 0.012}, 0.06]", "goal.statistic=mean"]
    sets += [f"probes=[{{ name = 'pressure', body = 'gate', quantity = '{quantity}' }}]", "output.average_from=0.06"]
    assert error <= bound_of(load_scene("light_gate", sets))
