"""The updated-Lagrangian solid: its terms on polynomial fields, shifting, tracers, rotation, statics, rollback."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from shared.contract import SolverFailed
from shared.kernels import WENDLAND_C2
from shared.scene import load_scene
from solid_solver import updated_lagrangian
from solid_solver.models import make_model
from solid_solver.shifting import field_changes, shifts
from solid_solver.updated_fields import AX, AY, E0, E1, G00, G11, OWN, RHO, SXX, SXY, SYY, SZZ, U, V, X, Y
from solid_solver.updated_material import by_middle, turned_stress
from tests.solid_scenes import beam_scene, run, solid_scene
from tests.structures_invariance import jittered, tracer_error

DX = 0.1
H = 1.3 * DX
DT = 1.0e-9  # s, a step that moves nothing


def put(model, row, values):
    """Set rows of the state from `row` on, (k, n) in published order."""
    model._S[row : row + len(values), model._slot] = values


def get(model, first, last):
    return model._S[first : last + 1, model._slot]


def power_of_stresses(model, curvature, rng):
    """Σ F·u, and −Σ V (σ:∇u + Q:∇²u), for random velocities and random stresses; `curvature`: rows of Q or Z."""
    count = len(model._slot)
    u, place = rng.standard_normal((2, count)), get(model, X, Y)
    put(model, U, u)
    model._at_once(DT)
    gradient, second = get(model, G00, G11), get(model, OWN, OWN + curvature - 1) / DT
    s, q = rng.standard_normal((4, count)), 0.1 * rng.standard_normal((curvature, count))
    put(model, X, place)
    put(model, SXX, s)
    put(model, OWN, q)
    put(model, RHO, np.full((1, count), 1100.0))
    model._at_once(0.0)
    _, c_squared, density, _ = model._moduli()
    pressure = c_squared * (1100.0 - density)
    power = (s[0] - pressure) * gradient[0] + s[1] * (gradient[1] + gradient[2]) + (s[2] - pressure) * gradient[3]
    force = model._mass * get(model, AX, AY)
    return np.sum(force * u), power, q, second, force


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
    work, power, q, rate, force = power_of_stresses(model, 2, np.random.default_rng(0))
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
    field_changes(model._S, np.array([SXX, SXY, SYY]), model._blocks, delta, WENDLAND_C2, H, change)
    np.testing.assert_allclose(change[:, model._slot], slopes @ delta[:, model._slot], atol=1e-13)


@pytest.mark.parametrize("scale", [1.0, 0.01])
def test_shifting_spreads_a_jittered_block_and_leaves_a_uniform_one(scale):
    square = [{"name": "block", "rectangle": [0.0, 0.0, scale, scale], "free": True}]
    for jitter in (0.0, 0.3):
        model = jittered(jitter, dx=DX * scale, bodies=square)
        before = get(model, X, Y)
        delta = np.zeros((2, model._S.shape[1]))
        for _ in range(10):
            shifts(model._S, model._blocks, model._s.spacing, WENDLAND_C2, H * scale, delta)
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
    model._list_pairs(x)
    listed = set()
    for n, (s, count) in enumerate(zip(model._blocks.start, model._blocks.count, strict=True)):
        for d in model._blocks.distance[model._blocks.first[n] : model._blocks.first[n + 1]]:
            listed |= {(a, a + d) for a in range(s, s + count)}
    pairs = cKDTree(x[:, model._slot].T).query_pairs(2.0 * H)
    slots = {(model._slot[a], model._slot[b]) for a, b in pairs}
    assert slots <= listed
    assert {(b, a) for a, b in slots} <= listed


def test_a_list_outgrown_is_made_anew():
    """A block squeezed by a fifth in small steps has pairs come into reach that the first list has not."""
    model = jittered(0.0, poisson_ratio=0.0)
    before = len(model._blocks.distance)
    put(model, U, np.array([[-0.2], [0.0]]) * get(model, X, X))
    model._take_steps(np.zeros((101, 2, 0)), (np.zeros((2, model._S.shape[1])), model._ramped, np.zeros((101, 0))),
                      0.01, (1.0, 0.0))  # fmt: skip
    assert len(model._blocks.distance) > before
    assert np.ptp(get(model, X, X)) == pytest.approx(0.9 * 0.8, rel=1e-3)


@pytest.mark.parametrize("gradient", ["linear", "quadratic"])
def test_spinning_square_keeps_momenta_to_rounding(gradient):
    body = [{"name": "block", "rectangle": [-0.5, -0.5, 0.5, 0.5], "free": True, "spin": 3.0, "velocity": [1.0, 0.0]}]
    model = make_model(solid_scene(model="ctvf", gradient=gradient, alpha=0.0, shifting=False, bodies=body), False, 1)

    def momenta():
        x, u = get(model, X, Y), get(model, U, V)
        return np.array([*(u @ model._mass), model._mass @ (x[0] * u[1] - x[1] * u[0])])

    before = momenta()
    for _ in run(model, 2.0 * math.pi / 3.0, 20):
        pass
    np.testing.assert_allclose(momenta(), before, rtol=0.0, atol=1e-11 * before[2])
    assert np.ptp(get(model, RHO, RHO)) / 1000.0 < 0.05


@pytest.mark.parametrize("shifting", [True, False])
def test_tracers_follow_the_material_through_an_affine_flow(shifting):
    assert tracer_error(100, shifting) < 1e-11


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


def test_static_deflection_of_the_clamped_beam_under_the_linear_gradient():
    model = make_model(beam_scene(6, model="ctvf", gradient="linear", damping=400.0), False, 1)
    *_, _ = run(model, 0.05, 10)
    assert abs(model.probe_values()["mid_y"] / -5.98618e-5 - 1.0) < 0.18


@pytest.mark.parametrize("gradient", ["linear", "quadratic"])
def test_a_plate_swings_and_stays_whole_at_poissons_ratio_049(gradient):
    sets = ["solid.model=ctvf", f"solid.gradient={gradient}", "solid.poisson_ratio=0.49", "solid.dx=4e-3"]
    sets += ["solid.bodies[0].velocity_mode.tip_speed_over_c0=0.005"]
    model = make_model(load_scene("oscillating_plate", sets), False, 1)
    seen = [model.probe_values() for _ in run(model, 0.06, 6)]  # a quarter of a period: to the first peak
    assert max(one["gap"] for one in seen) < 1.05
    assert seen[-1]["strain"] + seen[-1]["kinetic"] == pytest.approx(seen[0]["strain"] + seen[0]["kinetic"], rel=0.03)
    assert seen[-1]["strain"] > 0.9 * seen[0]["kinetic"]


def test_rollback_gives_the_same_bytes_across_new_neighbour_lists_and_shifts():
    block = [{"name": "block", "rectangle": [0.0, 0.0, 1.0, 0.4], "velocity": [20.0, 3.0], "free": True}]
    model = make_model(solid_scene(model="ctvf", bodies=block), True, 1)
    model.begin(None)
    *_, _ = run(model, 0.02, 4)
    put(model, X, get(model, X, Y) + 0.02 * np.random.default_rng(1).uniform(-1.0, 1.0, (2, len(model._slot))))
    saved = {name: array.copy() for name, array in model.state().items()}
    first = model.advance(0.02, 0.04, 20, None)
    assert np.abs(get(model, E0, E1)).max() > 0.0  # it did shift
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
    model._S[X : Y + 1, model._slot[0]] -= 5.0
    model._list_pairs(model._S[X : Y + 1])
    with pytest.raises(SolverFailed, match="fracture"):
        model.check()


@pytest.mark.slow
def test_the_method_as_printed_breaks_a_pulled_strip_without_shifting():
    scene = load_scene("stretched_strip", ["solid.model=ctvf", "solid.gradient=printed", "solid.shifting=false"])
    model = make_model(scene, False, 1)
    with pytest.raises(SolverFailed, match="fracture"):
        *_, _ = run(model, 0.1, 400)
