"""Bodies of the updated-Lagrangian solid in motion: momenta, tracers, statics, rollback, fracture."""

import math

import numpy as np
import pytest

from shared.contract import SolverFailed
from shared.scene.reading import load_scene
from solid_solver import updated_lagrangian
from solid_solver.models import make_model
from solid_solver.updated_fields import E0, E1, RHO, U, V, X, Y
from tests.solid_scenes import beam_scene, run, solid_scene
from tests.structures_invariance import tracer_error
from tests.updated_models import get, put


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
    model = make_model(solid_scene(model="ctvf", gradient="linear", bodies=block), True, 1)
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
    model._stepper.list_pairs(model._S[X : Y + 1])
    with pytest.raises(SolverFailed, match="fracture"):
        model.check()


def test_a_body_torn_between_two_rows_is_reported():
    """Each half keeps its own neighbours, so that no particle is far from the nearest one."""
    model = make_model(solid_scene(model="ctvf"), False, 1)
    model.begin(None)
    x = model._S[X, model._slot]
    model._S[X, model._slot] = np.where(x > x.mean(), x + 0.5 * np.ptp(x), x)
    model._stepper.list_pairs(model._S[X : Y + 1])
    with pytest.raises(SolverFailed, match=r"side by side .* \(fracture\)"):
        model.check()


@pytest.mark.slow
def test_the_method_as_printed_breaks_a_pulled_strip_without_shifting():
    scene = load_scene("stretched_strip", ["solid.model=ctvf", "solid.gradient=printed", "solid.shifting=false"])
    model = make_model(scene, False, 1)
    with pytest.raises(SolverFailed, match="fracture"):
        *_, _ = run(model, 0.1, 400)


@pytest.mark.parametrize("h_over_dx", [1.3, 1.5])
def test_a_sharp_corner_needs_more_neighbours_and_says_so(h_over_dx):
    """The corner of a triangle, 37° wide, that spins: columns of one and two particles hardly span a quadratic."""
    body = [{"name": "a", "polygon": [[0.0, 0.0], [0.3, 0.0], [0.0, 0.4]], "free": True, "spin": -2.0}]
    scene = solid_scene(model="ctvf", dx=0.02, h_over_dx=h_over_dx, youngs_modulus=1e7, bodies=body)
    steps = run(make_model(scene, False, 1), 0.005, 10)
    if h_over_dx < 1.5:
        with pytest.raises(SolverFailed, match=r"1\.5 at a sharp corner"):
            list(steps)
    else:
        assert len(list(steps)) == 10
