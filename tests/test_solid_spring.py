"""Model spring against closed forms: springs and dampers, free flight and spin."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from shared.contract import Loads
from solid_solver.rigid_floating import propagator
from tests.rigid_models import BLOCK, CENTRE_Y, CORNER_X, INERTIA, MASS, model_of
from tests.solid_scenes import run


def test_mass_and_inertia_are_the_rectangles():
    one = model_of("spring")._floating[0]
    np.testing.assert_allclose(one.inertia, [MASS, MASS, INERTIA], rtol=1e-13)


@pytest.mark.parametrize(
    ("damping", "stiffness"), [(0.0, 0.0), (3.0, 0.0), (0.0, 40.0), (2.0, 40.0), (40.0, 4.0), (4.0, 2.0), (1e-9, 1e-9)]
)
def test_propagator_solves_the_oscillator(damping, stiffness):
    def rate(t, y):
        return [y[1], 3.0 / 2.0 - damping / 2.0 * y[1] - stiffness / 2.0 * y[0]]

    exact = solve_ivp(rate, (0.0, 0.7), [0.4, -0.2], rtol=1e-12, atol=1e-14).y[:, -1]
    x, step = propagator(2.0, damping, stiffness, 0.7) @ [0.4, -0.2 * 0.7, 0.7**2 * 3.0 / 2.0]
    np.testing.assert_allclose([x, step / 0.7], exact, rtol=1e-9)


@pytest.mark.parametrize("windows", [7, 400])
def test_gravity_on_a_spring_swings_about_its_rest(windows):
    stiffness = 2.0e4
    model = model_of(
        "spring", gravity=(0.0, -9.81), spring={"stiffness": [0.0, stiffness, 0.0]}, probes=[CENTRE_Y], end_time=2.0
    )
    omega = math.sqrt(stiffness / MASS)
    for t in run(model, 2.0, windows):
        expected = -MASS * 9.81 / stiffness * (1.0 - math.cos(omega * t))
        assert model.probe_values()["y"] == pytest.approx(expected, abs=1e-11)


def test_damped_oscillation_decays_as_it_should():
    spring = {"stiffness": [0.0, 2.0e4, 0.0], "damping": [0.0, 300.0, 0.0]}
    body = BLOCK | {"velocity": [0.0, 1.0]}
    model = model_of("spring", spring=spring, damping=0.2, bodies=[body], probes=[CENTRE_Y])
    gamma = (300.0 / MASS + 0.2) / 2.0
    omega = math.sqrt(2.0e4 / MASS - gamma**2)
    for t in run(model, 3.0, 30):
        exact = math.exp(-gamma * t) * math.sin(omega * t) / omega
        assert model.probe_values()["y"] == pytest.approx(exact, abs=1e-12)


def spinning(**solid):
    return model_of("spring", bodies=[BLOCK | {"velocity": [0.3, -0.1], "spin": 5.0}], **solid)


def test_free_body_keeps_momenta_energy_and_shape():
    model = spinning()
    reference = model.describe().position
    for _ in run(model, 10.0, 200):
        pass
    frame, mass = model.frame(), MASS / len(reference)
    place, velocity = frame.position - frame.position.mean(axis=0), frame.fields["velocity"]
    np.testing.assert_allclose(mass * velocity.sum(axis=0), [0.3 * MASS, -0.1 * MASS], rtol=1e-12)
    spin = np.sum(place[:, 0] * velocity[:, 1] - place[:, 1] * velocity[:, 0]) * mass
    arm = reference - reference.mean(axis=0)
    assert spin == pytest.approx(5.0 * mass * np.sum(arm**2), rel=1e-12)
    assert model.state()["pose_0"][0, 2] == pytest.approx(50.0, rel=1e-12)
    np.testing.assert_allclose(np.hypot(*place.T), np.hypot(*arm.T), rtol=1e-12)


def turned_by_a_force(windows):
    """A dead force at a corner, on springs: angle after 0.6 s and the work less the energy gained."""
    spring = {"stiffness": [3.0e4, 2.0e4, 1.0e3]}
    model = model_of("spring", spring=spring)
    points = model.describe().position
    force = np.zeros_like(points)
    force[-1] = [900.0, 1500.0]
    place, work = model.begin(None).position, 0.0
    for w in range(windows):
        motion = model.advance(0.6 * w / windows, 0.6 * (w + 1) / windows, 1, Loads(np.zeros(len(points)), force))
        model.check()
        work += np.sum(force * (motion.position - place))
        place = motion.position
    pose = model.state()["pose_0"]
    energy = 0.5 * np.sum([MASS, MASS, INERTIA] * pose[1] ** 2) + 0.5 * np.sum(spring["stiffness"] * pose[0] ** 2)
    return pose[0, 2], work - energy, work


def test_turning_body_is_second_order_and_balances_energy():
    arm = np.array([0.45, 0.2])

    def rate(t, y):
        c, s = math.cos(y[0]), math.sin(y[0])
        x, z = c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]
        return [y[1], (x * 1500.0 - z * 900.0 - 1.0e3 * y[0]) / INERTIA]

    exact = solve_ivp(rate, (0.0, 0.6), [0.0, 0.0], rtol=1e-12, atol=1e-14).y[0, -1]
    assert exact > 0.3
    errors = []
    for windows in (10, 20):
        angle, imbalance, work = turned_by_a_force(windows)
        errors.append(abs(angle - exact))
        assert imbalance == pytest.approx(0.0, abs=1e-10 * work)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


def test_traction_acts_on_its_face():
    """On the top face: pushes, and turns by half the height."""
    load = {"body": "block", "face": "top", "traction": [100.0, 0.0]}
    spring = {"stiffness": [1.0e5, 1.0e5, 1.0e5], "damping": [1.4e4, 1.4e4, 4.0e3]}
    model = model_of("spring", spring=spring, loads=[load])
    for _ in run(model, 3.0, 60):
        pass
    x, y, angle = model.state()["pose_0"][0]
    assert (x, y) == (pytest.approx(100.0 / 1.0e5), pytest.approx(0.0, abs=1e-15))
    assert angle == pytest.approx(-25.0 / 1.0e5, rel=1e-3)


def test_ramped_load_is_second_order():
    load = {"body": "block", "acceleration": [1.0, 0.0], "ramp": 1.0}

    def travelled(windows):
        model = model_of("spring", loads=[load], probes=[CORNER_X])
        model.begin(None)
        for w in range(windows):
            model.advance(w / windows, (w + 1) / windows, 1, None)
        return model.probe_values()["x"]

    exact = 0.25 - 1.0 / math.pi**2  # ∫∫ (1 − cos πt)/2
    errors = [abs(travelled(n) - exact) for n in (10, 20)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_rollback_gives_the_same_bytes():
    model = spinning(spring={"stiffness": [1e3, 1e3, 1e2]}, gravity=(0.0, -9.81))
    for _ in run(model, 0.2, 5):
        pass
    saved = {name: array.copy() for name, array in model.state().items()}
    first = model.advance(0.2, 0.3, 3, None)
    model.restore(saved)
    assert model.advance(0.2, 0.3, 3, None).position.tobytes() == first.position.tobytes()


def test_probes_keep_the_books_of_a_damped_spring():
    spring = {"stiffness": [0.0, 2.0e4, 0.0], "damping": [0.0, 2.0e3, 0.0]}
    names = ("kinetic-energy", "strain-energy", "external-work", "dissipated", "reaction-y", "momentum-y", "max-speed")
    probes = [{"name": name, "body": "block", "quantity": name} for name in names]
    model = model_of("spring", gravity=(0.0, -9.81), spring=spring, probes=probes)
    for _ in run(model, 20.0, 400):
        pass
    sag = MASS * 9.81 / 2.0e4
    found = model.probe_values()
    assert found["external-work"] == pytest.approx(MASS * 9.81 * sag, rel=1e-9)
    assert found["strain-energy"] == pytest.approx(0.5 * 2.0e4 * sag**2, rel=1e-9)
    assert found["dissipated"] == pytest.approx(0.5 * MASS * 9.81 * sag, rel=1e-9)
    assert found["reaction-y"] == pytest.approx(MASS * 9.81, rel=1e-9)
    assert abs(found["momentum-y"]) < 1e-6
    assert found["max-speed"] < 1e-8


def test_load_follows_its_table():
    """Accelerated for one second, braked for another, less the nanosecond between: 1 m on, nearly at rest again."""
    table = {"times": [0.0, 1.0, 1.0 + 1e-9, 2.0], "factors": [1.0, 1.0, -1.0, -1.0]}
    load = {"body": "block", "acceleration": [1.0, 0.0], "table": table}
    model = model_of("spring", loads=[load], probes=[CORNER_X])
    for _ in run(model, 2.0, 20):
        pass
    assert model.probe_values()["x"] == pytest.approx(1.0 + 1e-9, rel=1e-12)
    assert model.state()["pose_0"][1, 0] == pytest.approx(1e-9, abs=1e-12)
