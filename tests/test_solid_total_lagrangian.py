"""The total-Lagrangian solid: energy, momentum, objectivity, statics, steps, rollback, threads."""

import numpy as np
import pytest

from shared.contract import Loads, SolverFailed
from solid_solver import total_lagrangian
from solid_solver.bodies import lattice_bodies
from solid_solver.models import make_model
from tests.solid_scenes import beam_scene, run, solid_scene

TURNED = {"rectangle": [0.0, 0.0, 0.6, 1.0], "rotate": {"angle": 20.0, "about": [0.0, 0.0]}, "free": True}


def energy(body, u, lam, mu):
    """The cell-integrated energy [J/m] of displacements u (n, 2), written directly from the module's formula."""
    number = {tuple(i): k for k, i in enumerate(body.index)}
    d = np.zeros((len(u), 2, 5))
    for a, i in enumerate(body.index):
        for k, o in enumerate(body.fit.offset):
            b = number.get(tuple(i + o))
            if b is not None:
                d[a] += np.outer(u[b], body.fit.coefficient[a, k] * body.scale)

    def density(e):
        trace = np.trace(e, axis1=1, axis2=2)
        return 0.5 * lam * trace**2 + mu * np.sum(e * e, axis=(1, 2))

    f = body.axes.T + d[:, :, :2]
    total = density(0.5 * (f.transpose(0, 2, 1) @ f - np.eye(2)))
    for k, second in enumerate((d[:, :, [2, 3]], d[:, :, [3, 4]])):
        e = f.transpose(0, 2, 1) @ second
        total += body.spacing[k] ** 2 / 12.0 * density(0.5 * (e + e.transpose(0, 2, 1)))
    return body.cell * np.sum(total)


def internal_force(model, u):
    """Force (n, 2) [N/m] at displacements u, from one step that moves nothing."""
    model._lattice.put(u, np.zeros_like(u))
    model._lattice.find_forces(0.0)
    return model._lattice.acceleration * model._mass[:, None]


@pytest.fixture(scope="module")
def strained():
    """A clamped block on a turned lattice, displaced at random by finite strains."""
    body = {"name": "block", **TURNED}
    scene = solid_scene(dx=0.12, bodies=[body], clamps=[{"body": "block", "face": "bottom"}])
    model = make_model(scene, False, 1)
    u = 0.02 * np.random.default_rng(1).standard_normal((model.particles(), 2))
    return model, lattice_bodies(scene)[0], u


def test_force_is_minus_the_derivative_of_the_energy(strained):
    model, body, u = strained
    lam, mu = 1e6 * 0.3 / (1.3 * 0.4), 1e6 / 2.6
    force = internal_force(model, u)
    step = 1e-6
    for a in range(0, len(u), 7):
        for i in range(2):
            plus, minus = u.copy(), u.copy()
            plus[a, i] += step
            minus[a, i] -= step
            slope = (energy(body, plus, lam, mu) - energy(body, minus, lam, mu)) / (2.0 * step)
            assert force[a, i] == pytest.approx(-slope, abs=1e-5 * np.abs(force).max())


def test_force_turns_with_the_body_and_ignores_translation():
    model = make_model(solid_scene(bodies=[{"name": "block", **TURNED}]), False, 1)
    x = model.describe().position
    u = 0.02 * np.random.default_rng(2).standard_normal(x.shape)
    force = internal_force(model, u)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    turned = internal_force(model, (x + u) @ turn.T - x + [3.0, -2.0])
    np.testing.assert_allclose(turned, force @ turn.T, atol=1e-9 * np.abs(force).max())
    assert np.abs(internal_force(model, x @ turn.T - x)).max() < 1e-9 * np.abs(force).max()


def test_momentum_and_moment_of_the_internal_forces_vanish():
    model = make_model(solid_scene(bodies=[{"name": "block", **TURNED}]), False, 1)
    x = model.describe().position
    u = 0.02 * np.random.default_rng(3).standard_normal(x.shape)
    force = internal_force(model, u)
    now = x + u
    assert np.abs(force.sum(axis=0)).max() < 1e-10 * np.abs(force).sum()
    assert abs(np.sum(now[:, 0] * force[:, 1] - now[:, 1] * force[:, 0])) < 1e-10 * np.abs(force).sum()


def test_a_checkerboard_costs_energy():
    model = make_model(solid_scene(), False, 1)
    index = np.rint(model.describe().position / 0.1 - 0.5).astype(int)
    u = np.where(index.sum(axis=1) % 2 == 0, 1e-4, -1e-4)[:, None] * np.array([1.0, 0.0])
    force = internal_force(model, u)
    middle = np.all((index > 2) & (index < 7), axis=1)
    stiffness = -np.sum(force[middle] * u[middle]) / np.sum(u[middle] ** 2)
    assert stiffness > 0.1 * 1e6  # a tenth of E per metre of depth; a plain gradient gives nothing


def test_free_spinning_block_keeps_momenta_and_energy():
    model = make_model(solid_scene(), False, 1)
    x = model.describe().position - 0.5
    model._lattice.put(np.zeros_like(x), np.stack([-3.0 * x[:, 1] + 1.0, 3.0 * x[:, 0]], axis=1))
    mass = model._mass

    def momenta():
        y, v = x + model._lattice.displacement, model._lattice.velocity
        return np.array([*(mass @ v), mass @ (y[:, 0] * v[:, 1] - y[:, 1] * v[:, 0])])

    before = momenta()
    for _ in run(model, 2.0, 20):
        pass
    np.testing.assert_allclose(momenta(), before, rtol=0.0, atol=1e-9 * np.abs(before).max())
    turned = x + model._lattice.displacement - [2.0, 0.0]
    size = np.sqrt(np.sum(turned**2, axis=1) / np.sum(x**2, axis=1))
    assert np.abs(size - 1.0).max() < 0.02  # it spins by a full turn, stretched a little by the centrifugal load


@pytest.mark.parametrize(("across", "error"), [(6, 0.0135), (10, 0.0072)])
def test_static_deflection_of_the_clamped_beam(across, error):
    model = make_model(beam_scene(across, damping=190.0), False, 2)
    *_, _ = run(model, 0.15, 10)
    assert abs(model.probe_values()["mid_y"] / -5.98618e-5 - 1.0) < error


@pytest.mark.slow
def test_static_deflection_of_the_clamped_beam_at_twenty_across():
    model = make_model(beam_scene(20, damping=190.0), False, 2)
    *_, _ = run(model, 0.15, 10)
    assert abs(model.probe_values()["mid_y"] / -5.98618e-5 - 1.0) < 0.004


def test_undamped_step_load_peaks_when_and_where_it_should():
    model = make_model(beam_scene(6), False, 1)
    model.begin(None)
    times, values = [], []
    for t in run(model, 0.034, 170):
        times.append(t)
        values.append(model.probe_values()["mid_y"])
    assert min(values) == pytest.approx(-1.1966e-4, rel=0.02)
    # The deflection is nearly zero again after one period: 30.25 Hz, 1 % too slow at six across.
    tail = [(t, v) for t, v in zip(times, values, strict=True) if t > 0.028]
    period = max(tail, key=lambda tv: tv[1])[0]
    assert period == pytest.approx(1.0 / 30.25, rel=0.02)


@pytest.mark.parametrize(("across", "nu"), [(3, 0.0), (4, 0.3), (10, 0.0), (10, 0.45)])
def test_default_step_is_below_the_limit_by_its_factor(across, nu):
    """A random kick stays bounded at the default step and grows at 1.25 of it (limit 1/0.85 = 1.18)."""
    outcome = []
    for factor in (1.0, 1.25):
        model = make_model(beam_scene(across, poisson_ratio=nu, loads=[]), False, 1)
        rng = np.random.default_rng(0)
        kick = 1e-6 * rng.standard_normal((model.particles(), 2))
        model._lattice.put(np.zeros_like(kick), kick)
        steps = 1500
        model.advance(0.0, factor * steps * model.stable_step(), steps, None)
        outcome.append(np.sqrt(np.mean(model._lattice.velocity**2)))
    assert outcome[0] < 1.1e-6
    assert not outcome[1] < 1e-5


def test_damping_decays_a_free_flight_exactly():
    block = {"name": "block", "rectangle": [0.0, 0.0, 1.0, 1.0], "velocity": [2.0, 0.0], "free": True}
    model = make_model(solid_scene(damping=3.0, bodies=[block]), False, 1)
    *_, _ = run(model, 1.0, 4)
    np.testing.assert_allclose(model._lattice.velocity[:, 0], 2.0 * np.exp(-3.0), rtol=1e-10)


def test_interface_force_acts_as_a_point_force_held_over_the_window():
    model = make_model(solid_scene(), True, 1)
    model.begin(None)
    n = model.particles()
    force = np.tile([5.0, -1.0], (n, 1)) / n
    motion = model.advance(0.0, 0.01, 20, Loads(np.zeros(n), force))
    np.testing.assert_allclose(model._mass @ motion.velocity, [0.05, -0.01], rtol=1e-12)
    start = model.describe().position
    np.testing.assert_allclose(start + 0.01 * motion.velocity_mean, motion.position, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(0.01 * motion.acceleration_mean, motion.velocity, rtol=0.0, atol=1e-15)


def test_a_ramped_load_is_second_order_in_time():
    """Without viscosity, which acts with the strain rate of half a step before."""
    loads = [{"body": "block", "face": "right", "traction": [1e3, 0.0], "ramp": 0.02}]
    scene = solid_scene(dx=0.25, alpha=0.0, loads=loads, clamps=[{"body": "block", "face": "left"}])

    def at(substeps):
        model = make_model(scene, False, 1)
        model.begin(None)
        return model.advance(0.0, 0.04, substeps, None).position

    exact = at(1600)
    coarse, fine = np.abs(at(50) - exact).max(), np.abs(at(100) - exact).max()
    assert 3.5 < coarse / fine < 4.5


def test_rollback_and_restart_give_the_same_bytes():
    model = make_model(beam_scene(4), True, 1)
    *_, _ = run(model, 0.001, 3)
    saved = {name: array.copy() for name, array in model.state().items()}
    first = model.advance(0.001, 0.0013, 23, None)
    model.restore(saved)
    second = model.advance(0.001, 0.0013, 23, None)
    other = make_model(beam_scene(4), True, 1)
    other.begin(None)
    other.restore(saved)
    third = other.advance(0.001, 0.0013, 23, None)
    for name in ("position", "velocity", "acceleration", "velocity_mean"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes() == getattr(third, name).tobytes()


def test_one_and_two_threads_give_the_same_bytes(monkeypatch):
    monkeypatch.setattr(total_lagrangian, "PARALLEL_FROM", 0)
    results = []
    for threads in (1, 2):
        model = make_model(beam_scene(6, poisson_ratio=0.3), False, threads)
        *_, _ = run(model, 0.001, 2)
        results.append(b"".join(a.tobytes() for a in model.state().values()))
    assert results[0] == results[1]


def test_an_inverted_block_is_reported_with_place_and_way_out():
    model = make_model(solid_scene(youngs_modulus=1e3), True, 1)
    model.begin(None)
    force = np.zeros((model.particles(), 2))
    force[44] = [1e6, 0.0]
    model.advance(0.0, 0.1, 50, Loads(np.zeros(len(force)), force))
    with pytest.raises(SolverFailed, match=r"t = 0\.1 s.*reference position"):
        model.check()
