"""The fluid model: conservation, ghosts, settled start, replay, threads, walls."""

import numpy as np
import pytest

from fluid_solver.cells import COLUMNS, list_segments
from fluid_solver.fields import AX, AY, FLUID, RHO, M, P, U, V, X, Y
from fluid_solver.gather import next_stretch
from fluid_solver.models import make_model
from shared.contract import Kinematics, SolverFailed
from shared.schema.geometry import Domain
from shared.schema.scene import Scene
from tests.fluid_models import G, begun, dam, everything, fluid_rows, run, scene, tank


def drop_on_plate(**fluid) -> Scene:
    """A square of water thrown at a plate, without walls and gravity."""
    body = {"name": "drop", "rectangle": (0.0, 0.005, 0.1, 0.105), "velocity": (0.3, -1.0)}
    plate = {"name": "plate", "rectangle": (-0.05, -0.03, 0.15, 0.0)}
    solid = {"model": "total-lagrangian", "dx": 0.01, "density": 1000.0, "youngs_modulus": 1e6, "bodies": [plate]}
    return scene([body], gravity=(0.0, 0.0), solid=solid, sound_speed=15.0, **fluid)


# ---- conservation ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fluid", [{"alpha": 0.2}, {"alpha": 0.1, "viscosity": 1e-3}])
def test_what_walls_take_the_fluid_loses(fluid):
    """Σ m a = Σ m g − Σ forces on ghosts, to rounding: pressure, artificial and laminar viscosity are mirrored."""
    model = begun(tank(**fluid))
    run(model, 0.02)
    m, ax, ay = fluid_rows(model, M, AX, AY)
    given = np.array([m @ ax, m @ ay + G * m.sum()])
    taken = model.force.sum(axis=0)
    assert given == pytest.approx(-taken, abs=1e-12 * np.abs(model.force).sum())


def test_impulse_on_the_structure_is_the_fluids_loss_of_momentum():
    model = begun(drop_on_plate(), coupled=True)
    motion = Kinematics.at_rest(model.describe().position)
    largest = 0.0
    for k in range(8):
        m, u, v = fluid_rows(model, M, U, V)
        before = np.array([m @ u, m @ v])
        t0, t1 = 0.004 * k, 0.004 * (k + 1)
        loads = model.advance(t0, t1, int(np.ceil(0.004 / model.stable_step())), motion)
        m, u, v = fluid_rows(model, M, U, V)
        lost = before - np.array([m @ u, m @ v])
        assert loads.force.sum(axis=0) * (t1 - t0) == pytest.approx(lost, abs=1e-11)
        largest = max(largest, -loads.force[:, 1].sum())
    assert largest > 10.0  # N/m: it was an impact


def test_free_fall_is_exact_for_the_second_order_step():
    case = scene([{"name": "drop", "rectangle": (0.0, 0.0, 0.1, 0.1)}], initial_pressure="zero", sound_speed=10.0)
    model = begun(case)
    y0 = fluid_rows(model, Y)[0].mean()
    run(model, 0.05)
    assert fluid_rows(model, Y)[0].mean() - y0 == pytest.approx(-0.5 * G * 0.05**2, rel=1e-10)


# ---- settled start and still water ------------------------------------------------------------------------------


@pytest.mark.parametrize("gravity", [(0.0, -G), (G, 0.0), (-3.0, -4.0)])
def test_settled_column_keeps_mass_and_carries_its_weight(gravity):
    g = np.array(gravity)
    angle = np.degrees(np.arctan2(g[1], g[0])) + 90.0
    body = {"name": "water", "rectangle": (0.0, 0.0, 0.2, 1.0), "rotate": {"angle": angle, "about": (0.1, 0.0)}}
    model = make_model(scene([body], gravity=gravity, sound_speed=15.0), False, 1)
    x, y, p, rho, m = fluid_rows(model, X, Y, P, RHO, M)
    size = np.hypot(*g)
    assert m.sum() == pytest.approx(1000.0 * 0.2, rel=1e-12)
    assert p == pytest.approx(15.0**2 * (rho - 1000.0), abs=1e-6)
    up = -(g[0] * (x - 0.1) + g[1] * y) / size  # height above the bottom, which stays
    rows = np.unique(np.round(up, 9))
    spacing = np.diff(rows)
    middle = 0.5 * (rho[np.argsort(up)][::20][1:] + rho[np.argsort(up)][::20][:-1])
    assert spacing * middle == pytest.approx(0.01 * 1000.0, rel=1e-4)  # lower, and denser: mass per row kept
    bottom = p.max() + rho.max() * size * up.min()
    assert bottom == pytest.approx(1000.0 * size * 1.0, rel=1e-4)


@pytest.mark.parametrize("model_name", ["wcsph", "ctvf"])
def test_still_water_stays_still(model_name):
    model = begun(tank(model=model_name))
    bottom, weight = [], []
    for k in range(15):
        run(model, 0.02, 1, 0.02 * k)
        values = model.probe_values()
        bottom.append(values["bottom"])
        weight.append(values["weight"])
        assert values["leaked"] == 0.0
    assert np.mean(bottom) == pytest.approx(1000.0 * G * 0.15, rel=0.02)
    assert np.mean(weight) == pytest.approx(-1000.0 * G * 0.15 * 0.2, rel=0.01)
    assert values["kinetic-energy"] < 1e-3 * 1000.0 * G * 0.15**2 * 0.2 / 2
    assert values["level"] == pytest.approx(0.15, abs=0.003)


# ---- replay and threads -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("model_name", ["wcsph", "ctvf"])
def test_restored_state_goes_on_to_the_same_bytes(model_name):
    model = begun(dam(model_name))
    run(model, 0.03)
    saved = everything(model)
    run(model, 0.03, start=0.03)
    first = everything(model)
    model.restore(saved)
    run(model, 0.03, start=0.03)
    again = everything(model)
    assert all(np.array_equal(first[name], again[name]) for name in first)
    other = begun(dam(model_name))
    other.restore(saved)
    run(other, 0.03, start=0.03)
    assert all(np.array_equal(first[name], everything(other)[name]) for name in first)


def test_one_and_two_threads_give_the_same_bytes():
    states = []
    for threads in (1, 2):
        model = begun(dam("ctvf", dx=0.0025), threads)
        assert model.particles() > 5000  # below that both would run on one thread
        run(model, 0.01, 2)
        states.append(everything(model))
    assert all(np.array_equal(states[0][name], states[1][name]) for name in states[0])


@pytest.mark.parametrize("name", ["wcsph", "ctvf"])
def test_sweeps_compiled_on_their_own_are_those_of_a_run(name):
    """They leave the state alone, and a step after them compiles none of them again."""
    model = make_model(dam(name), False, 1)
    before = everything(model)
    model.compile_sweeps()
    assert all(np.array_equal(array, before[name]) for name, array in everything(model).items())
    compiled = [set(sweep.signatures) for sweep in model.sweeps]
    assert all(compiled)
    model.begin(None)
    run(model, 0.001)
    assert [set(sweep.signatures) for sweep in model.sweeps] == compiled


def test_cells_hold_every_neighbour():
    """After motion without a sort, everything in reach is still in the cells around."""
    model = begun(dam("wcsph"))
    run(model, 0.1)
    store, c = model.store, model.c
    cell = np.repeat(np.arange(store.start.size // 2 - 1), np.diff(store.start[:-1:2]))
    x, y = store.S[X, : store.count], store.S[Y, : store.count]
    for i in range(0, store.count, 17):
        near = np.hypot(x - x[i], y - y[i]) < c.support
        row, column = np.divmod(cell[near], store.grid.columns)
        assert np.all(np.abs(row - cell[i] // store.grid.columns) <= 1)
        assert np.all(np.abs(column - cell[i] % store.grid.columns) <= COLUMNS)


def test_high_walls_and_far_drops_add_few_cells():
    """Rows without fluid near share one; the ghosts there feel nothing, the others what they feel of a low tank."""
    low, high = tank(height=0.2), tank(height=2.0)
    drop = low.fluid.bodies[0].model_copy(update={"name": "drop", "rectangle": (0.1, 1.5, 0.12, 1.52)})
    water = high.fluid.model_copy(update={"bodies": [*high.fluid.bodies, drop]})
    models = [begun(scene) for scene in (low, high.model_copy(update={"fluid": water}))]
    rows = [model.store.grid.rows for model in models]
    assert rows[1] <= rows[0] + 4
    forces = [model.force[np.hypot(*model.force.T) > 0.0] for model in models]
    weight = 0.02 * 0.02 * 1000.0 * 9.81
    assert np.abs(forces[0].sum(axis=0) - forces[1].sum(axis=0)).max() < weight
    dry = models[1].ghosts.position[:, 1] > 0.2 + models[1].c.support
    assert not models[1].force[dry].any()


# ---- failures ---------------------------------------------------------------------------------------------------


def test_a_state_that_is_not_finite_is_named():
    model = begun(dam("wcsph"))
    model.store.S[U, np.flatnonzero(model.store.kind == FLUID)[5]] = np.nan
    with pytest.raises(SolverFailed, match="velocity of fluid particle"):
        model.check()


def test_fluid_that_leaves_the_domain_is_taken_out_and_counted(caplog):
    jet = {"name": "jet", "rectangle": (0.0, 0.0, 0.05, 0.05), "velocity": (2.0, 0.0)}
    wall = {"name": "lid", "polyline": [(0.2, -0.1), (-0.1, -0.1)]}
    table = scene([jet], [wall], gravity=(0.0, 0.0), probes=[{"name": "lost", "quantity": "leaked"}])
    model = begun(table)
    assert model.losses() == {"lost": 0, "lost_fraction": 0.0}
    with caplog.at_level("WARNING", logger="shearwater"):
        run(model, 0.2, 40)
    assert model.probe_values()["lost"] == model.losses()["lost"] == model.fluid_count
    assert model.losses()["lost_fraction"] == 1.0
    assert model.losses()["lost_near"][0] > 0.2  # beyond the lid's end, where the domain ends
    assert len(model.frame().position) == 0
    said = [record for record in caplog.records if "left the domain" in record.message]
    assert 1 <= len(said) <= np.log2(model.fluid_count) + 1  # each time twice as much


@pytest.mark.parametrize("kind", [0, 1])
def test_every_segment_with_targets_is_taken_once_whoever_takes_it(kind):
    """Workers that take turns unevenly, and one alone: the same stretches, a share's own first."""
    store = begun(tank(dx=4e-3)).store
    segments, shares = np.empty_like(store.segments), np.zeros((2, 4), dtype=np.int64)
    list_segments(store.start, store.grid, segments, shares)
    lists = segments[kind], shares[kind]

    def stretches(order):
        taken, found = np.zeros(3, dtype=np.int64), []
        for worker in order:
            row, first, last = next_stretch(store.start, store.grid, kind, *lists, taken, worker)
            found += [(row, first, last)] if first < last else []
        return found

    alone = stretches([1] * 1000)
    assert len(alone) == len(set(alone)) > 10, "some in every share"
    assert sorted(stretches(np.random.default_rng(0).choice(3, 3000, p=[0.7, 0.2, 0.1]))) == sorted(alone)
    row, first, _ = alone[0]
    assert store.start[2 * (row * store.grid.columns + first)] >= store.count // 4, "its own share first"


FAR = Domain(lower=(-1.0, -1.0), upper=(1.0, 1.0))  # so that nothing leaves it


@pytest.mark.parametrize("row", [U, V])
@pytest.mark.parametrize("periodic", [{}, {"periodic": {"x": [0.0, 0.2]}}])
@pytest.mark.parametrize("lengths", [(1.0,), (1.0, 0.1, 0.7, 1.0, 1.0, 0.05)], ids=["alike", "unlike"])
def test_cells_hold_all_neighbours_of_the_fastest(lengths, periodic, row):
    """Drops faster than sound, over steps of one length or of several, that the cells were laid for or not:
    accelerations are those of cells sorted where particles are."""
    fluid = begun(tank(sound_speed=20.0, alpha=0.1, **periodic).model_copy(update={"domain": FAR}))
    fluid.store.S[row, fluid.store.kind == FLUID] = np.random.default_rng(1).choice([-60.0, 60.0], fluid.fluid_count)
    step, t = 0.5 * fluid.stable_step(), 0.0
    for k in range(12):
        dt = lengths[k % len(lengths)] * step
        fluid.advance(t, t + dt, 1, None)
        t += dt
        found = fluid_rows(fluid, AX, AY)
        state = {name: np.copy(array) for name, array in fluid.state().items()}
        fluid.store.sort()
        fluid.store.S[[U, V]] -= 0.5 * dt * fluid.store.S[[AX, AY]] * (fluid.store.kind == FLUID)
        fluid._load_ghosts()
        fluid._accelerate(0.0)
        again = fluid_rows(fluid, AX, AY)
        fluid.restore(state)
        assert found == pytest.approx(again, rel=1e-9, abs=1e-9 * np.abs(again).max())
