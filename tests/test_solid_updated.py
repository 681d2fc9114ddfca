"""The updated-Lagrangian solid's terms on polynomial fields, shifting, neighbour lists."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from shared.kernels import WENDLAND_C2
from solid_solver.shifting import field_changes, shifts
from solid_solver.updated_fields import AX, AY, E0, E1, G00, G11, RHO, SXX, SXY, SYY, SZZ, U, V, X, Y
from solid_solver.updated_material import by_middle, turned_stress
from tests.updated_models import DX, H, get, jittered, power_of_stresses, put


def test_velocity_gradient_of_a_linear_field_is_exact_when_corrected():
    """∇u by the places at a step's end, x + Δt A x, of u = A x."""
    matrix, dt = np.array([[0.3, -1.2], [0.8, 0.5]]), 0.1
    exact = matrix @ np.linalg.inv(np.eye(2) + dt * matrix)
    for gradient in ("linear", "quadratic", "printed"):
        model = jittered(gradient=gradient)
        put(model, U, matrix @ get(model, X, Y))
        model._at_once(dt)
        error = np.abs(get(model, G00, G11) - exact.reshape(4, 1)).max()
        assert error < 1e-12 if gradient != "printed" else error > 0.1  # the faces see it


def test_a_turn_in_one_step_leaves_the_stress_turned_and_the_density_as_it_is():
    """Every particle moves along the chord of 60°: no strain, S turned by 60°, tracers' offsets too."""
    model = jittered(gradient="quadratic")
    c, s = math.cos(math.pi / 3), math.sin(math.pi / 3)
    turn = np.array([[c, -s], [s, c]])
    put(model, U, turn @ get(model, X, Y) - get(model, X, Y))
    put(model, SXX, np.tile([[2.0], [0.7], [-1.5], [-0.5]], len(model._slot)))
    put(model, E0, np.tile([[0.01], [0.02]], len(model._slot)))
    model._at_once(1.0)
    turned = turn @ np.array([[2.0, 0.7], [0.7, -1.5]]) @ turn.T
    expected = [[turned[0, 0]], [turned[0, 1]], [turned[1, 1]], [-0.5]]
    np.testing.assert_allclose(get(model, SXX, SZZ), np.tile(expected, len(model._slot)), atol=1e-11)
    np.testing.assert_allclose(get(model, RHO, RHO), 1000.0, rtol=1e-11)
    np.testing.assert_allclose(
        get(model, E0, E1), np.tile((turn @ [0.01, 0.02])[:, None], len(model._slot)), atol=1e-12
    )


def test_uniaxial_strain_builds_the_elastic_stress():
    """With the trace that print leaves out: σ_xx = (λ + 2μ) ε, σ_yy = σ_zz = λ ε."""
    shear, bulk, strain = 3.0, 8.0, 1e-6
    s = turned_stress((0.0, 0.0, 0.0, 0.0), (strain, 0.0, 0.0, 0.0), shear)
    lam = bulk - 2.0 * shear / 3.0
    sigma = np.array(s)[[0, 2, 3]] + bulk * strain
    np.testing.assert_allclose(sigma, [(lam + 2.0 * shear) * strain, lam * strain, lam * strain], rtol=1e-12)
    assert sum(np.array(s)[[0, 2, 3]]) == pytest.approx(0.0, abs=1e-18)


def test_simple_shear_follows_the_jaumann_solution():
    """dS/dt = 2Gε̇ + SΩᵀ + ΩS in simple shear: S_xy = G sin γ, S_xx = G (1 − cos γ)."""
    s, steps, shear = (0.0, 0.0, 0.0, 0.0), 4000, 2.0
    for _ in range(steps):
        s = turned_stress(s, by_middle(0.0, 4.0 / steps, 0.0, 0.0), shear)
    normal = shear * (1.0 - math.cos(4.0))
    np.testing.assert_allclose(s, [normal, shear * math.sin(4.0), -normal, 0.0], atol=5e-3)


def test_forces_do_the_work_of_the_stresses_and_keep_momentum_and_moment():
    """Also where the density varies; Q·∇²u with E' V/12 ∇²u the rate of Q."""
    model = jittered()
    work, power, q, rate, force, _ = power_of_stresses(model, 2, np.random.default_rng(0))
    volume = model._mass / 1100.0
    power += np.sum(q * rate, axis=0) / (model._moduli()[3] * (model._mass / 1000.0) / 12.0)
    assert work == pytest.approx(-np.sum(volume * power), rel=1e-6)
    np.testing.assert_allclose(force.sum(axis=1), 0.0, atol=1e-12)
    x = get(model, X, Y)
    assert np.sum(x[0] * force[1] - x[1] * force[0]) == pytest.approx(0.0, abs=1e-12)


def test_artificial_viscosity_brakes_approach_and_only_that():
    model = jittered(alpha=1.0)
    for sign in (-1.0, 1.0):
        put(model, U, sign * (get(model, X, Y) - 0.5))
        model._at_once(0.0)
        power = np.sum(get(model, AX, AY) * get(model, U, V))
        assert power < -1e-3 if sign < 0.0 else power == 0.0


def test_fields_carried_with_a_shift_are_exact_when_linear():
    model = jittered()
    delta = np.zeros((2, model._S.shape[1]))
    delta[:, model._slot] = 0.05 * DX * np.random.default_rng(2).standard_normal((2, len(model._slot)))
    slopes = np.array([[1.0, 2.0], [-3.0, 0.5], [0.2, -0.7]])
    put(model, SXX, slopes @ get(model, X, Y))
    change = np.zeros((3, model._S.shape[1]))
    field_changes(model._S, np.array([SXX, SXY, SYY]), model._stepper.blocks, delta, WENDLAND_C2, H, change)
    np.testing.assert_allclose(change[:, model._slot], slopes @ delta[:, model._slot], atol=1e-13)


@pytest.mark.parametrize("scale", [1.0, 0.01])
def test_shifting_spreads_a_jittered_block_and_leaves_a_uniform_one(scale):
    square = [{"name": "block", "rectangle": [0.0, 0.0, scale, scale], "free": True}]
    for jitter in (0.0, 0.3):
        model = jittered(jitter, dx=DX * scale, bodies=square)
        before = get(model, X, Y)
        delta = np.zeros((2, model._S.shape[1]))
        for _ in range(10):
            shifts(model._S, model._stepper.blocks, model._s.spacing, WENDLAND_C2, H * scale, delta)
            model._S[X : Y + 1] += delta
        after = get(model, X, Y)
        if jitter == 0.0:
            assert np.abs(after - before).max() < 1e-12 * scale
        else:
            closest = [cKDTree(p.T).query(p.T, k=2)[0][:, 1].min() / (DX * scale) for p in (before, after)]
            assert closest[1] > closest[0] + 0.15


def test_lists_hold_every_pair_in_reach_also_after_much_deformation():
    model = jittered(0.3)
    x = model._S[X : Y + 1]
    x[:, model._slot] = np.array([[1.0, 0.8], [0.0, 1.0]]) @ x[:, model._slot]
    model._stepper.list_pairs(x)
    listed = set()
    for n, (s, count) in enumerate(zip(model._stepper.blocks.start, model._stepper.blocks.count, strict=True)):
        for d in model._stepper.blocks.distance[model._stepper.blocks.first[n] : model._stepper.blocks.first[n + 1]]:
            listed |= {(a, a + d) for a in range(s, s + count)}
    pairs = cKDTree(x[:, model._slot].T).query_pairs(2.0 * H)
    slots = {(model._slot[a], model._slot[b]) for a, b in pairs}
    assert slots <= listed
    assert {(b, a) for a, b in slots} <= listed


def test_a_list_outgrown_is_made_anew():
    """A block squeezed by a fifth in small steps has pairs come into reach that the first list has not."""
    model = jittered(0.0, poisson_ratio=0.0)
    before = len(model._stepper.blocks.distance)
    put(model, U, np.array([[-0.2], [0.0]]) * get(model, X, X))
    model._stepper.take(np.zeros((101, 2, 0)), (np.zeros((2, model._S.shape[1])), model._ramped, np.zeros((101, 0))),
                      0.01, (1.0, 0.0))  # fmt: skip
    assert len(model._stepper.blocks.distance) > before
    assert np.ptp(get(model, X, X)) == pytest.approx(0.9 * 0.8, rel=1e-3)
