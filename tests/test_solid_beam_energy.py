"""The beam's energy balance step by step, its momenta, and rotations that cost nothing."""

from __future__ import annotations

import numpy as np
import pytest

from shared.contract import Loads
from shared.schema.probes import Probe
from solid_solver.beam_element import DISSIPATION, strains
from solid_solver.models import make_model
from tests.beam_models import beam, cantilever, oscillating_plate
from tests.solid_scenes import beam_scene, run

# ---- energy ---------------------------------------------------------------------------------------------------


def raised_energy(model, dt):
    """Energy plus D/2 (Δv·M Δv + Δε·C Δε), and the arrays of the last step."""
    state, one = model.state(), model._beams[0].beam
    dv, de = dt * state["acceleration_0"], dt * state["strain_rate_0"]
    stored = sum(model.energies()) + 0.5 * DISSIPATION * _norm(one, dv, de)
    return stored, dv.copy(), de.copy()


def _norm(one, dv, de):
    return np.sum(one.mass * dv**2) + one.h * np.sum(np.array(one.stiffness) * de**2)


@pytest.mark.parametrize("dt", [1.0e-4, 2.0e-3, 2.0e-2])
def test_energy_of_every_step_is_the_work_on_the_published_points(dt):
    """Large rotations, forces that change from window to window, steps up to an eighth of the first period."""
    model = cantilever(loads=[])
    points = model.describe().position
    rng = np.random.default_rng(1)
    before, dv0, de0 = raised_energy(model, dt)
    place = model.begin(None).position
    scale, swing = 0.0, 0.0
    for w in range(12):
        force = rng.normal(size=points.shape) * 0.2 + [0.2, 0.0]
        motion = model.advance(w * dt, (w + 1) * dt, 1, Loads(np.zeros(len(points)), force))
        model.check()
        work = np.sum(force * (motion.position - place))
        after, dv, de = raised_energy(model, dt)
        lost = 0.5 * DISSIPATION * _norm(model._beams[0].beam, dv - dv0, de - de0)
        scale = max(scale, abs(work), after)
        assert after - before == pytest.approx(work - lost, abs=1e-9 * scale)
        before, dv0, de0, place = after, dv, de, motion.position
        swing = max(swing, np.abs(motion.position - points).max())
    assert swing > (0.0 if dt < 1e-3 else 0.005)


def test_free_vibration_keeps_its_energy_at_the_default_step():
    model = oscillating_plate(0.05, 0.3975)
    start = sum(model.energies())
    for _ in run(model, 2.55, 1020):
        pass
    assert -5e-3 < sum(model.energies()) / start - 1.0 < 0.0


def test_steps_far_too_long_stay_bounded():
    """Steps of a fifth and two fifths of the period: the raised energy only falls, the swing is lost."""
    for dt in (0.05, 0.1):
        model = oscillating_plate(0.05, 0.3975)
        start = bound = raised_energy(model, dt)[0]
        for w in range(40):
            model.advance(dt * w, dt * (w + 1), 1, None)
            model.check()
            now = raised_energy(model, dt)[0]
            assert now < bound + 1e-9 * start
            bound = now
        assert sum(model.energies()) < 0.2 * start


def test_unresolved_modes_die_out():
    """A shock along the axis, in steps of about its ringing's period, is forgotten, not handed on from step to step."""
    model = make_model(beam_scene(10, model="beam", loads=[]), False, 1)
    force = np.zeros((len(model.describe().position), 2))
    force[100, 0] = 1.0
    dt = 10.0 * model.stable_step()
    model.advance(0.0, dt, 1, Loads(np.zeros(len(force)), force))
    model.advance(dt, 2 * dt, 1, None)
    shock = np.abs(model.state()["velocity_0"][:, 0]).max()
    for w in range(2, 30):
        model.advance(w * dt, (w + 1) * dt, 1, None)
    assert np.abs(model.state()["velocity_0"][:, 0]).max() < 1e-3 * shock


def test_probes_keep_the_books_of_a_beam_brought_to_rest():
    """Half the load's work is stored, half is dissipated; the clamps carry the load; the stress is the moment's."""
    names = ("kinetic-energy", "strain-energy", "external-work", "dissipated", "reaction-y", "reaction-x")
    probes = [{"name": name, "body": "beam", "quantity": name} for name in names]
    probes += [{"name": "top", "body": "beam", "point": [0.1, 0.012], "quantity": "stress-xx"}]
    scene = beam_scene(10, model="beam", damping=300.0)
    scene = scene.model_copy(update={"probes": [*scene.probes, *(Probe.model_validate(p) for p in probes)]})
    model = make_model(scene, False, 1)
    for _ in run(model, 0.15, 60):
        pass
    found = model.probe_values()
    assert found["strain-energy"] == pytest.approx(0.5 * found["external-work"], rel=1e-3)
    assert found["dissipated"] == pytest.approx(found["strain-energy"], rel=1e-3)
    assert found["kinetic-energy"] < 1e-8 * found["strain-energy"]
    assert found["reaction-y"] == pytest.approx(20.0 * 0.2, rel=1e-4)
    assert abs(found["reaction-x"]) < 1e-2
    assert found["top"] == pytest.approx(-20.0 * 0.2**2 / 24.0 * 6.0 / 0.012**2, rel=5e-3)


def test_free_spinning_beam_keeps_its_momenta():
    """Linear momentum to rounding; angular momentum and energy as far as the scheme's order goes, see the steps."""
    names = ("momentum-x", "momentum-y", "angular-momentum", "kinetic-energy")
    body = {"name": "b", "rectangle": [0.0, 0.0, 1.0, 0.1], "free": True, "velocity": [1.0, -2.0], "spin": 3.0}
    probes = [{"name": name, "body": "b", "quantity": name} for name in names]
    drift = []
    for windows in (200, 400):
        model = beam(dx=0.05, bodies=[body], probes=probes)
        model.begin(None)
        start = model.probe_values()
        assert start["angular-momentum"] == pytest.approx(
            -2.0 * 100.0 * 0.5 - 100.0 * 0.05 + 3.0 * 100.0 * 1.01 / 12.0, rel=2e-3
        )
        for w in range(windows):
            model.advance(2.0 * w / windows, 2.0 * (w + 1) / windows, 1, None)
        end = model.probe_values()
        assert end["momentum-x"] == pytest.approx(100.0, rel=1e-10)
        assert end["momentum-y"] == pytest.approx(-200.0, rel=1e-10)
        drift.append(abs(end["angular-momentum"] / start["angular-momentum"] - 1.0))
    assert drift[1] < 0.2 * drift[0] < 1e-4


# ---- rotation -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [1e-6, 1.0, 3.0])
def test_rigid_rotation_costs_nothing_and_turns_the_points(angle):
    model = beam(
        dx=0.05,
        bodies=[{"name": "b", "rectangle": [0.2, 0.1, 1.2, 0.3], "free": True}],
    )
    one = model._beams[0].beam
    state = {name: array.copy() for name, array in model.state().items()}
    along = one.h * np.arange(len(one.free))
    state["displacement_0"][:] = np.c_[along * (np.cos(angle) - 1.0), along * np.sin(angle), np.full(len(along), angle)]
    model.restore(state)
    found = np.empty((len(along) - 1, 3))
    strains(state["displacement_0"], one.h, found)
    assert np.abs(found).max() < 1e-14
    c, s = np.cos(angle), np.sin(angle)
    expected = one.origin + (model.describe().position - one.origin) @ np.array([[c, s], [-s, c]])
    np.testing.assert_allclose(model.frame().position, expected, atol=1e-14)


@pytest.mark.parametrize("angle", [30.0, -90.0])
def test_turned_scene_gives_the_turned_answer(angle):
    plain, turned = cantilever(), cantilever(angle)
    for _ in run(plain, 0.08, 40):
        pass
    for _ in run(turned, 0.08, 40):
        pass
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    expected = plain.frame().position @ np.array([[c, s], [-s, c]])
    np.testing.assert_allclose(turned.frame().position, expected, rtol=0, atol=1e-9)
    np.testing.assert_allclose(turned.frame().fields["von_mises"], plain.frame().fields["von_mises"], rtol=1e-5)


def test_free_beam_keeps_linear_momentum_and_flies_straight():
    model = beam(
        dx=0.05, bodies=[{"name": "b", "rectangle": [0.0, 0.0, 1.0, 0.1], "free": True, "velocity": [1.0, -2.0]}]
    )
    before = model.describe().position
    for _ in run(model, 0.5, 20):
        pass
    np.testing.assert_allclose(model.frame().position, before + [0.5, -1.0], atol=1e-12)
