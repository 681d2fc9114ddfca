"""Probes, starts and loads of elastic bodies: balances that must hold, whatever the model."""

import math

import numpy as np
import pytest

from shared.contract import BadInput
from shared.run.statistics import statistic
from shared.scene.reading import load_scene
from shared.scene.warnings import scene_warnings
from shared.schema.solid import Load
from solid_solver.bodies import lattice_bodies
from solid_solver.following import following_load
from solid_solver.initial import cantilever_mode, cantilever_root, start_velocity
from solid_solver.loads import Schedule, schedule
from solid_solver.models import make_model
from tests.solid_scenes import beam_scene, run, solid_scene

PARTICLES = ("total-lagrangian", "ctvf")


def probes(body, *quantities, **points):
    """A probe of each quantity, named after it; `points`: quantity_with_underscores = place."""
    of_body = [{"name": q.replace("-", "_"), "body": body, "quantity": q} for q in quantities]
    at = [{"name": n, "body": body, "quantity": n.replace("_", "-"), "point": p} for n, p in points.items()]
    return of_body + at


BALANCE = ("kinetic-energy", "strain-energy", "external-work", "dissipated", "reaction-x", "reaction-y")


@pytest.mark.parametrize("model", PARTICLES)
def test_a_beam_at_rest_balances_its_load_and_keeps_half_its_work(model):
    """A load switched on at once does twice the work that is left; clamps carry 20 N/m × 0.2 m; M = q L²/24."""
    scene = beam_scene(6, model=model, damping=400.0)
    wanted = probes("beam", *BALANCE, stress_xx=[0.1, 0.012], stress_xy=[0.05, 0.006])
    scene = type(scene).model_validate(scene.model_dump(by_alias=True) | {"probes": wanted})
    model = make_model(scene, False, 1)
    *_, _ = run(model, 0.06, 60)
    found = model.probe_values()
    assert found["kinetic_energy"] < 1e-4 * found["strain_energy"]
    assert found["external_work"] == pytest.approx(2.0 * found["strain_energy"], rel=5e-3)
    assert found["dissipated"] == pytest.approx(found["strain_energy"], rel=1e-2)
    assert found["reaction_y"] == pytest.approx(4.0, rel=2e-3)
    assert abs(found["reaction_x"]) < 1e-6
    assert found["stress_xx"] == pytest.approx(-20.0 * 0.2**2 / 24.0 * 6.0 / 0.012**2, rel=0.11)
    assert found["stress_xy"] == pytest.approx(-1.5 * 20.0 * 0.05 / 0.012, rel=0.06)


@pytest.mark.parametrize("model", PARTICLES)
def test_without_loads_and_losses_energy_only_changes_its_kind(model):
    scene = solid_scene(
        model=model,
        alpha=0.0,
        bodies=[{"name": "b", "rectangle": [0.0, 0.0, 1.0, 1.0], "spin": 3.0, "free": True}],
        probes=probes("b", *BALANCE[:4], "momentum-x", "angular-momentum"),
    )
    model = make_model(scene, False, 1)
    before = model.probe_values()
    assert before["kinetic_energy"] == pytest.approx(0.5 * 1000.0 * 9.0 * (1.0 / 6.0), rel=0.011)
    *_, _ = run(model, 0.02, 4)
    after = model.probe_values()
    assert after["strain_energy"] > 1e-3
    assert abs(after["dissipated"]) < 3e-3 * after["strain_energy"] + 1e-9
    assert after["angular_momentum"] == pytest.approx(before["angular_momentum"], rel=1e-4)
    assert abs(after["momentum_x"]) < 1e-9


@pytest.mark.parametrize("model", PARTICLES)
def test_a_turn_leaves_the_stress_of_a_carried_square(model):
    scene = load_scene("prescribed_spin", ["solid.dx=0.02", f"solid.model={model}", "end_time=1.0"])
    model = make_model(scene, False, 1)
    before = model.probe_values()
    for time in run(model, 1.0, 8):
        if time == 0.25:  # xx and yy have changed places
            assert model.probe_values()["stress_xx"] == pytest.approx(before["stress_yy"], rel=1e-9)
    for name, value in before.items():
        assert model.probe_values()[name] == pytest.approx(value, rel=1e-10)


def test_roots_and_shape_of_the_cantilever():
    assert [round(cantilever_root(n), 4) for n in (1, 2, 3)] == [1.8751, 4.6941, 7.8548]
    shape, slope = cantilever_mode(1, np.array([0.0, 1.0]))
    np.testing.assert_allclose(shape, [0.0, 1.0], atol=1e-12)
    assert slope[0] == 0.0
    assert slope[1] == pytest.approx(1.3765, rel=1e-4)  # textbook: L F'(L)/F(L)


def test_velocity_mode_turns_with_its_body_and_takes_its_speed_from_c0():
    body = {"name": "b", "rectangle": [0.0, 0.0, 2.0, 0.2], "free": True}
    mode = {"velocity_mode": {"clamped": "left", "tip_speed_over_c0": 0.05}}
    turned = {"rotate": {"angle": 90.0, "about": [0.0, 0.0]}}
    solid = solid_scene(dx=0.05, bodies=[body | mode | turned]).solid
    tip = np.array([[-0.1, 2.0]])
    c0 = math.sqrt(solid.youngs_modulus / (3.0 * (1.0 - 2.0 * solid.poisson_ratio)) / solid.density)
    velocity = start_velocity(solid, solid.bodies[0], tip, np.array([-0.1, 1.0]))
    np.testing.assert_allclose(velocity, [[-0.05 * c0, 0.0]], atol=1e-12)


@pytest.mark.parametrize("face", ["left", "right", "bottom", "top"])
def test_following_pressure_starts_as_given_and_turns_and_stretches_with_its_face(face):
    (body,) = lattice_bodies(solid_scene())
    outward = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}[face]
    load = Load(body="block", face=face, traction=tuple(-5.0 * n for n in outward), following=True)
    following = following_load(load, 0, body, len(body.position), 1000.0)
    rest = np.zeros_like(body.position)
    np.testing.assert_allclose(following.acceleration(rest, 0.0).sum(axis=0) * following.mass, load.traction, atol=1e-9)
    f = np.array([[0.3, -1.2], [1.4, 0.2]])  # a turn and a stretch
    force = following.acceleration(body.position @ (f - np.eye(2)).T, 0.0).sum(axis=0) * following.mass
    cofactor = np.linalg.det(f) * np.linalg.inv(f).T  # Nanson: n da = cof(F) N dA
    np.testing.assert_allclose(force, cofactor @ np.array(load.traction), atol=1e-9)


@pytest.mark.parametrize("model", PARTICLES)
def test_a_following_pressure_works_on_the_area_that_its_face_sweeps(model):
    """The area between the face at rest, the way of its tip and the face as bent, times the pressure."""
    sets = ["solid.dx=3e-3", f"solid.model={model}", "solid.loads[0].following=true"]
    work = 'probes=[{ name = "work", body = "plate", quantity = "external-work" }]'
    model = make_model(load_scene("plate_step_load", [*sets, work, "references=[]", "goal.probe=work"]), False, 1)
    (body,) = model._bodies
    face = np.column_stack([np.full(41, 0.286), np.linspace(0.0, 0.08, 41)])
    row, column, weight = body.point_weights(face[1:])

    def displacement():
        return model.frame().fields["displacement"]

    def bent():
        moved = face.copy()
        np.add.at(moved, row + 1, weight[:, None] * displacement()[column])
        return moved

    tip = [bent()[-1] for _ in run(model, 0.08, 160)]
    outline = np.concatenate([face, tip, bent()[::-1]])
    x, y = outline.T
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    assert area > 1e-3
    assert model.probe_values()["work"] == pytest.approx(600.0 * area, rel=5e-3)


def test_a_table_of_factors_is_followed_and_held():
    load = Load(body="b", acceleration=(1.0, 0.0), table={"times": [0.1, 0.3], "factors": [0.0, 2.0]})
    np.testing.assert_allclose(schedule(load).shares(np.array([0.0, 0.2, 0.3, 9.0])), [0.0, 1.0, 2.0, 2.0])
    table = {"times": [0.0, 1.0], "factors": [0.0, 1.0]}
    body = [{"name": "b", "rectangle": [0.0, 0.0, 1.0, 1.0], "free": True}]
    pushed = [{"body": "b", "acceleration": [6.0, 0.0], "table": table}]
    for model in (*PARTICLES, "spring"):
        scene = solid_scene(model=model, dx=0.25, bodies=body, loads=pushed, probes=probes("b", "momentum-x"))
        one = make_model(scene, False, 1)
        *_, _ = run(one, 0.5, 5)
        assert one.probe_values()["momentum_x"] == pytest.approx(1000.0 * 3.0 * 0.5**2, rel=1e-6)


@pytest.mark.parametrize(
    ("case", "sets", "said"),
    [
        ("udl_beam", ["solid.poisson_ratio=0.5"], "0.5"),
        ("udl_beam", ["solid.youngs_modulus=-1e7"], "-10000000.0: must be a number > 0"),
        ("udl_beam", ["solid.dx=6e-3"], "needs 3"),
        ("udl_beam", ["solid.dx=6e-3", "solid.model=ctvf"], "needs 3"),
        ("udl_beam", ['solid.clamps=[{ body = "beam", face = "front" }]'], "no such face"),
        ("udl_beam", ["probes[0].point=[0.1, 0.02]"], "outside body 'beam'"),
        ("plate_step_load", ["solid.model=rigid"], "rigid only knows"),
        ("plate_step_load", ["solid.model=beam", "solid.loads[0].following=true"], "following"),
        ("oscillating_plate", ['solid.bodies[0].velocity_mode.clamped="top"'], "allowed: left or right"),
        ("oscillating_plate", ["solid.bodies[0].prestrain=[0.01, 0.0, 0.0]"], "clamped"),
        ("oscillating_plate", ["solid.bodies[0].prestrain=[0.9, 0.0, 0.0]"], "0.3"),
        ("prescribed_spin", ['probes[4].quantity="dissipated"'], "prescribed"),
    ],
)
def test_what_cannot_be_is_refused_with_value_and_range(case, sets, said):
    with pytest.raises(BadInput, match=r"mistake") as caught:
        load_scene(case, sets)
    assert said in str(caught.value)


def test_three_particles_across_warn_with_the_reason():
    (warning,) = scene_warnings(load_scene("udl_beam", ["solid.dx=4e-3"]))
    assert "3 particles across 'beam'; bending wants 4" in warning


def test_a_clamp_on_a_face_without_particles_is_refused():
    """The left end of a body that runs out into a sliver thinner than its particles."""
    corners = "[[0.0, 0.0], [0.2, 0.0], [0.2, 0.012], [-0.05, 0.012], [-0.05, 0.0119]]"
    body = f'solid.bodies=[{{ name = "beam", polygon = {corners} }}]'
    with pytest.raises(BadInput, match="no particle stands along it"):
        load_scene("udl_beam", [body, 'solid.clamps=[{ body = "beam", face = "left" }]'])


def test_period_and_change_of_a_history():
    time = np.linspace(0.0, 3.1, 3101)
    value = 0.5 + np.exp(-0.1 * time) * np.sin(2.0 * math.pi * time / 0.7)
    assert statistic("period", time, value) == pytest.approx(0.7, rel=5e-3)
    assert statistic("period", time[:100], value[:100]) is None
    assert statistic("change", time, np.linspace(-4.0, 2.0, 3101)) == pytest.approx(6.0 / 4.0)


@pytest.mark.parametrize("model", [*PARTICLES, "beam", "spring"])
def test_a_pulse_shorter_than_a_step_gives_its_impulse(model):
    """A blow of 1 ms between two rows of probes left a body on a spring, or a free one, where it was."""
    table = {"times": [0.033101, 0.033104, 0.033105], "factors": [0.0, 1.0, 0.0]}
    body = [{"name": "b", "rectangle": [0.0, 0.0, 1.0, 0.25], "free": True}]
    blow = [{"body": "b", "acceleration": [6.0e3, 0.0], "table": table}]
    scene = solid_scene(model=model, dx=0.05, bodies=body, loads=blow, probes=probes("b", "momentum-x"))
    one = make_model(scene, False, 1)
    one.begin(None)
    one.advance(0.0, 0.1, max(40, math.ceil(0.1 / one.stable_step())), None)
    assert one.probe_values()["momentum_x"] == pytest.approx(250.0 * 6.0e3 * 2.0e-6, rel=1e-9)


def test_means_of_a_schedule_are_its_integral():
    """Over a ramp, a table with jumps of slope, before and after them."""
    for when in (Schedule(ramp=0.3), Schedule(times=(0.1, 0.2, 0.5), factors=(2.0, -1.0, 3.0)), Schedule()):
        edges = np.array([0.0, 0.05, 0.13, 0.4, 0.7])
        for mean, a, b in zip(when.means(edges), edges[:-1], edges[1:], strict=True):
            fine = np.linspace(a, b, 20001)
            assert mean == pytest.approx(np.trapezoid(when.shares(fine), fine) / (b - a), rel=1e-6)
