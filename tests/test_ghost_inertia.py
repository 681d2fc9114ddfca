"""Whether a structure's acceleration enters the pressure of the fluid's ghosts in it."""

from __future__ import annotations

import pytest

from shared.ghost_inertia import ghost_inertia, ghosts_feel_acceleration
from shared.scene import load_scene


@pytest.mark.parametrize(
    ("case", "inertia", "feels"),
    [
        ("dam_break_plate", 1000.0 * 2e-3 / (2500.0 * 0.012), True),
        ("light_gate", 1000.0 * 3e-3 / (75.0 * 0.012), False),
    ],
)
def test_a_structure_that_outweighs_a_layer_of_water_is_felt(case, inertia, feels):
    scene = load_scene(case)
    assert ghost_inertia(scene) == pytest.approx(inertia)
    assert ghosts_feel_acceleration(scene) is feels


def test_what_no_load_moves_is_felt_however_light():
    assert ghosts_feel_acceleration(load_scene("two_reservoirs", ["solid.density=1.0"]))
    assert ghosts_feel_acceleration(load_scene("still_tank"))


@pytest.mark.parametrize("asked", [True, False])
def test_the_scene_has_the_last_word(asked):
    for case in ("dam_break_plate", "light_gate"):
        scene = load_scene(case, [f"fluid.structure_acceleration={str(asked).lower()}"])
        assert ghosts_feel_acceleration(scene) is asked
