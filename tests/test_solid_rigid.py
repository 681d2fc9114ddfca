"""Model rigid: prescribed motion; scenes of rigid bodies; water on them."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from shared.contract import BadInput, Loads
from shared.scene.reading import dump_scene, load_scene
from shared.scene.warnings import scene_warnings
from tests.rigid_models import CENTRE_Y, CORNER_X, model_of
from tests.scenes import tiny_coupled
from tests.solid_scenes import run


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
    with pytest.raises(BadInput, match=r"solid.spring.stiffness = \[0.0, -1.0, 0.0\]: must be three numbers ≥ 0"):
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
