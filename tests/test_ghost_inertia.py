"""Whether a structure's acceleration enters the pressure of the fluid's ghosts in it."""

from __future__ import annotations

import pytest

from coupler.stability.theory import PREDICTION, Y, lagged_wall, largest_stable
from shared.ghost_inertia import ghost_inertia, ghosts_feel_acceleration, largest_inertia
from shared.scene.reading import load_scene
from shared.schema.coupling import Coupling


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


def test_pressures_fall_on_the_outermost_layer():
    scene = load_scene("dam_break_plate", ["coupling.loads=pressure"])
    assert ghost_inertia(scene) == pytest.approx(1000.0 * 2e-3 / (2500.0 * 1e-3))
    assert ghosts_feel_acceleration(scene)
    assert not ghosts_feel_acceleration(load_scene("dam_break_plate", ["coupling.loads=pressure", "fluid.dx=3e-3"]))
    beam = load_scene("dam_break_plate", ["coupling.loads=pressure", "solid.model=beam"])
    assert ghost_inertia(beam) == pytest.approx(1000.0 * 2e-3 / (2500.0 * 0.012))


def test_what_no_load_moves_is_felt_however_light():
    assert ghosts_feel_acceleration(load_scene("two_reservoirs", ["solid.density=1.0"]))
    assert ghosts_feel_acceleration(load_scene("still_tank"))


@pytest.mark.parametrize("asked", [True, False])
def test_the_scene_has_the_last_word(asked):
    for case in ("dam_break_plate", "light_gate"):
        scene = load_scene(case, [f"fluid.structure_acceleration={str(asked).lower()}"])
        assert ghosts_feel_acceleration(scene) is asked


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("scheme", ["serial", "parallel"])
def test_lagged_exchange_holds_what_is_let_in(scheme, order):
    """m v (1 − y) = Δt Q F̄;  F̄ = −ρ c w v̄ − μ m (1 − y)/Δt V,  V = v (serial), Q v (parallel), at the α of automatic
    windows."""
    load, wall = PREDICTION[order], lagged_wall(scheme, order)
    ghosts = load * load if scheme == "parallel" else load
    limit = largest_stable(lambda mu: 2 * (1 - Y) + 0.07 * (1 + Y) * load * wall + 2 * mu * (1 - Y) * ghosts, 2.0)
    coupling = Coupling(scheme=f"{scheme}-explicit", predictor=order)
    assert 0.6 * limit < largest_inertia(coupling) <= 1.0001 * limit
    assert largest_inertia(Coupling(scheme=f"{scheme}-implicit", predictor=order)) == 1.0
