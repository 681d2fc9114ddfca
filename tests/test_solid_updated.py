"""The updated-Lagrangian solid: its terms on polynomial fields, shifting, tracers, rotation, statics, rollback."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from shared.contract import SolverFailed
from shared.kernels import WENDLAND_C2
from solid_solver import updated_lagrangian
from solid_solver.models import make_model
from solid_solver.shifting import field_changes, shifts
from solid_solver.updated_material import carried, turned_stress, update_material
from solid_solver.updated_sweeps import accelerations, velocity_derivatives
from tests.solid_scenes import beam_scene, run, solid_scene

DX = 0.1
H = 1.3 * DX


class Cloud:
    """A jittered lattice with its neighbour list."""

    def __init__(self, jitter=0.15, size=11):
        rng = np.random.default_rng(5)
        lattice = np.stack(np.meshgrid(*[(np.arange(size) + 0.5) * DX] * 2), axis=-1).reshape(-1, 2)
        self.x = np.ascontiguousarray((lattice + jitter * DX * rng.uniform(-1, 1, lattice.shape)).T)
        pairs = cKDTree(self.x.T).query_pairs(2.0 * H, output_type="ndarray")
        a, b = np.concatenate([pairs, pairs[:, ::-1]]).T
        order = np.lexsort((b, a))
        self.neighbour = b[order].astype(np.uint32)
        self.count = self.x.shape[1]
        self.first = np.concatenate([[0], np.cumsum(np.bincount(a, minlength=self.count))])
        self.volume = np.full(self.count, DX * DX)
        self.spacing = np.full(self.count, DX)
        self.inner = np.all((self.x > 0.35) & (self.x < 0.75), axis=0)

    def gradient(self, u, corrected=True):
        derivatives, correction = np.zeros((6, self.count)), np.zeros((7, self.count))
        velocity_derivatives(
            self.x, u, self.volume, self.first, self.neighbour, WENDLAND_C2, H, corrected, derivatives, correction
        )
        return derivatives, correction


def test_velocity_gradient_of_a_linear_field_is_exact_when_corrected():
    cloud = Cloud()
    matrix = np.array([[0.3, -1.2], [0.8, 0.5]])
    gradient, _ = cloud.gradient(matrix @ cloud.x + 2.0)
    np.testing.assert_allclose(gradient[:4], np.tile(matrix.reshape(4, 1), cloud.count), atol=1e-12)
    np.testing.assert_allclose(gradient[4:], 0.0, atol=1e-10)
    printed, _ = cloud.gradient(matrix @ cloud.x, corrected=False)
    assert np.abs(printed[:4] - matrix.reshape(4, 1)).max() > 0.1  # the faces see it


def test_uniaxial_strain_builds_the_elastic_stress():
    """With the trace that print leaves out: σ_xx = (λ + 2μ) ε, σ_yy = σ_zz = λ ε."""
    shear, bulk, strain = 3.0, 8.0, 1e-6
    s = turned_stress((0.0, 0.0, 0.0, 0.0), (strain, 0.0, 0.0, 0.0), shear, 1.0)
    lam = bulk - 2.0 * shear / 3.0
    sigma = np.array(s)[[0, 2, 3]] + bulk * strain
    np.testing.assert_allclose(sigma, [(lam + 2.0 * shear) * strain, lam * strain, lam * strain], rtol=1e-12)
    assert sum(np.array(s)[[0, 2, 3]]) == pytest.approx(0.0, abs=1e-18)


def test_a_stress_turned_by_a_full_circle_comes_back():
    s = (2.0, 0.7, -1.5, -0.5)
    start = s
    steps = 360
    spin = 2.0 / 1.0 * math.tan(math.pi / steps)  # the rate whose Cayley rotation is 2π/steps
    for n in range(steps):
        s = turned_stress(s, (0.0, -spin, spin, 0.0), 1e9, 1.0)
        if n == steps // 4 - 1:  # after a quarter counter-clockwise xx and yy have changed places, xy its sign
            np.testing.assert_allclose(s, [-1.5, -0.7, 2.0, -0.5], atol=1e-12)
    np.testing.assert_allclose(s, start, atol=1e-12)


def test_simple_shear_follows_the_jaumann_solution():
    """dS/dt = 2Gε̇ + SΩᵀ + ΩS in simple shear: S_xy = G sin γ, S_xx = G (1 − cos γ)."""
    s, steps, shear = (0.0, 0.0, 0.0, 0.0), 4000, 2.0
    for _ in range(steps):
        s = turned_stress(s, (0.0, 4.0 / steps, 0.0, 0.0), shear, 1.0)
    normal = shear * (1.0 - math.cos(4.0))
    np.testing.assert_allclose(s, [normal, shear * math.sin(4.0), -normal, 0.0], atol=5e-3)


def test_forces_do_the_work_of_the_stresses_and_keep_momentum():
    """Σ F·u = −Σ V [σ:∇u + Q·∇²u] for any velocity; the pressure part is in σ through ρ ≠ ρ0."""
    cloud = Cloud()
    rng = np.random.default_rng(0)
    u = rng.standard_normal(cloud.x.shape)
    derivatives, correction = cloud.gradient(u)
    rho, mass = np.full(cloud.count, 1000.0), 1000.0 * cloud.volume
    stress, curvature = rng.standard_normal((4, cloud.count)), 0.1 * rng.standard_normal((2, cloud.count))
    flux, offset = np.zeros((6, cloud.count)), np.zeros((2, cloud.count))
    material = (1.0, 0.01, 900.0, 1.0)  # G, c², ρ0, E': p = 1
    update_material(mass, cloud.volume, rho, stress, curvature, offset, derivatives, correction, flux, material, 0.0)
    a, crowding = np.zeros_like(u), np.zeros(cloud.count)
    accelerations(
        cloud.x,
        u,
        mass,
        cloud.volume,
        flux,
        cloud.first,
        cloud.neighbour,
        WENDLAND_C2,
        H,
        0.0,
        cloud.spacing,
        a,
        crowding,
    )
    power = (stress[0] - 1.0) * derivatives[0] + (stress[2] - 1.0) * derivatives[3]
    power += stress[1] * (derivatives[1] + derivatives[2]) + np.sum(curvature * derivatives[4:], axis=0)
    assert np.sum(mass * a * u) == pytest.approx(-np.sum(cloud.volume * power), rel=1e-10)
    np.testing.assert_allclose((mass * a).sum(axis=1), 0.0, atol=1e-9)


def test_artificial_viscosity_brakes_approach_and_only_that():
    x = np.array([[0.0, 0.05], [0.0, 0.0]])
    first, neighbour = np.array([0, 1, 2]), np.array([1, 0], dtype=np.uint32)
    mass, volume = np.full(2, 10.0), np.full(2, 0.01)
    for speed in (1.0, -1.0):
        u = np.array([[speed, -speed], [0.0, 0.0]])
        a, crowding = np.zeros((2, 2)), np.zeros(2)
        accelerations(
            x, u, mass, volume, np.zeros((6, 2)), first, neighbour, WENDLAND_C2, H, 1.0, np.full(2, DX), a, crowding
        )
        if speed > 0:
            assert a[0, 0] < 0.0 < a[0, 1]
        else:
            assert not a.any()


def test_fields_carried_with_a_shift_are_exact_when_linear():
    cloud = Cloud()
    _, correction = cloud.gradient(cloud.x)
    delta = 0.05 * DX * np.random.default_rng(2).standard_normal(cloud.x.shape)
    slopes = np.array([[1.0, 2.0], [-3.0, 0.5], [0.2, -0.7]])
    change = np.zeros((3, cloud.count))
    field_changes(
        cloud.x, slopes @ cloud.x, cloud.volume, correction, delta, cloud.count, cloud.first, cloud.neighbour,
        WENDLAND_C2, H, change,
    )  # fmt: skip
    np.testing.assert_allclose(change, slopes @ delta, atol=1e-13)


@pytest.mark.parametrize("dx_scale", [1.0, 0.01])
def test_shifting_spreads_a_jittered_block_and_leaves_a_uniform_one(dx_scale):
    for jitter in (0.0, 0.3):
        cloud = Cloud(jitter)
        x, spacing, h = cloud.x * dx_scale, cloud.spacing * dx_scale, H * dx_scale
        volume = cloud.volume * dx_scale**2
        before = x.copy()
        delta = np.zeros_like(x)
        for _ in range(10):
            shifts(x, volume, spacing, cloud.count, cloud.first, cloud.neighbour, WENDLAND_C2, h, delta)
            x += delta
        if jitter == 0.0:
            assert np.abs(x - before).max() < 1e-12 * dx_scale
        else:
            closest = [cKDTree(p.T).query(p.T, k=2)[0][:, 1].min() / (DX * dx_scale) for p in (before, x)]
            assert closest[1] > closest[0] + 0.15


def test_spinning_square_keeps_momenta_and_its_own_stress():
    model = make_model(solid_scene(model="ctvf", alpha=0.0, shifting=False), False, 1)
    model.begin(None)
    x = model._x - 0.5
    spin = 3.0
    model._u[:] = np.stack([-spin * x[1] + 1.0, spin * x[0]])
    mass = model._mass

    def momenta():
        y = model._x - 0.5
        return np.array([*(model._u @ mass), mass @ (y[0] * model._u[1] - y[1] * model._u[0])])

    before = momenta()
    for _ in run(model, 2.0 * math.pi / spin, 20):
        pass
    after = momenta()
    np.testing.assert_allclose(after[:2], before[:2], rtol=0.0, atol=1e-9 * abs(before[2]) + 1e-7)
    assert after[2] == pytest.approx(before[2], rel=1e-3)
    assert (model._rho.max() - model._rho.min()) / 1000.0 < 0.05


def test_tracers_follow_the_material_through_shifting():
    """A block carried by an affine flow with shifting forced at every step: tracers end on the affine image."""
    model = make_model(solid_scene(model="ctvf", dx=0.1), False, 1)
    model.begin(None)
    rng = np.random.default_rng(3)
    x0 = model._x.copy()
    model._offset[:] = 0.03 * rng.uniform(-1, 1, x0.shape)
    start = x0 + model._offset
    flow = np.array([[0.02, -0.3], [0.4, 0.03]])
    steps, dt = 200, 0.01
    for _ in range(steps):
        half = model._x + 0.5 * dt * (flow @ model._x)
        gradient = np.repeat(flow.reshape(4, 1), model._x.shape[1], axis=1)
        model._offset[:] = np.array(
            [carried(tuple(o), tuple(g), dt) for o, g in zip(model._offset.T, gradient.T, strict=True)]
        ).T
        model._x = np.linalg.solve(np.eye(2) - 0.5 * dt * flow, half)
    propagator = np.linalg.solve(np.eye(2) - 0.5 * dt * flow, np.eye(2) + 0.5 * dt * flow)
    exact = np.linalg.matrix_power(propagator, steps) @ start
    np.testing.assert_allclose(model._x + model._offset, exact, atol=1e-12)


@pytest.mark.parametrize("shifting", [True, False])
def test_stretched_block_stays_whole_and_its_tracers_on_the_material(shifting):
    """Pulled by 5 %: without shifting or with it, tracers on the pulled face show the strain of the traction."""
    block = [{"name": "block", "rectangle": [0.0, 0.0, 1.0, 0.4]}]
    loads = [{"body": "block", "face": "right", "traction": [4e4, 0.0], "ramp": 0.1}]
    probe = {"name": "end", "body": "block", "point": [1.0, 0.2], "quantity": "displacement-x"}
    scene = solid_scene(
        model="ctvf", dx=0.05, bodies=block, loads=loads, clamps=[{"body": "block", "face": "left"}], damping=30.0,
        poisson_ratio=0.0, shifting=shifting, probes=[probe],
    )  # fmt: skip
    model = make_model(scene, False, 1)
    *_, _ = run(model, 0.4, 20)
    # The hypoelastic law gives a logarithmic strain under true stress σ = T A0/A; ν = 0 keeps A: e^0.04 − 1.
    assert model.probe_values()["end"] == pytest.approx(math.expm1(0.04), rel=0.05)


@pytest.mark.parametrize(("across", "error"), [(6, 0.18)])
def test_static_deflection_of_the_clamped_beam(across, error):
    model = make_model(beam_scene(across, model="ctvf", damping=400.0), False, 1)
    *_, _ = run(model, 0.05, 10)
    assert abs(model.probe_values()["mid_y"] / -5.98618e-5 - 1.0) < error


@pytest.mark.slow
def test_static_deflection_of_the_clamped_beam_at_ten_across():
    model = make_model(beam_scene(10, model="ctvf", damping=190.0), False, 2)
    *_, _ = run(model, 0.1, 10)
    assert abs(model.probe_values()["mid_y"] / -5.98618e-5 - 1.0) < 0.06


def test_rollback_gives_the_same_bytes_across_new_neighbour_lists_and_shifts():
    block = [{"name": "block", "rectangle": [0.0, 0.0, 1.0, 0.4], "velocity": [20.0, 3.0], "free": True}]
    model = make_model(solid_scene(model="ctvf", bodies=block), True, 1)
    model.begin(None)
    *_, _ = run(model, 0.02, 4)
    model._x += 0.02 * np.random.default_rng(1).uniform(-1.0, 1.0, model._x.shape)  # a fifth of the spacing
    saved = {name: array.copy() for name, array in model.state().items()}
    first = model.advance(0.02, 0.04, 20, None)
    assert np.abs(model._offset).max() > 0.0  # it did shift
    model.restore(saved)
    second = model.advance(0.02, 0.04, 20, None)
    for name in ("position", "velocity", "acceleration", "velocity_mean"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()
    np.testing.assert_allclose(
        first.position, second.position - 0.02 * second.velocity_mean + 0.02 * first.velocity_mean, atol=1e-13
    )


def test_one_and_two_threads_give_the_same_bytes(monkeypatch):
    monkeypatch.setattr(updated_lagrangian, "PARALLEL_FROM", 0)
    results = []
    for threads in (1, 2):
        model = make_model(beam_scene(4, model="ctvf"), False, threads)
        *_, _ = run(model, 0.001, 2)
        results.append(b"".join(a.tobytes() for a in model.state().values()))
    assert results[0] == results[1]


def test_fracture_is_reported():
    model = make_model(solid_scene(model="ctvf"), False, 1)
    model.begin(None)
    model._x[:, 0] -= 5.0
    model._find_neighbours(model._x)
    model._survey()
    with pytest.raises(SolverFailed, match="fracture"):
        model.check()
