"""Water at rest keeps its volume: its level answers to what moves the faces that hold it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fluid_solver.still import StillWater
from shared.contract import Kinematics, SolverFailed
from tests.scenes import scene_of

G, RHO = 9.81, 1000.0
TANK = """
schema = 1
title = "a pool held by a wall and a floor"
end_time = 1.0
gravity = [0.0, -9.81]
[fluid]
model = "still"
dx = 0.01
bodies = [{waters}]
[solid]
model = "rigid"
dx = 0.01
density = 2000.0
bodies = [{solids}]
[[probes]]
name = "level"
quantity = "level"
[[probes]]
name = "p"
quantity = "pressure"
point = [0.25, 0.05]
"""
POOL = '{ name = "a", rectangle = [0.0, 0.0, 0.5, 0.4] }'
WALL = '{ name = "wall", rectangle = [0.5, 0.0, 0.6, 0.8] }'
FLOOR = '{ name = "floor", rectangle = [0.0, -0.1, 0.5, 0.0] }'
AROUND = """{ name = "a", difference = [{ rectangle = [0.0, 0.0, 0.5, 0.4] },
{ rectangle = [0.2, 0.3, 0.3, 0.5] }] }"""
RAFT = '{ name = "raft", rectangle = [0.2, 0.3, 0.3, 0.5] }'


def water(tmp_path, waters, solids):
    return StillWater(scene_of(TANK.format(waters=waters, solids=solids), tmp_path), coupled=True, threads=1)


def moved(model, move):
    """Loads, and probes, with the faces' points at `move` of where they were."""
    place = move(model.describe().position)
    rest = np.zeros_like(place)
    loads = model.advance(0.0, 0.5, 1, Kinematics(place, rest, rest, rest, rest))
    return place, loads, model.probe_values()


def test_a_wall_that_yields_lowers_the_level(tmp_path):
    model = water(tmp_path, POOL, WALL)
    place, loads, probes = moved(model, lambda x: x + [0.1, 0.0])
    level = 0.4 * 0.5 / 0.6
    assert probes["level"] == pytest.approx(level, rel=1e-8)
    assert probes["p"] == pytest.approx(RHO * G * (level - 0.05), rel=1e-8)
    assert loads.pressure == pytest.approx(RHO * G * np.maximum(level - place[:, 1], 0.0), rel=1e-8, abs=1e-6)


def test_a_wall_that_leans_in_raises_it_and_wets_what_was_dry(tmp_path):
    """V = b h + ∫ w dy with w = −y tan θ below the level: h of b h − h²/2 tan θ = V."""
    tilt = 0.2
    model = water(tmp_path, POOL, WALL)
    turn = np.array([[math.cos(tilt), math.sin(tilt)], [-math.sin(tilt), math.cos(tilt)]])
    place, loads, probes = moved(model, lambda x: (x - [0.5, 0.0]) @ turn + [0.5, 0.0])
    slope = math.tan(tilt)
    level = (0.5 - math.sqrt(0.25 - 2.0 * slope * 0.2)) / slope
    assert probes["level"] == pytest.approx(level, rel=1e-8)
    wet = place[:, 1] < level
    assert wet.sum() > 41  # nodes that the water touched at first
    assert loads.pressure[wet] == pytest.approx(RHO * G * (level - place[wet, 1]), rel=1e-8)


def test_a_turned_scene_has_its_level_in_spite_of_rounded_numbers(tmp_path):
    """The wall that yields, with all of it turned by 37 degrees and gravity to ten digits."""
    waters, solids = (text.replace("] }", "], rotate = { angle = 37.0 } }") for text in (POOL, WALL))
    scene = TANK.format(waters=waters, solids=solids)
    model = StillWater(scene_of(scene, tmp_path, ["gravity=[5.903805377, -7.834614354]"]), coupled=True, threads=1)
    _, loads, _ = moved(model, lambda x: x + 0.1 * np.array([0.7986355100, 0.6018150232]))
    level = 0.4 * 0.5 / 0.6
    assert np.hypot(*loads.force.sum(axis=0)) == pytest.approx(0.5 * RHO * G * (0.4**2 + level**2) / 2.0, rel=1e-3)


def test_a_floor_that_sinks_takes_all_of_its_water_along(tmp_path):
    model = water(tmp_path, POOL, FLOOR)
    _, loads, probes = moved(model, lambda x: x - [0.0, 0.05])
    assert probes["level"] == pytest.approx(0.35, rel=1e-8)
    assert loads.pressure == pytest.approx(RHO * G * 0.4, rel=1e-8)


def test_a_raft_that_sinks_lifts_the_water_beside_it(tmp_path):
    model = water(tmp_path, AROUND, RAFT)
    moved(model, lambda x: x - [0.0, 0.04])
    _, loads, probes = moved(model, lambda x: x - [0.0, 0.04])
    level = 0.4 + 0.04 * 0.1 / 0.4
    assert probes["level"] == pytest.approx(level, rel=1e-8)
    assert loads.force.sum(axis=0) == pytest.approx([0.0, RHO * G * 0.1 * (level - 0.26)], rel=1e-8, abs=1e-9)


def test_pressures_are_no_farther_apart_than_two_particles_of_a_solid(tmp_path):
    """A bed of gel was pressed in by 22 % too much at points four of its particles apart; a beam has no such points."""
    sets = ["fluid.dx=0.05", "solid.dx=0.0125", "solid.youngs_modulus=1e6", 'solid.clamps=[{body="floor",face="left"}]']
    scene = TANK.format(waters=POOL, solids=FLOOR)
    for model, apart in (("total-lagrangian", 0.025), ("beam", 0.05)):
        still = StillWater(scene_of(scene, tmp_path, [*sets, f"solid.model={model}"]), coupled=True, threads=1)
        np.testing.assert_allclose(np.diff(np.sort(still.describe().position[:, 0])), apart, rtol=1e-9)


def test_waters_that_touch_are_one_pool(tmp_path):
    halves = '{ name = "a", rectangle = [0.0, 0.0, 0.5, 0.1] }, { name = "b", rectangle = [0.0, 0.1, 0.5, 0.4] }'
    for waters in (POOL, halves):
        model = water(tmp_path, waters, f"{WALL}, {FLOOR}")
        _, loads, probes = moved(model, lambda x: x + [0.02 * (x[0, 0] > 0.0), 0.0])
        assert probes["p"] == pytest.approx(RHO * G * (probes["level"] - 0.05))
        assert loads.pressure.max() == pytest.approx(RHO * G * probes["level"])


def test_a_probe_of_force_is_the_mean_over_the_last_window(tmp_path):
    probe = "probes=[{name='push', quantity='force-x', body='wall'}]"
    model = StillWater(scene_of(TANK.format(waters=POOL, solids=WALL), tmp_path, [probe]), coupled=True, threads=1)
    _, loads, probes = moved(model, lambda x: x + [0.1, 0.0])
    level = 0.4 * 0.5 / 0.6
    assert probes["push"] == pytest.approx(0.5 * RHO * G * (0.4**2 + level**2) / 2.0, rel=1e-8)
    assert probes["push"] == pytest.approx(loads.force[:, 0].sum(), rel=1e-12)


def test_faces_that_hold_no_water_are_named(tmp_path):
    model = water(tmp_path, POOL, WALL)
    with pytest.raises(SolverFailed, match="no level was found"):
        moved(model, lambda x: np.full_like(x, np.nan))


def test_the_level_goes_back_with_the_state(tmp_path):
    model = water(tmp_path, POOL, WALL)
    moved(model, lambda x: x + [0.1, 0.0])
    kept = {name: np.copy(value) for name, value in model.state().items()}
    first = moved(model, lambda x: x + [0.15, 0.0])[1]
    model.restore(kept)
    again = moved(model, lambda x: x + [0.15, 0.0])[1]
    assert first.pressure.tobytes() == again.pressure.tobytes()


@pytest.mark.parametrize(("depth", "links"), [(0.4, 8), (0.36, 8), (0.37, 4)])
def test_forces_on_a_wall_that_bends_do_the_work_of_the_pressure(tmp_path, depth, links):
    """On a cantilever, y² (3 L − y)/6, with the level between two nodes; force and moment are exact."""
    scene = TANK.format(waters=POOL, solids=WALL)
    body = f"fluid.bodies=[{{ name = 'a', rectangle = [0.0, 0.0, 0.5, {depth}] }}]"
    model = StillWater(scene_of(scene, tmp_path, [body, f"fluid.dx={0.8 / links}"]), coupled=True, threads=1)
    y, fx = model.describe().position[:, 1], model.begin(None).force[:, 0]
    weight = RHO * G * depth**2 / 2.0
    np.testing.assert_allclose([fx.sum(), fx @ y], [weight, weight * depth / 3.0], rtol=1e-12)
    work = RHO * G * (0.8 * depth**4 / 24.0 - depth**5 / 120.0)
    assert fx @ (y**2 * (2.4 - y) / 6.0) == pytest.approx(work, rel=1e-3)
