"""Periodic directions: nothing happens at the seam."""

import numpy as np
import pytest

from fluid_solver.fields import AX, AY, FLUID, M, P, U, V, X, Y
from shared.contract import SolverFailed
from shared.schema.scene import Scene
from tests.fluid_models import begun, everything, fluid_rows, run


def box(periodic, walls=(), velocity=(0.0, 0.0), dx=0.02, size=1.0, **changes) -> Scene:
    """A square of water, periodic as given, without gravity."""
    water = {"name": "water", "rectangle": (0.0, 0.0, size, size), "velocity": velocity}
    fluid = {"model": "ctvf", "dx": dx, "sound_speed": 10.0, "periodic": periodic, "bodies": [water]} | changes
    table = {"schema": 1, "title": "box", "end_time": 1.0, "fluid": fluid, "walls": list(walls)}
    return Scene.model_validate(table)


BOTH = {"x": (0.0, 1.0), "y": (0.0, 1.0)}


@pytest.mark.parametrize("model_name", ["wcsph", "ctvf"])
def test_a_uniform_flow_keeps_everything(model_name):
    """Three turns through both periods: no force, no pressure, places as carried."""
    model = begun(box(BOTH, velocity=(1.0, -0.5), model=model_name))
    x0 = fluid_rows(model, X, Y)
    run(model, 3.0, 12)
    x, y, u, v, p = fluid_rows(model, X, Y, U, V, P)
    assert np.abs(u - 1.0).max() < 1e-9
    assert np.abs(v + 0.5).max() < 1e-9
    assert np.abs(p).max() < 1e-7 * 1000.0 * 10.0**2
    if model_name == "wcsph":  # shifting lets a square lattice settle into a hexagonal one
        shift = np.array([x, y]) - x0 - 3.0 * np.array([[1.0], [-0.5]])
        assert np.abs(shift - np.rint(shift)).max() < 1e-7
    assert model.frame().position.min() >= 0.0
    assert model.frame().position.max() <= 1.0


def disordered(offset=(0.0, 0.0), seed=3):
    """Rates of a shaken lattice with waves in it, moved by `offset` through the period."""
    model = begun(box(BOTH, dx=0.05, viscosity=0.01))
    S, fluid = model.store.S, model.store.kind == FLUID
    ids = model.store.ids[fluid]
    shake = np.random.default_rng(seed).uniform(-0.01, 0.01, (2, ids.size))[:, ids]
    x, y = S[X, fluid] + shake[0], S[Y, fluid] + shake[1]
    S[U, fluid] = np.sin(2 * np.pi * x)
    S[V, fluid] = np.cos(2 * np.pi * y)
    S[P, fluid] = 100.0 * np.sin(2 * np.pi * (x + y))
    S[X, fluid], S[Y, fluid] = x + offset[0], y + offset[1]
    model.begin(None)
    model.advance(0.0, 1e-3, 1, None)
    return fluid_rows(model, AX, AY, P)


def test_rates_do_not_know_where_the_seam_is():
    here, there = disordered(), disordered((0.37, -0.93))
    assert there == pytest.approx(here, rel=1e-9, abs=1e-9 * np.abs(here).max())


def test_momentum_is_kept_across_the_seam():
    model = begun(box(BOTH, dx=0.05))
    S, fluid = model.store.S, model.store.kind == FLUID
    S[U, fluid] = 0.5 * np.sin(2 * np.pi * S[X, fluid])
    run(model, 0.1)
    m, ax, ay = fluid_rows(model, M, AX, AY)
    assert abs(m @ ax) < 1e-10 * (m @ np.abs(ax))
    assert abs(m @ ay) < 1e-10 * (m @ np.abs(ax))


def test_walls_run_on_across_the_seam():
    """A channel: each ghost of its floor has neighbours on both sides, and the floor may be drawn past the period."""
    floor = {"name": "floor", "polyline": [(-0.3, 0.0), (1.3, 0.0)]}
    lid = {"name": "lid", "polyline": [(1.0, 1.0), (0.0, 1.0)]}
    model = begun(box({"x": (0.0, 1.0)}, [floor, lid], velocity=(1.0, 0.0), model="wcsph"))
    assert np.all((model.ghosts.position[:, 0] > 0.0) & (model.ghosts.position[:, 0] < 1.0))
    run(model, 1.5, 6)
    u, v, p = fluid_rows(model, U, V, P)
    assert np.abs(u - 1.0).max() < 1e-9
    assert np.abs(v).max() < 1e-9
    assert np.abs(p).max() < 1e-7 * 1000.0 * 10.0**2


def test_a_moving_body_crosses_the_seam():
    """A block dragged through the seam keeps the image that its cells hold: no water gets into it."""
    motion = {"times": [0.0, 0.2, 1.0, 2.0], "translation": [(0.0, 0.0), (0.02, 0.0), (0.3, 0.0), (0.7, 0.0)]}
    corners = [(0.6, 0.3), (0.6, 0.7), (0.9, 0.7), (0.9, 0.3)]
    block = {"name": "block", "polyline": corners, "closed": True, "motion": motion}
    table = box(BOTH, [block], dx=0.05).model_dump(by_alias=True)
    shapes = [{"rectangle": (0.0, 0.0, 1.0, 1.0)}, {"rectangle": (0.6, 0.3, 0.9, 0.7)}]
    table["fluid"]["bodies"] = [{"name": "water", "difference": shapes}]
    table["probes"] = [{"name": "inside", "quantity": "leaked"}]
    model = begun(Scene.model_validate(table))
    run(model, 1.2, 12)
    ghosts = model.store.in_order_of_ids([X, Y], model.fluid_count, model.fluid_count + len(model.ghosts.position))
    assert (ghosts[0] % 1.0 < 0.35).any()
    assert model.probe_values()["inside"] == 0.0
    assert fluid_rows(model, U)[0].mean() > 0.02


def test_replay_and_threads_give_the_same_bytes():
    def flow(threads):
        model = begun(box(BOTH, dx=0.0125, velocity=(0.3, 0.1), viscosity=0.01), threads)
        S, fluid = model.store.S, model.store.kind == FLUID
        S[U, fluid] += 0.3 * np.sin(2 * np.pi * S[Y, fluid])
        return model

    first, second = flow(1), flow(2)
    assert first.particles() > 5000
    for model in (first, second):
        run(model, 0.05, 2)
    one, two = everything(first), everything(second)
    assert all(np.array_equal(one[name], two[name]) for name in one)
    run(first, 0.05, 2)
    after = everything(first)
    first.restore(one)
    run(first, 0.05, 2)
    again = everything(first)
    assert all(np.array_equal(after[name], again[name]) for name in after)


def test_what_moves_by_more_than_a_period_at_once_is_named():
    """Such a particle was looked for in cells before the first, in memory of others."""
    model = begun(box(BOTH, model="wcsph", dx=0.1))
    model.store.S[U, 17] = 1e7
    model.advance(0.0, 1e-3, 4, None)
    with pytest.raises(SolverFailed, match="more than a whole period at once: the fluid diverged"):
        model.check()
