"""Which motions of walls push the water."""

import numpy as np
import pytest

from coupler.preflight.measures.water import measure_water
from shared.expected_speed import water_speed
from shared.geometry.wall_speeds import lasting_faces, pushing_speed
from shared.schema.fluid import Wall
from shared.schema.geometry import Motion
from tests.fluid_models import scene

WATER = np.array([(0.0, 0.0), (0.2, 0.0), (0.2, 0.2), (0.0, 0.2)])
LIFTED = {"times": [0.0, 0.05, 0.1], "translation": [(0.0, 0.0), (0.0, 0.15), (0.0, 0.5)]}
FREE_FALL = np.sqrt(2.0 * 9.81 * 0.2)


def wall(*polyline, motion=None, **more):
    return Wall(name="w", polyline=list(polyline), motion=motion and Motion(**motion), **more)


def steady(**motion):
    return {"times": [0.0, 1.0, 2.0]} | motion


@pytest.mark.parametrize(
    ("polyline", "motion", "more", "speed"),
    [
        ([(0.2, 0.0), (0.2, 0.3)], steady(translation=[(0.0, 0.0), (0.0, 1.0), (0.0, 2.0)]), {}, 0.0),
        ([(0.2, 0.0), (0.2, 0.3)], steady(translation=[(0.0, 0.0), (0.0, 1.0), (0.0, 2.0)]), {"slip": "no"}, 1.0),
        ([(0.2, 0.0), (0.2, 0.1)], steady(translation=[(0.0, 0.0), (0.0, 1.0), (0.0, 2.0)]), {}, 1.0),  # into water
        ([(0.1, 0.3), (0.1, 0.9)], steady(translation=[(0.0, 0.0), (0.0, -0.1), (0.0, -0.2)]), {}, 0.1),  # comes down
        ([(0.0, 0.3), (0.0, 0.0)], steady(translation=[(0.0, 0.0), (2.0, 1.0), (4.0, 2.0)]), {}, 2.0),  # a piston
        ([(0.2, 0.0), (0.2, 0.3)], steady(translation=[(0.0, 0.0), (0.0, 1e30), (0.0, 2e30)]), {}, 0.0),  # far away
        ([(0.0, 0.0), (3.0, 0.0)], steady(rotation=[0.0, 10.0, 20.0]), {}, 3.0 * np.radians(10.0)),
        ([(0.0, 0.0), (3.0, 0.0)], None, {"slip": "no", "surface_speed": -0.7}, 0.7),
    ],
)
def test_the_speed_at_which_a_wall_pushes(polyline, motion, more, speed):
    assert pushing_speed(wall(*polyline, motion=motion, **more), WATER) == pytest.approx(speed, abs=1e-9)


def test_water_behind_a_gate_that_is_lifted_is_let_go_at_the_speed_of_its_fall():
    """Lifted at up to 8 m/s; counted as a piston, it made sound four times as fast, and the water counted as held."""
    tank = {"name": "tank", "polyline": [(0.0, 0.5), (0.0, 0.0), (0.8, 0.0), (0.8, 0.5)]}
    gate = {"name": "gate", "polyline": [(0.2, 0.0), (0.2, 0.25)], "motion": LIFTED}
    case = scene([{"name": "water", "rectangle": (0.0, 0.0, 0.2, 0.2)}], walls=[tank, gate], dx=0.01)
    assert water_speed(case) == pytest.approx(FREE_FALL)
    assert not measure_water(case).held
    assert not measure_water(case).rests
    np.testing.assert_allclose(lasting_faces(case.walls[1])[0, :, 1], [0.5, 0.75])


def test_a_piston_holds_the_water_from_where_it_starts():
    motion = steady(translation=[(0.0, 0.0), (0.1, 0.0), (0.2, 0.0)])
    np.testing.assert_allclose(lasting_faces(wall((0.0, 0.3), (0.0, 0.0), motion=motion))[0], [(0.0, 0.3), (0.0, 0.0)])


@pytest.mark.parametrize(
    ("end_time", "gravity", "speed"),
    [(1.0, (0.0, -9.81), np.sqrt(2.0 * 9.81 * 1.1)), (0.2, (0.0, -9.81), 0.2 * 9.81), (1.0, (0.0, 9.81), 1.4007)],
)
def test_water_falls_on_to_floors_below_it(end_time, gravity, speed):
    """Expected was its fall over its own height, 1.4 m/s: at the floor it ran at a third of the speed of sound."""
    tank = {"name": "tank", "polyline": [(-0.5, 0.5), (-0.5, 0.0), (0.5, 0.0), (0.5, 0.5)]}
    drop = [{"name": "drop", "rectangle": (0.0, 1.0, 0.1, 1.1)}]
    case = scene(drop, walls=[tank], gravity=gravity).model_copy(update={"end_time": end_time})
    assert water_speed(case) == pytest.approx(speed, rel=1e-4)


def test_water_falls_on_to_a_structure_below_it():
    drop, plate = {"name": "drop", "rectangle": (0.0, 1.0, 0.1, 1.1)}, {"name": "p", "rectangle": (-0.5, 0.0, 0.5, 0.1)}
    case = scene([drop], solid={"model": "rigid", "dx": 0.01, "density": 2e3, "bodies": [plate]})
    assert water_speed(case) == pytest.approx(np.sqrt(2.0 * 9.81 * 1.0))
