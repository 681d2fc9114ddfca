"""The beam as others see it: its published points, rollback, errors, and water on it."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from shared.contract import BadInput, Loads, SolverFailed
from shared.geometry.particles import fill
from shared.scene.reading import load_scene
from shared.scene.warnings import scene_warnings
from tests.beam_models import WATER, cantilever, history, plate_b
from tests.scenes import scene_of, tiny_coupled
from tests.solid_scenes import run

# ---- contract -------------------------------------------------------------------------------------------------


def test_published_points_are_the_particles_and_move_as_they_say():
    model = cantilever()
    points = fill(model._scene.solid.bodies[0], 2.0e-3).position
    np.testing.assert_array_equal(model.describe().position, points)
    place = model.begin(None).position
    for w in range(5):
        motion = model.advance(1e-3 * w, 1e-3 * (w + 1), 3, None)
        np.testing.assert_allclose(motion.position, place + 1e-3 * motion.velocity_mean, atol=1e-15)
        place = motion.position


def test_velocity_and_acceleration_are_those_of_the_points():
    model = cantilever(damping=5.0)
    for _ in run(model, 0.05, 50):
        pass
    dt = 1.0e-6
    first, second, third = (model.advance(0.05 + k * dt, 0.05 + (k + 1) * dt, 1, None) for k in range(3))
    speed = np.abs(second.velocity).max()
    np.testing.assert_allclose(second.velocity, (third.position - first.position) / (2 * dt), atol=1e-5 * speed)
    mean = (third.velocity - first.velocity) / (2 * dt)
    np.testing.assert_allclose(third.acceleration, mean, atol=1e-2 * np.abs(mean).max())


def test_interface_forces_act_like_the_traction_they_sum_to():
    """The water's pressure spread over the top points at their depth below the face, less the moment of that depth."""
    loaded, pushed = plate_b(loads=[]), plate_b()
    points = loaded.describe().position
    top = points[:, 1] > 0.045
    force = np.zeros_like(points)
    force[top, 1] = -WATER / top.sum()
    for _ in run(loaded, 0.02, 40, Loads(np.zeros(len(points)), force)):
        pass
    for _ in run(pushed, 0.02, 40):
        pass
    assert loaded.probe_values()["mid_y"] == pytest.approx(pushed.probe_values()["mid_y"], rel=1e-4)


def test_ramp_ends_where_the_sudden_load_does():
    ramped = [{"body": "plate", "face": "top", "traction": [0.0, -WATER], "ramp": 0.01}]
    _, y = history(plate_b(loads=ramped), "mid_y", 0.03, 60)
    assert abs(y[0]) < 0.06 * abs(y[-1])
    assert y[-1] == pytest.approx(-7.109909e-5, rel=2e-4)


def test_rollback_and_restart_give_the_same_bytes():
    model, other = cantilever(), cantilever()
    for _ in run(model, 0.02, 10):
        pass
    saved = {name: array.copy() for name, array in model.state().items()}
    first = model.advance(0.02, 0.022, 2, None)
    model.restore(saved)
    assert model.advance(0.02, 0.022, 2, None).position.tobytes() == first.position.tobytes()
    other.restore(saved)
    assert other.advance(0.02, 0.022, 2, None).velocity.tobytes() == first.velocity.tobytes()


def test_absurd_load_is_reported():
    model = cantilever(loads=[{"body": "plate", "face": "left", "traction": [1.0e14, 0.0]}])
    with pytest.raises(SolverFailed, match=r"beam failed at t = .* ramp the loads"):
        for _ in run(model, 0.02, 4):
            pass


# ---- scenes ---------------------------------------------------------------------------------------------------

SCENE = """
schema = 1
title = "a beam"
end_time = 0.1
[solid]
model = "beam"
dx = 0.01
density = 1000.0
youngs_modulus = 1e6
bodies = [{ name = "b", rectangle = [0.0, 0.0, 0.5, 0.05] }]
clamps = [{ body = "b", face = "left" }]
"""


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("rectangle = [0.0, 0.0, 0.5, 0.05]", "rectangle = [0.0, 0.0, 0.1, 0.05]", "2 times as long as thick"),
        ('face = "left"', 'face = "top"', "model beam is held at its ends, left or right"),
        ("rectangle = [0.0, 0.0, 0.5, 0.05]", "polygon = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.05]]", "needs a rectangle"),
        ("youngs_modulus = 1e6", "", "youngs_modulus is missing; Young's modulus [Pa] is needed by model beam"),
    ],
)
def test_what_is_no_beam_is_refused(tmp_path, old, new, told):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.replace(old, new))
    with pytest.raises(BadInput) as caught:
        load_scene(path)
    assert told in str(caught.value)


def test_one_row_of_points_is_enough_alone_but_not_for_a_fluid(tmp_path):
    assert scene_warnings(scene_of(SCENE, tmp_path, ["solid.dx=0.05"])) == []
    scene = tiny_coupled(tmp_path, solid="beam", solid_dx=1.0e-2)
    with pytest.raises(BadInput, match="one row of points across 'plate'"):
        load_scene(scene)


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_water_cannot_tell_a_beam_from_particles(tmp_path):
    """The same water on the same thin plate: total load, deflection and ledger as with particles.

    Alone under the same load, particles at 6 across give 2.7 % more than at 12 across, the beam 0.8 % less than those.
    """
    found = {}
    for solid in ("total-lagrangian", "beam"):
        folder = tmp_path / solid
        folder.mkdir()
        scene = tiny_coupled(folder, end_time=0.05, solid=solid)
        command = [sys.executable, "-m", "coupler", "run", str(scene), "--out", str(folder / "run"), "--quiet"]
        subprocess.run([*command, "--link", "inprocess"], check=True, timeout=200)
        found[solid] = json.loads((folder / "run" / "result.json").read_text())
    particles, beam_run = found["total-lagrangian"], found["beam"]
    for name, within in (("mid_y", 0.045), ("load_y", 0.01)):
        assert beam_run["probes"][name]["mean"] == pytest.approx(particles["probes"][name]["mean"], rel=within)
    assert beam_run["ledger"]["mapping_error"] < 1e-12
    assert beam_run["ledger"]["impulse_error"] < 0.05
