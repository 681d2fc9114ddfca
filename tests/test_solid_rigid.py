"""Rigid bodies against closed forms: prescribed motion, springs and dampers, free flight and spin."""

from __future__ import annotations

import json
import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from shared.contract import BadInput, Loads
from shared.scene import dump_scene, load_scene, scene_warnings
from solid_solver.models import make_model
from solid_solver.rigid_floating import propagator
from tests.scenes import tiny_coupled
from tests.solid_scenes import run, solid_scene

BLOCK = {"name": "block", "rectangle": [0.0, 0.0, 1.0, 0.5]}
MASS, INERTIA = 500.0, 500.0 * (1.0**2 + 0.5**2) / 12.0
CENTRE_Y = {"name": "y", "body": "block", "point": [0.5, 0.25], "quantity": "displacement-y"}
CORNER_X = {"name": "x", "body": "block", "point": [1.0, 0.5], "quantity": "displacement-x"}


def model_of(kind, **solid):
    keys = {"model": kind, "youngs_modulus": None, "bodies": [BLOCK], "dx": 0.1}
    return make_model(solid_scene(**(keys | solid)), False, 1)


# ---- rigid ----------------------------------------------------------------------------------------------------


def test_fixed_body_stands_still_whatever_the_load():
    model = model_of("rigid", gravity=(0.0, -9.81))
    count = len(model.describe().position)
    for _ in run(model, 1.0, 4, Loads(np.ones(count), np.ones((count, 2)))):
        pass
    assert model.frame().position.tobytes() == model.describe().position.tobytes()


def test_prescribed_motion_goes_through_its_table():
    table = {
        "times": [0.0, 1.0, 2.0],
        "translation": [[0.0, 0.0], [0.2, 0.1], [0.3, 0.1]],
        "rotation": [0.0, 90.0, 180.0],
        "about": [0.5, 0.25],
    }
    model = model_of("rigid", motion=table, probes=[CENTRE_Y, CORNER_X])
    reference = model.describe().position
    place = model.begin(None).position
    for w in range(30):
        motion = model.advance(w / 10, (w + 1) / 10, 1, None)
        np.testing.assert_allclose(motion.position, place + 0.1 * motion.velocity_mean, atol=1e-15)
        place = motion.position
        if w == 9:
            arm = reference - [0.5, 0.25]
            np.testing.assert_allclose(place, [0.7, 0.35] + np.c_[-arm[:, 1], arm[:, 0]], atol=1e-14)
            assert model.probe_values()["y"] == pytest.approx(0.1, abs=1e-14)
            assert model.probe_values()["x"] == pytest.approx(0.5 + 0.2 - 0.25 - 1.0, abs=1e-14)
    np.testing.assert_allclose(place, [0.8, 0.35] - (reference - [0.5, 0.25]), atol=1e-14)
    assert np.abs(motion.velocity).max() == 0.0


def test_velocity_and_acceleration_are_the_motions_derivatives():
    table = {
        "times": [0.0, 1.0, 3.0],
        "translation": [[0.0, 0.0], [0.3, 0.1], [0.4, 0.8]],
        "rotation": [0.0, 70.0, 90.0],
    }
    model = model_of("rigid", motion=table)
    dt = 1e-4
    first, second, third = (model.advance(0.6 + k * dt, 0.6 + (k + 1) * dt, 1, None) for k in range(3))
    np.testing.assert_allclose(second.velocity, (third.position - first.position) / (2 * dt), atol=1e-6)
    np.testing.assert_allclose(second.acceleration, (third.velocity - first.velocity) / (2 * dt), atol=1e-6)


# ---- spring ---------------------------------------------------------------------------------------------------


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
    """Accelerated for one second, braked for another: at rest again, 1 m on."""
    table = {"times": [0.0, 1.0, 1.0 + 1e-9, 2.0], "factors": [1.0, 1.0, -1.0, -1.0]}
    load = {"body": "block", "acceleration": [1.0, 0.0], "table": table}
    model = model_of("spring", loads=[load], probes=[CORNER_X])
    for _ in run(model, 2.0, 20):
        pass
    assert model.probe_values()["x"] == pytest.approx(1.0, rel=1e-12)
    assert model.state()["pose_0"][1, 0] == pytest.approx(0.0, abs=1e-12)


# ---- scenes ---------------------------------------------------------------------------------------------------

SCENE = """
schema = 1
title = "a block"
end_time = 0.1
[solid]
model = "spring"
dx = 0.01
density = 1000.0
bodies = [{ name = "b", rectangle = [0.0, 0.0, 0.1, 0.05] }]
spring = { stiffness = [0.0, 1.0, 0.0] }
"""


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def test_rigid_bodies_need_neither_clamp_nor_modulus_and_survive_writing(path):
    scene = load_scene(path)
    assert scene_warnings(scene) == []
    path.write_text(dump_scene(scene))
    assert load_scene(path) == scene


def test_what_has_no_effect_is_told(path):
    sets = ["solid.model=rigid", 'solid.loads=[{body="b", acceleration=[1.0, 0.0]}]']
    told = scene_warnings(load_scene(path, sets))
    assert "solid.spring: has no effect with model rigid" in told
    assert "solid.loads: have no effect with model rigid" in told
    clamped = load_scene(path, ['solid.clamps=[{body="b", face="left"}]'])
    assert "solid.clamps: have no effect with model spring, which solid.spring moves" in scene_warnings(clamped)


def test_motion_is_for_rigid_bodies(path):
    motion = "solid.motion={times=[0.0, 1.0], rotation=[0.0, 90.0]}"
    with pytest.raises(BadInput, match=r"solid.motion: .* not for model spring"):
        load_scene(path, [motion])
    assert load_scene(path, [motion, "solid.model=rigid"]).solid.motion.rotation == [0.0, 90.0]


def test_negative_stiffness_is_refused(path):
    with pytest.raises(BadInput, match=r"solid.spring.stiffness = \[0.0, -1.0, 0.0\]: must be three numbers"):
        load_scene(path, ["solid.spring.stiffness=[0.0, -1.0, 0.0]"])


@pytest.mark.slow
@pytest.mark.timeout(240)
@pytest.mark.parametrize(
    "sets",
    [
        ["solid.model=rigid"],
        ["solid.model=spring", "solid.spring.stiffness=[4e5,4e5,1e4]", "solid.spring.damping=[1700.0,1700.0,20.0]"],
    ],
)
def test_water_on_a_rigid_plate(tmp_path, sets):
    """The plate carries the water's weight; on damped springs (period 27 ms) it also sinks under it and its own."""
    scene = tiny_coupled(tmp_path, end_time=0.05)
    command = [sys.executable, "-m", "coupler", "run", str(scene), "--out", str(tmp_path / "run"), "--quiet"]
    for one in sets:
        command += ["--set", one]
    subprocess.run([*command, "--link", "inprocess"], check=True, timeout=200)
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert result["probes"]["load_y"]["mean"] == pytest.approx(-0.1 * 0.06 * 9810.0, rel=0.06)
    assert result["ledger"]["mapping_error"] < 1e-12
    assert (result["probes"]["mid_y"]["min"] < -1e-5) == (len(sets) == 3)
