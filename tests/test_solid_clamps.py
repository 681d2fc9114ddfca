"""Clamps that follow a motion table, against exact solutions."""

import math

import numpy as np
import pytest

from shared.contract import BadInput
from shared.scene import load_scene
from solid_solver.models import make_model
from tests.solid_scenes import run, solid_scene

LENGTH, HEIGHT = 0.5, 0.1  # m
MODELS = [("ctvf", "linear"), ("ctvf", "quadratic")]


def cantilever(motion, model, gradient, **solid):
    """A cantilever held at its left face by a clamp with `motion`, and a probe at its tip."""
    keys = {
        "bodies": [{"name": "beam", "rectangle": [0.0, 0.0, LENGTH, HEIGHT]}],
        "clamps": [{"body": "beam", "face": "left", "motion": motion}],
        "dx": 0.02,
        "poisson_ratio": 0.0,
    }
    point = {"body": "beam", "point": [LENGTH, 0.5 * HEIGHT]}
    probes = [
        {"name": "x", "quantity": "displacement-x", **point},
        {"name": "y", "quantity": "displacement-y", **point},
        {"name": "root", "quantity": "displacement-y", "body": "beam", "point": [0.0, 0.5 * HEIGHT]},
    ]
    return make_model(solid_scene(probes=probes, model=model, gradient=gradient, **(keys | solid)), False, 1)


@pytest.mark.parametrize(("model", "gradient"), MODELS)
def test_a_body_brought_to_another_place_and_turned_rests_there_unstressed(model, gradient):
    motion = {"times": [0.0, 0.2, 1.0], "translation": [[0, 0], [0.3, 0.1], [0.3, 0.1]], "rotation": [0, 30, 30]}
    beam = cantilever(motion, model, gradient, damping=130.0, youngs_modulus=1.0e8)
    *_, _ = run(beam, 0.45, 20)
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    turned = np.array([[c, -s], [s, c]]) @ [LENGTH, 0.5 * HEIGHT] - [LENGTH, 0.5 * HEIGHT]
    found = beam.probe_values()
    assert [found["x"], found["y"]] == pytest.approx([0.3 + turned[0], 0.1 + turned[1]], abs=2e-5)
    assert np.abs(beam.frame().fields["von_mises"]).max() < 1e-4 * 1e8


@pytest.mark.parametrize(("model", "gradient"), MODELS)
def test_a_base_that_accelerates_steadily_bends_the_beam_as_a_weight_would(model, gradient):
    """In the base's frame −ρ a acts: the tip lags by ρ a h L⁴/(8 E I) + shear, as under gravity."""
    rise, times = 0.5, np.linspace(0.0, 1.0, 201)  # m/s²
    climb = [[0.0, 0.5 * rise * t * t] for t in times]
    keys = {"youngs_modulus": 1.0e7}
    moved = cantilever({"times": list(times), "translation": climb}, model, gradient, **keys)
    weight = [{"body": "beam", "acceleration": [0.0, -rise]}]
    still = cantilever(None, model, gradient, loads=weight, **keys)
    *_, end = run(moved, 0.2, 10)
    *_, _ = run(still, 0.2, 10)
    lift = 0.5 * rise * end * end
    found, weighed = moved.probe_values(), still.probe_values()
    assert found["y"] - lift == pytest.approx(weighed["y"], rel=0.02, abs=2e-6)
    assert found["root"] == pytest.approx(lift, rel=1e-3)


def test_motions_that_no_model_can_follow_are_refused():
    jump = "{ times = [0.0, 1.0], translation = [[0.1, 0.0], [0.0, 0.0]] }"
    sets = ["solid.model=ctvf", f'solid.clamps=[{{ body = "beam", face = "left", motion = {jump} }}]']
    with pytest.raises(BadInput, match="tear"):
        load_scene("udl_beam", sets)
