"""The quadratic gradient of the updated-Lagrangian solid: exact where it claims to be, forces its transpose."""

import numpy as np
import pytest

from shared.kernels import WENDLAND_C2, kernel_w
from shared.scene.reading import load_scene
from solid_solver import updated_lagrangian
from solid_solver.models import make_model
from solid_solver.updated_fields import AX, AY, G00, G11, OWN, RHO, SXX, U, X, Y
from tests.solid_scenes import beam_scene, run, solid_scene
from tests.updated_models import DT, DX, H, get, jittered, power_of_stresses, put


def test_derivatives_of_a_quadratic_field_are_exact_on_a_jittered_lattice_also_at_its_corners():
    """Second derivatives are read off the rates of Z_k = V/12 C:ε̇,k, here with ν = 0 and 2G = 1."""
    model = jittered(gradient="quadratic", poisson_ratio=0.0)
    x, y = get(model, X, Y)
    put(
        model,
        U,
        np.array([1 + 2 * x - y + 3 * x * x - x * y + 0.5 * y * y, 0.3 * x - 2 * y + x * x + 2 * x * y - 4 * y * y]),
    )
    model._at_once(DT)
    gradient = [2 + 6 * x - y, -1 - x + y, 0.3 + 2 * x + 2 * y, -2 + 2 * x - 8 * y]
    np.testing.assert_allclose(get(model, G00, G11), gradient, atol=1e-6)
    rate = get(model, OWN, OWN + 5) / DT * 12.0 / (DX * DX)
    # ε,0 = (6, (−1 + 2)/2, 2), ε,1 = (−1, (1 + 2)/2, −8)
    np.testing.assert_allclose(rate, np.tile([[6.0], [0.5], [2.0], [-1.0], [1.5], [-8.0]], len(x)), atol=1e-4)


def _pulled(model, stress, gradient):
    """A (6, n) of the strains' `gradient` (6, n) under `stress` (3, n), term by term as updated_pull.py states it."""
    x, result = get(model, X, Y).T, np.zeros_like(gradient)
    for a, (xx, xy, yy) in enumerate(stress.T):
        values, vectors = np.linalg.eigh([[xx, xy], [xy, yy]])
        if values[1] > 0.0:
            positive = np.maximum(values, 0.0) / values[1]
            N = vectors @ np.diag(positive) @ vectors.T
            d = x - x[a]
            near = np.einsum("bi,ij,bj->b", d, N, d)
            w = np.array([kernel_w(WENDLAND_C2, r2, H) for r2 in np.sum(d * d, axis=1)])
            tensor = gradient[[[0, 1], [1, 2], [3, 4], [4, 5]], a].reshape(2, 2, 2)
            full = values[1] * (w @ near**2) / (w @ near) * np.einsum("kl,im,jn,lmn->kij", N, N, N, tensor)
            result[:, a] = full[[0, 0, 0, 1, 1, 1], [0, 0, 1, 0, 0, 1], [0, 1, 1, 0, 1, 1]]
    return result


def test_forces_do_the_work_of_all_stresses_and_keep_momentum_and_moment():
    """Also where the density varies; with ν = 0 and 2G = 1 the rates of Z_k are V/12 ε̇,k."""
    model = jittered(gradient="quadratic", poisson_ratio=0.0)
    work, power, z, rate, force, stress = power_of_stresses(model, 6, np.random.default_rng(0))
    twice = np.array([1.0, 2.0, 1.0, 1.0, 2.0, 1.0])[:, None]  # of the off-diagonal component
    z = z + _pulled(model, stress, z / (model._mass / 1100.0 / 12.0))
    power += np.sum(twice * z * rate, axis=0) / (model._mass / 1000.0 / 12.0)
    assert work == pytest.approx(-np.sum(model._mass / 1100.0 * power), rel=1e-6)
    np.testing.assert_allclose(force.sum(axis=1), 0.0, atol=1e-10)
    x = get(model, X, Y)
    assert np.sum(x[0] * force[1] - x[1] * force[0]) == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("pull", [(0.3, 0.0), (0.0, 0.3), (0.3, 0.3), (-0.3, 0.3)])
@pytest.mark.parametrize("ratio", [0.0, 0.45])
def test_a_zigzag_along_a_pull_is_pushed_back(pull, ratio):
    """Between the faces, by the work of what it changes in the forces: a pull of 0.14 E without A feeds it."""
    dx = 0.5 * DX
    model = jittered(0.0, gradient="quadratic", poisson_ratio=ratio, dx=dx)
    x = get(model, X, Y)
    stress = np.repeat([[pull[0]], [0.0], [pull[1]], [0.0]], x.shape[1], axis=1)
    for along in np.flatnonzero(np.array(pull) > 0.0):
        zigzag, forces = np.zeros_like(x), []
        inside = np.sin(np.pi * x[along]) ** 2
        zigzag[along] = 1e-6 * dx * inside * np.where(np.rint(x[along] / dx - 0.5) % 2, 1.0, -1.0)
        for u in (0.0 * zigzag, zigzag / DT):
            put(model, X, x)
            put(model, U, u)
            put(model, RHO, np.full((1, x.shape[1]), 1000.0))
            put(model, SXX, stress)
            put(model, OWN, np.zeros((6, x.shape[1])))
            model._at_once(DT)
            forces.append(model._mass * get(model, AX, AY))
        assert np.sum((forces[1] - forces[0]) * zigzag) < 0.0


def test_a_plate_holds_where_its_corner_is_pulled_by_a_third():
    """1200 Pa on plate_step_load, twice the case's own: its tip to its peak as total-lagrangian has it, 64.78 mm."""
    loads = 'solid.loads=[{ body = "plate", face = "left", traction = [1200.0, 0.0] }]'
    model = make_model(load_scene("plate_step_load", ["solid.model=ctvf", loads]), False, 1)
    seen = [model.probe_values() for _ in run(model, 0.16, 160)]
    assert max(one["tip_x"] for one in seen) == pytest.approx(64.78e-3, rel=0.01)
    assert seen[-1]["tip_x"] < 10e-3  # and back
    most = max(one["work"] for one in seen)
    assert all(abs(one["dissipated"]) < 0.01 * most for one in seen)


@pytest.mark.parametrize(("ratio", "truth"), [(0.0, -5.98618e-5), (0.34, -5.3465e-5)])
def test_static_deflection_of_the_clamped_beam(ratio, truth):
    scene = beam_scene(6, model="ctvf", gradient="quadratic", damping=400.0, poisson_ratio=ratio)
    model = make_model(scene, False, 1)
    *_, _ = run(model, 0.04, 10)
    assert model.probe_values()["mid_y"] == pytest.approx(truth, rel=0.025)


def test_stress_varying_over_cells_is_counted_in_the_energy():
    """What a load on a beam at rest has done: twice the energy kept, half of it lost to damping."""
    work = {"name": "work", "body": "beam", "quantity": "external-work"}
    kept = {"name": "kept", "body": "beam", "quantity": "strain-energy"}
    scene = beam_scene(3, model="ctvf", gradient="quadratic", damping=400.0, poisson_ratio=0.3)
    scene = type(scene).model_validate(scene.model_dump(by_alias=True) | {"probes": [work, kept]})
    model = make_model(scene, False, 1)
    *_, _ = run(model, 0.06, 60)
    found = model.probe_values()
    assert found["work"] == pytest.approx(2.0 * found["kept"], rel=0.02)


def test_rollback_and_threads_give_the_same_bytes(monkeypatch):
    monkeypatch.setattr(updated_lagrangian, "PARALLEL_FROM", 0)
    block = [{"name": "block", "rectangle": [0.0, 0.0, 1.0, 0.4], "velocity": [20.0, 3.0], "free": True}]
    ends = []
    for threads in (1, 2):
        model = make_model(solid_scene(model="ctvf", gradient="quadratic", bodies=block), True, threads)
        *_, _ = run(model, 0.02, 4)
        put(model, X, get(model, X, Y) + 0.01 * np.random.default_rng(1).uniform(-1.0, 1.0, (2, len(model._slot))))
        saved = {name: array.copy() for name, array in model.state().items()}
        for _ in range(2):
            model.restore(saved)
            ends.append(model.advance(0.02, 0.03, 20, None).position.tobytes())
    assert len(set(ends)) == 1
