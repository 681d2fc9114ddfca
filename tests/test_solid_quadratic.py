"""The quadratic gradient of the updated-Lagrangian solid: exact where it claims to be, forces its transpose."""

import numpy as np
import pytest

from shared.kernels import WENDLAND_C2
from solid_solver import updated_lagrangian
from solid_solver.models import make_model
from solid_solver.updated_quadratic import (
    TERMS,
    chunks,
    quadratic_accelerations,
    quadratic_derivatives,
    quadratic_flux,
)
from tests.solid_scenes import beam_scene, run, solid_scene
from tests.test_solid_updated import Cloud, H


def derivatives(cloud, u):
    found, fits = np.zeros((10, cloud.count)), np.zeros((TERMS * TERMS, cloud.count))
    pairs, scratch = (cloud.first, cloud.neighbour, WENDLAND_C2, H), np.zeros((chunks(cloud.count), TERMS, 2 * TERMS))
    quadratic_derivatives(cloud.x, u, cloud.volume, *pairs, found, fits, scratch)
    return found, fits


def test_derivatives_of_a_quadratic_field_are_exact_on_a_jittered_lattice_also_at_its_corners():
    cloud = Cloud()
    x, y = cloud.x
    u = np.array([1 + 2 * x - y + 3 * x * x - x * y + 0.5 * y * y, 0.3 * x - 2 * y + x * x + 2 * x * y - 4 * y * y])
    one = np.ones_like(x)
    gradient = [2 + 6 * x - y, -1 - x + y, 0.3 + 2 * x + 2 * y, -2 + 2 * x - 8 * y]
    expected = np.array([*gradient, 6 * one, -one, one, 2 * one, 2 * one, -8 * one])
    np.testing.assert_allclose(derivatives(cloud, u)[0], expected, atol=1e-10)


def test_forces_do_the_work_of_both_stresses_and_keep_momentum_and_moment():
    cloud = Cloud()
    rng = np.random.default_rng(0)
    u = rng.standard_normal(cloud.x.shape)
    d, fits = derivatives(cloud, u)
    rho, mass = np.full(cloud.count, 1000.0), 1000.0 * cloud.volume
    s, z = rng.standard_normal((4, cloud.count)), 0.1 * rng.standard_normal((6, cloud.count))
    flux = np.zeros((10, cloud.count))
    quadratic_flux(cloud.volume, rho, s, z, d, fits, flux, (1.0, 0.01, 900.0, 0.0), 0.0)  # c² (ρ − ρ0): p = 1
    a, crowding = np.zeros_like(u), np.zeros(cloud.count)
    pairs = cloud.first, cloud.neighbour, WENDLAND_C2, H
    quadratic_accelerations(cloud.x, u, mass, cloud.volume, flux, *pairs, 0.0, cloud.spacing, a, crowding)
    power = (s[0] - 1) * d[0] + s[1] * (d[1] + d[2]) + (s[2] - 1) * d[3]
    power += z[0] * d[4] + (z[1] + z[3]) * d[5] + z[4] * d[6] + z[1] * d[7] + (z[2] + z[4]) * d[8] + z[5] * d[9]
    force = mass * a
    assert np.sum(force * u) == pytest.approx(-np.sum(cloud.volume * power), rel=1e-10)
    np.testing.assert_allclose(force.sum(axis=1), 0.0, atol=1e-12)
    assert np.sum(cloud.x[0] * force[1] - cloud.x[1] * force[0]) == pytest.approx(0.0, abs=1e-12)


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
        model._x += 0.01 * np.random.default_rng(1).uniform(-1.0, 1.0, model._x.shape)
        saved = {name: array.copy() for name, array in model.state().items()}
        for _ in range(2):
            model.restore(saved)
            ends.append(model.advance(0.02, 0.03, 20, None).position.tobytes())
    assert len(set(ends)) == 1
