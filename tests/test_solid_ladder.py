"""The structures' cases at coarse resolution: figures of the benchmark's table, in seconds."""

import math

import numpy as np
import pytest

from shared.scene import load_scene
from shared.schema import Scene
from shared.statistics import statistic
from solid_solver.models import make_model
from tests.solid_scenes import run

LAGRANGIAN, BEAM = ["solid.model=total-lagrangian"], ["solid.model=beam"]


def history(case, sets, probe, end, windows):
    """Times and values of a probe of a case up to `end` [s]."""
    model = make_model(load_scene(case, sets), False, 1)
    rows = [(0.0, model.probe_values()[probe])]
    rows += [(t, model.probe_values()[probe]) for t in run(model, end, windows)]
    return np.array(rows).T


@pytest.mark.parametrize(("sets", "error"), [([*LAGRANGIAN, "solid.dx=4e-3"], 0.02), ([*BEAM, "solid.dx=4e-3"], 0.01)])
def test_oscillating_plate_swings_in_its_period(sets, error):
    time, tip = history("oscillating_plate", sets, "tip_y", 0.3, 300)
    assert statistic("max", time, tip) == pytest.approx(0.1066, rel=error)
    down = time[np.flatnonzero((tip[1:] < 0.0) & (tip[:-1] >= 0.0))[0]]  # from up to down: half a period
    assert 2.0 * down == pytest.approx(0.2549, rel=error)


@pytest.mark.parametrize(("sets", "error"), [([*LAGRANGIAN, "solid.dx=3e-3"], 0.03), ([*BEAM, "solid.dx=3e-3"], 0.015)])
def test_plate_under_a_sudden_pressure(sets, error):
    time, tip = history("plate_step_load", sets, "tip_x", 0.12, 240)
    assert statistic("max", time, tip) == pytest.approx(0.04146, rel=error)
    assert statistic("t_max", time, tip) == pytest.approx(0.0845, rel=error)


@pytest.mark.parametrize(("sets", "error"), [([*LAGRANGIAN, "solid.dx=4e-3"], 0.03), ([*BEAM, "solid.dx=4e-3"], 0.002)])
def test_cantilever_hangs_as_the_exact_beam_does(sets, error):
    _, tip = history("cantilever_gravity", [*sets, "solid.damping=45.0"], "tip_y", 0.6, 60)
    assert tip[-1] == pytest.approx(-0.029166, rel=error)


@pytest.mark.parametrize("ratio", [0.3975, 0.47])
def test_a_pulled_strip_stays_whole(ratio):
    sets = ["solid.model=ctvf", "solid.dx=4e-3", f"solid.poisson_ratio={ratio}", "solid.loads[0].ramp=0.03"]
    _, gap = history("stretched_strip", sets, "gap", 0.06, 12)
    assert gap.max() < 1.3


def changed(scene, turn, length=1.0, time=1.0, mass=1.0):
    """A cantilever's scene turned by the matrix `turn` (a rotation or a mirror image), in other units."""
    data = scene.model_dump(by_alias=True, exclude_none=True)
    solid, body = data["solid"], data["solid"]["bodies"][0]
    x0, y0, x1, y1 = body.pop("rectangle")
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    if np.linalg.det(turn) > 0.0:
        body["rectangle"] = [length * x for x in (x0, y0, x1, y1)]
        body["rotate"] = {"angle": math.degrees(math.atan2(turn[1, 0], turn[0, 0])), "about": [0.0, 0.0]}
    else:  # a mirror in x: the face that was left is right
        mirrored = length * corners @ turn.T
        body["rectangle"] = [*mirrored.min(axis=0), *mirrored.max(axis=0)]
        solid["clamps"][0]["face"] = "right"
    data["gravity"] = tuple(length / time**2 * turn @ np.array(data["gravity"]))
    solid["dx"] *= length
    solid["density"] *= mass / length**2  # per unit of depth, which keeps its unit
    solid["youngs_modulus"] *= mass / time**2
    solid["damping"] /= time
    data["end_time"] *= time
    for probe in data["probes"]:
        probe["point"] = tuple(length * turn @ np.array(probe["point"]))
    return Scene.model_validate(data)


@pytest.mark.parametrize("model", ["total-lagrangian", "ctvf"])
def test_turned_mirrored_and_rescaled_scenes_give_the_same_answer(model):
    scene = load_scene("cantilever_gravity", [f"solid.model={model}", "solid.dx=5e-3"])
    data = scene.model_dump(by_alias=True, exclude_none=True)
    kept = [p for p in data["probes"] if p["quantity"].startswith("displacement")]
    scene = Scene.model_validate(data | {"probes": kept, "references": [], "goal": None})
    angle = math.radians(30.0)
    rotation = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def tip(turn, **units):
        end, length = 0.05 * units.get("time", 1.0), units.get("length", 1.0)
        one = make_model(changed(scene, turn, **units), False, 1)
        one.begin(None)
        one.advance(0.0, end, 1200, None)  # steps of one length: what rounding does to the stable step must not tell
        found = one.probe_values()
        return turn.T @ np.array([found["tip_x"], found["tip_y"]]) / length

    expected = tip(np.eye(2))
    assert np.linalg.norm(expected) > 1e-3
    for turn in (rotation, np.diag([-1.0, 1.0])):
        np.testing.assert_allclose(tip(turn), expected, rtol=0.0, atol=1e-8 * np.linalg.norm(expected))
    scaled = tip(np.eye(2), length=1e3, time=1e3, mass=1e6)
    np.testing.assert_allclose(scaled, expected, rtol=0.0, atol=1e-8 * np.linalg.norm(expected))
