"""Clamps that follow a motion table, against exact solutions."""

import math

import numpy as np
import pytest

from shared.contract import BadInput
from shared.scene.reading import load_scene
from solid_solver.bodies import lattice_bodies
from solid_solver.following import following_load
from solid_solver.models import make_model
from tests.solid_scenes import run, solid_scene

LENGTH, HEIGHT = 0.5, 0.1  # m
MODELS = [("total-lagrangian", "linear"), ("beam", "linear"), ("ctvf", "linear"), ("ctvf", "quadratic")]


def cantilever(motion, model, gradient, **solid):
    """A cantilever held at its left face by a clamp with `motion`, and a probe at its tip."""
    keys = {
        "bodies": [{"name": "beam", "rectangle": [0.0, 0.0, LENGTH, HEIGHT]}],
        "clamps": [{"body": "beam", "face": "left", "motion": motion}],
        "dx": 0.02,
        "poisson_ratio": 0.0,
    }
    point = {"body": "beam", "point": [LENGTH, 0.5 * HEIGHT]}
    keys["probes"] = [
        {"name": "x", "quantity": "displacement-x", **point},
        {"name": "y", "quantity": "displacement-y", **point},
        {"name": "root", "quantity": "displacement-y", "body": "beam", "point": [0.0, 0.5 * HEIGHT]},
    ]
    return make_model(solid_scene(model=model, gradient=gradient, **(keys | solid)), False, 1)


@pytest.mark.parametrize(("model", "gradient"), MODELS)
def test_a_body_brought_to_another_place_and_turned_rests_there_unstressed(model, gradient):
    motion = {"times": [0.0, 0.2, 1.0], "translation": [[0, 0], [0.3, 0.1], [0.3, 0.1]], "rotation": [0, 30, 30]}
    beam = cantilever(motion, model, gradient, damping=130.0, youngs_modulus=1.0e8)
    *_, _ = run(beam, 0.4, 20)
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


@pytest.mark.parametrize(("model", "gradient"), [*MODELS[:2], MODELS[3]])
def test_an_end_turned_slowly_bends_the_beam_between_as_pure_bending_does(model, gradient):
    """Half of one end's turn θ is pure bending, which lifts the middle by θ L/8, half leaves the middle where it is."""
    angle, still = 0.5, {"body": "beam", "face": "left"}  # degree
    turn = {"times": [0.0, 0.15, 1.0], "rotation": [0.0, angle, angle], "about": [LENGTH, 0.5 * HEIGHT]}
    clamps = [still, {"body": "beam", "face": "right", "motion": turn}]
    keys = {"clamps": clamps, "youngs_modulus": 1.0e7, "damping": 200.0}
    keys["probes"] = [{"name": "mid", "body": "beam", "point": [0.25, 0.05], "quantity": "displacement-y"}]
    beam = cantilever(None, model, gradient, **keys)
    *_, _ = run(beam, 0.25, 10)
    assert beam.probe_values()["mid"] == pytest.approx(-math.radians(angle) * LENGTH / 8.0, rel=0.01)


def shaken(x):
    """Tip over base and clamp force over E I β³ of a thin cantilever on a swinging base; x = βL, EIβ⁴ = ρH(ω²−iηω)."""
    below = 1.0 + np.cos(x) * np.cosh(x)
    return (np.cos(x) + np.cosh(x)) / below, -(np.sin(x) * np.cosh(x) + np.cos(x) * np.sinh(x)) / below


@pytest.mark.parametrize("model", ["total-lagrangian", "beam"])
def test_a_shaken_cantilever_swings_and_pulls_as_the_thin_beam_does(model):
    """Base motion at half the first frequency: tip and reaction in amplitude and phase, against the closed form."""
    length, height, stiffness, density, swing = 0.8, 0.1, 1.0e7, 1000.0, 1e-3
    bending = stiffness * height**3 / 12.0
    first = (1.875104 / length) ** 2 * math.sqrt(bending / (density * height))
    omega, eta = 0.5 * first, 0.4 * first
    end = 8.0 * math.pi / omega
    times = np.linspace(0.0, end, 801)
    table = {"times": list(times), "translation": [[0.0, swing * math.sin(omega * t)] for t in times]}
    point = {"body": "beam", "point": [length, 0.5 * height]}
    probes = [
        {"name": "tip", "quantity": "displacement-y", **point},
        {"name": "pull", "quantity": "reaction-y", "body": "beam"},
    ]
    clamps = [{"body": "beam", "face": "left", "motion": table}]
    keys = {"bodies": [{"name": "beam", "rectangle": [0.0, 0.0, length, height]}], "dx": 0.025, "damping": eta}
    keys |= {"clamps": clamps, "probes": probes, "youngs_modulus": stiffness, "density": density}
    beam = cantilever(None, model, "linear", **keys)
    rows = np.array([(t, *beam.probe_values().values()) for t in run(beam, end, 400)])
    rows = rows[rows[:, 0] > 0.75 * end]  # the last of four periods: what the start excited has died down to 1e-4
    waves = np.column_stack([np.sin(omega * rows[:, 0]), np.cos(omega * rows[:, 0])])
    (tip, pull), *_ = np.linalg.lstsq(waves, rows[:, 1:], rcond=None)[0].T, None
    beta = (density * height * (omega**2 - 1j * eta * omega) / bending) ** 0.25
    over_base, force = shaken(beta * length)
    force *= swing * bending * beta**3
    assert complex(*tip) == pytest.approx(swing * over_base, rel=0.02)
    assert complex(*pull) == pytest.approx(force, rel=0.02)


def test_a_following_pressure_turns_with_the_clamp_that_carries_its_body():
    motion = {"times": [0.0, 1.0], "translation": [[0.0, 0.0], [3.0, -2.0]], "rotation": [0.0, 40.0]}
    body = {"name": "beam", "rectangle": [0.0, 0.0, LENGTH, HEIGHT]}
    load = {"body": "beam", "face": "top", "traction": [5.0, -20.0], "following": True}
    clamps = [{"body": "beam", "face": "left", "motion": motion}]
    scene = solid_scene(bodies=[body], clamps=clamps, loads=[load], dx=0.02)
    lattice = lattice_bodies(scene)[0]
    following = following_load(scene.solid.loads[0], 0, lattice, len(lattice.position), 1000.0)
    c, s = math.cos(math.radians(40.0)), math.sin(math.radians(40.0))
    turn = np.array([[c, -s], [s, c]])
    forces = following.forces(lattice.position @ (turn - np.eye(2)).T + [3.0, -2.0], 1.0)
    np.testing.assert_allclose(forces.sum(axis=0), turn @ [5.0 * LENGTH, -20.0 * LENGTH], rtol=1e-9)


@pytest.mark.parametrize("model", ["total-lagrangian", "beam"])
def test_rollback_under_a_moving_clamp_gives_the_same_bytes(model):
    motion = {"times": [0.0, 0.05, 0.2], "translation": [[0, 0], [0.0, 0.01], [0, 0]], "rotation": [0, 3, 0]}
    beam = cantilever(motion, model, "linear")
    beam.begin(None)
    beam.advance(0.0, 0.01, 200, None)
    saved = {name: array.copy() for name, array in beam.state().items()}
    first = beam.advance(0.01, 0.02, 200, None)
    beam.restore(saved)
    assert beam.advance(0.01, 0.02, 200, None).position.tobytes() == first.position.tobytes()


@pytest.mark.parametrize("model", ["ctvf", "total-lagrangian", "beam"])
def test_motions_that_would_tear_the_body_are_refused(model):
    jump = "{ times = [0.0, 1.0], translation = [[0.1, 0.0], [0.0, 0.0]] }"
    sets = [f"solid.model={model}", f'solid.clamps=[{{ body = "beam", face = "left", motion = {jump} }}]']
    with pytest.raises(BadInput, match="tear"):
        load_scene("udl_beam", sets)


def test_bodies_that_are_rigid_have_no_clamps_that_move():
    move = "{ times = [0.0, 1.0], translation = [[0.0, 0.0], [0.1, 0.0]] }"
    sets = [
        "solid.model=spring",
        "solid.loads=[]",
        f'solid.clamps=[{{ body = "beam", face = "left", motion = {move} }}]',
    ]
    with pytest.raises(BadInput, match=r"use solid\.motion with model rigid"):
        load_scene("udl_beam", sets)
