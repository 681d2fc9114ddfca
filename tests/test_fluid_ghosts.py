"""Ghosts of walls and structures: their pressure, their places, their motion."""

import math

import numpy as np
import pytest

from fluid_solver.fields import AX, AY, FLUID, RHO, STRUCTURE, P, U, X, Y
from fluid_solver.ghosts import lay_ghosts
from fluid_solver.models import make_model
from fluid_solver.motion import GhostMotion, WallMotion, structure_pose
from fluid_solver.wall_forces import WallForces
from shared.contract import Kinematics
from shared.scene.reading import load_scene
from shared.schema.geometry import Motion
from tests.fluid_models import G, begun, fluid_rows, run, scene, tank


def test_ghost_pressure_is_exact_for_a_linear_field():
    """Eq. 14 with the wall's acceleration: p = ρ (g − a)·x + const is extended without error."""
    model = begun(tank())
    store = model.store
    fluid, ghost = store.kind == FLUID, store.kind != FLUID
    a = np.array([2.0, -1.0])
    slope = 1000.0 * (np.array([0.0, -G]) - a)
    store.S[RHO, fluid] = 1000.0
    exact = 5000.0 + slope @ store.S[[X, Y]]
    store.S[P, fluid] = exact[fluid]
    store.S[AX, ghost], store.S[AY, ghost] = a
    model._load_ghosts()
    near = ghost & (store.S[P] != 0.0)
    assert near.sum() > 50
    assert store.S[P, near] == pytest.approx(exact[near], rel=1e-12)


def test_walls_stop_where_the_structure_begins():
    wall = {"name": "floor", "polyline": [(-0.3, 0.0), (0.3, 0.0)]}
    body = {"name": "plate", "rectangle": (-0.01, -0.04, 0.01, 0.1)}
    solid = {"model": "total-lagrangian", "dx": 0.01, "density": 1000.0, "youngs_modulus": 1e6, "bodies": [body]}
    water = [{"name": "water", "rectangle": (0.02, 0.0, 0.2, 0.1)}]
    model = begun(scene(water, [wall], solid=solid))
    position, kind = model.ghosts.position, model.ghosts.kind
    inside = (np.abs(position[:, 0]) < 0.0099) & (position[:, 1] > -0.04)
    assert inside.any()
    assert np.all(kind[inside] == STRUCTURE)


def test_corners_of_unlike_spacing_have_no_holes():
    """0.584 m is no multiple of 6 mm: fluid once left the tank along the corner's bisector."""
    wall = {"name": "tank", "polyline": [(0.0, 0.3), (0.0, 0.0), (0.584, 0.0), (0.584, 0.3)]}
    water = [{"name": "water", "rectangle": (0.0, 0.0, 0.146, 0.2)}]
    model = make_model(scene(water, [wall], dx=6e-3), False, 1)
    inside = np.linspace(0.0, model.c.support - 0.5 * model.c.dx, 40)
    for x in (0.584 + inside, -inside):
        gap = np.hypot(*(model.ghosts.position[:, None] - np.c_[x, -inside][None]).T).min(axis=1)
        assert gap.max() < 0.75 * model.c.dx


def test_structure_ghosts_follow_the_window_without_a_jump():
    """Cubic Hermite: a motion that is cubic in time is met exactly, in place and velocity."""
    t0, t1 = 0.3, 0.5
    x = lambda t: np.array([[1.0 + t - 2 * t**2 + 3 * t**3, t**3]])  # noqa: E731
    v = lambda t: np.array([[1.0 - 4 * t + 9 * t**2, 3 * t**2]])  # noqa: E731
    pose = np.zeros((1, 8))
    for s in (0.0, 0.25, 1.0):
        structure_pose(s, t1 - t0, x(t0), v(t0), x(t1), v(t1), np.zeros((1, 2)), pose)
        t = t0 + s * (t1 - t0)
        assert pose[:, :2] == pytest.approx(x(t), rel=1e-12)
        assert pose[:, 2:4] == pytest.approx(v(t), rel=1e-12)


def test_wall_motion_velocity_and_acceleration_are_derivatives():
    table = Motion(times=[0.0, 1.0, 2.0], translation=[(0.0, 0.0), (0.5, 0.1), (0.6, 0.4)], rotation=[0.0, 30.0, 90.0])
    place = np.array([[0.3, -0.2], [1.0, 2.0]])
    wall = WallMotion(table, place, place, np.array([[1.0, 0.0], [0.0, -1.0]]))
    t, e = 0.7, 1e-5
    pose = wall.pose(t)
    slope = (wall.pose(t + e) - wall.pose(t - e)) / (2 * e)
    assert pose[:, 2:4] == pytest.approx(slope[:, :2], abs=1e-8)
    assert pose[:, 4:6] == pytest.approx(slope[:, 2:4], abs=1e-6)
    assert np.all(wall.pose(3.0)[:, 2:6] == 0.0)  # held after its last time
    assert wall.pose(3.0)[:, 6:] == pytest.approx(np.array([[0.0, 1.0], [1.0, 0.0]]), abs=1e-12)  # turned by 90 degrees
    assert wall.pose(3.0)[:, :2] == pytest.approx(wall.pose(2.0)[:, :2])


def test_ghosts_behind_a_face_that_turns_show_the_face_s_velocity():
    """What turns with the drum as one has no stress: mirrored at the face, the fluid's velocity goes on as ω r."""
    spin, radius = 1.5, 0.1
    table = Motion(times=[0.0, 1.0], rotation=[0.0, math.degrees(spin)])
    wall = WallMotion(table, np.array([[0.13, 0.0]]), np.array([[radius, 0.0]]), np.array([[1.0, 0.0]]))
    pose = wall.pose(0.5)[0]
    assert math.hypot(*pose[2:4]) == pytest.approx(spin * radius)
    assert math.hypot(*pose[4:6]) == pytest.approx(spin**2 * radius)
    assert wall.speed(0.5) == pytest.approx(spin * 0.13)


def test_moving_walls_take_their_water_along():
    """Water that fills a box goes where the box goes."""
    motion = {"times": [0.0, 0.05, 0.4, 1.0], "translation": [(0.0, 0.0), (0.0, 0.0), (0.05, 0.0), (0.2, 0.0)]}
    corners = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1)]
    box = {"name": "box", "polyline": corners, "closed": True, "motion": motion}
    water = [{"name": "water", "rectangle": (0.0, 0.0, 0.1, 0.1)}]
    model = begun(scene(water, [box], gravity=(0.0, 0.0), sound_speed=5.0, alpha=0.5))
    run(model, 0.3, 10)
    x, _, u, *_ = WallMotion(Motion(**motion), *np.zeros((3, 1, 2))).pose(0.3)[0]
    assert u > 0.1
    assert fluid_rows(model, U)[0].mean() == pytest.approx(u, rel=0.05)
    assert fluid_rows(model, X)[0].mean() == pytest.approx(0.05 + x, abs=0.001)


@pytest.mark.parametrize("model_name", ["wcsph", "ctvf"])
def test_a_lone_drop_of_spray_does_not_creep_into_a_wall(model_name):
    wall = {"name": "wall", "polyline": [(0.0, 0.6), (0.0, 0.0), (0.3, 0.0)]}
    drop = [{"name": "drop", "rectangle": (0.005, 0.3, 0.015, 0.31), "velocity": (-0.5, 0.0)}]
    model = begun(scene(drop, [wall], sound_speed=20.0, model=model_name))
    assert model.fluid_count == 1
    for k in range(20):
        run(model, 0.01, 1, 0.01 * k)
        assert fluid_rows(model, X)[0][0] > -0.002


@pytest.mark.parametrize("dx", [0.0146, 0.012])
def test_many_neighbours_do_not_push_particles_into_walls(dx):
    """Found: 7 to 11 of them in the floor, for a ghost's push on one is as weak as the kernel is wide; so they got into
    the corners of rafts, whose draught was 0.3 dx off."""
    model = begun(load_scene("dam_break_wall", ["fluid.model=wcsph", "fluid.h_over_dx=2.0", f"fluid.dx={dx}"]))
    for k in range(30):
        run(model, 0.01, 1, 0.01 * k)
        assert model.probe_values()["leaked"] == 0.0


def bare_tank(walls, **fluid):
    """Water at rest between `walls`, 0.2 m wide and 0.15 m deep."""
    return scene([{"name": "water", "rectangle": (0.0, 0.0, 0.2, 0.15)}], walls, **fluid)


CORNERS = [(0.0, 0.3), (0.0, 0.0), (0.2, 0.0), (0.2, 0.3)]
SIDES = [{"name": name, "polyline": CORNERS[k : k + 2]} for k, name in enumerate(("left", "floor", "right"))]


def test_a_tank_of_three_walls_is_the_tank_of_one_polyline():
    """Same water to the byte; the floor bears the weight, the sides the hydrostatic push, nothing pulls along them."""
    probes = [
        {"name": f"{w['name']}_{axis}", "quantity": f"force-{axis}", "body": w["name"]} for w in SIDES for axis in "xy"
    ]
    three = begun(bare_tank(SIDES, probes=probes))
    one = begun(bare_tank([{"name": "tank", "polyline": CORNERS}]))
    run(three, 0.01)
    run(one, 0.01)
    assert fluid_rows(three, X, Y, P).tobytes() == fluid_rows(one, X, Y, P).tobytes()
    found = three.probe_values()
    weight, push = 1000.0 * G * 0.2 * 0.15, 0.5 * 1000.0 * G * 0.15**2
    assert found["floor_y"] == pytest.approx(-weight, rel=5e-3)
    assert found["left_x"] == pytest.approx(-push, rel=0.02)
    assert found["right_x"] == pytest.approx(push, rel=0.02)
    for along in ("left_y", "right_y", "floor_x"):
        assert found[along] == pytest.approx(0.0, abs=2e-3 * weight)
    total = three.force.sum(axis=0)
    three._mean_force[...] = three.force
    found = three.probe_values()
    assert sum(found[f"{w['name']}_x"] for w in SIDES) == pytest.approx(total[0], abs=1e-9 * weight)
    assert sum(found[f"{w['name']}_y"] for w in SIDES) == pytest.approx(total[1], rel=1e-12)


@pytest.mark.parametrize("motion", [None, {"times": [0.0, 1.0], "translation": [(0.0, 0.0), (0.0, 0.0)]}])
def test_a_wall_on_a_floor_that_runs_on_bears_the_whole_push(motion):
    """As the wall at the floor's end does, whose ghosts are the same; a piston, not joined to its floor, felt 3 % too
    little, and the floor that, sideways."""
    floor = [(0.0, 0.3), (0.0, 0.0), (0.4, 0.0)]
    standing = [{"name": "floor", "polyline": floor}, {"name": "right", "polyline": CORNERS[2:], "motion": motion}]
    probes = [
        {"name": f"{name}_{axis}", "quantity": f"force-{axis}", "body": name}
        for name in ("floor", "right")
        for axis in "xy"
    ]
    model = begun(bare_tank(standing, probes=probes))
    run(model, 0.01)
    found = model.probe_values()
    assert found["right_x"] == pytest.approx(-found["floor_x"], rel=1e-3)
    assert found["right_x"] == pytest.approx(0.5 * 1000.0 * G * 0.15**2, rel=0.02)
    assert found["right_y"] == pytest.approx(0.0, abs=2e-3 * 1000.0 * G * 0.2 * 0.15)


@pytest.mark.parametrize("angle", [0.0, 30.0, 180.0])
def test_a_push_along_a_walls_normal_is_that_walls_own_however_the_tank_is_turned(angle):
    motion = {"times": [0.0, 1.0], "rotation": [0.0, angle]}
    case = bare_tank([wall | {"motion": motion} for wall in SIDES])
    ghosts = lay_ghosts(case, 0.026)
    shares = WallForces(case, ghosts, 0.026)
    pose = GhostMotion(case, ghosts)
    pose.to(1.0, 0.0, 1.0, None)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    push = np.zeros_like(ghosts.position)
    corner = (ghosts.position[:, 0] < 0.0) & (ghosts.position[:, 1] < 0.0)
    assert set(ghosts.owner[corner]) == {0, 1}
    push[corner] = [-c, -s]  # the normal of the left wall
    assert shares.on(0, push, pose.pose[:, :2], pose.pose[:, 6:]) == pytest.approx(push.sum(axis=0), rel=1e-9)
    assert shares.on(1, push, pose.pose[:, :2], pose.pose[:, 6:]) == pytest.approx([0.0, 0.0], abs=1e-9)
    push[corner] = [s, -c]  # of the floor
    assert shares.on(0, push, pose.pose[:, :2], pose.pose[:, 6:]) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert shares.on(1, push, pose.pose[:, :2], pose.pose[:, 6:]) == pytest.approx(push.sum(axis=0), rel=1e-9)


@pytest.mark.parametrize("lean", [60.0, 90.0, 120.0])
def test_a_push_along_its_normal_on_ghosts_behind_a_leaning_wall_and_its_floor_is_the_walls(lean):
    c, s = np.cos(np.radians(lean)), np.sin(np.radians(lean))
    floor = {"name": "floor", "polyline": [(0.0, 0.0), (0.4, 0.0)]}
    wall = {"name": "wall", "polyline": [(0.2, 0.0), (0.2 + 0.2 * c, 0.2 * s)]}
    case = scene([{"name": "water", "rectangle": (0.0, 0.0, 0.1, 0.1)}], [floor, wall])
    ghosts = lay_ghosts(case, 0.026)
    arm = ghosts.position - [0.2, 0.0]
    past = (arm[:, 0] > 0.0) & (arm @ [c, s] < 0.0) & (np.hypot(*arm.T) < 0.026)
    assert set(ghosts.owner[past]) == ({0} if lean <= 90.0 else {0, 1})
    push = np.where(past[:, None], [s, -c], 0.0)
    shares = WallForces(case, ghosts, 0.026)
    assert shares.on(1, push, ghosts.position, ghosts.normal) == pytest.approx(push.sum(axis=0), rel=1e-9)
    assert shares.on(0, push, ghosts.position, ghosts.normal) == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("way", [(0.0, 0.0), (-0.013, 0.0), (0.0, 0.005)])
def test_a_piston_shares_the_ghosts_of_its_floor_that_it_stands_before_now(way):
    """Until it is lifted off."""
    floor = {"name": "floor", "polyline": [(0.0, 0.0), (0.4, 0.0)]}
    motion = {"times": [0.0, 1.0], "translation": [(0.0, 0.0), way]}
    piston = {"name": "piston", "polyline": [(0.2, 0.0), (0.2, 0.2)], "motion": motion}
    case = scene([{"name": "water", "rectangle": (0.0, 0.0, 0.1, 0.1)}], [floor, piston])
    ghosts = lay_ghosts(case, 0.026)
    pose = GhostMotion(case, ghosts)
    pose.to(1.0, 0.0, 1.0, None)
    place, normal = pose.pose[:, :2], pose.pose[:, 6:]
    arm = place - [0.2 + way[0], 0.0]
    push = np.where(((ghosts.owner == 0) & (np.hypot(*arm.T) < 0.026) & (arm[:, 0] > 0.01))[:, None], [1.0, -2.0], 0.0)
    assert push.any()
    shares = WallForces(case, ghosts, 0.026)
    sideways = [push[:, 0].sum(), 0.0] if way[1] == 0.0 else [0.0, 0.0]
    assert shares.on(1, push, place, normal) == pytest.approx(sideways, abs=1e-9)
    assert shares.on(0, push, place, normal) == pytest.approx(push.sum(axis=0) - sideways, abs=1e-9)


def test_a_lid_slides_up_to_the_corners_of_its_box():
    """Where a face that slides meets one that stands, the ghosts behind both stand."""
    box = [(0.0, 0.2), (0.0, 0.0), (0.2, 0.0), (0.2, 0.2)]
    lid = {"name": "lid", "polyline": [(0.2, 0.2), (0.0, 0.2)], "slip": "no", "surface_speed": -1.0}
    case = bare_tank([{"name": "box", "polyline": box, "slip": "no"}, lid], viscosity=1e-3)
    ghosts = lay_ghosts(case, 0.026)
    x, y = ghosts.position.T
    speed = GhostMotion(case, ghosts).pose[:, 2:4]
    above = (y > 0.2) & (x > 0.0) & (x < 0.2)
    assert speed[above] == pytest.approx(np.tile([1.0, 0.0], (above.sum(), 1)), abs=1e-12)
    assert np.any((y > 0.2) & (x < 0.0))
    assert not speed[~above].any()


def test_a_belt_of_several_walls_slides_as_one():
    ring = [(0.1 + 0.2 * np.cos(angle), 0.1 + 0.2 * np.sin(angle)) for angle in np.linspace(0.0, 2.0 * np.pi, 13)[:-1]]
    drum = {"name": "drum", "polyline": ring, "closed": True, "slip": "no", "surface_speed": 0.5}
    parts = [
        {"name": f"p{k}", "polyline": [ring[k], ring[(k + 1) % 12]], "slip": "no", "surface_speed": 0.5}
        for k in range(12)
    ]
    cases = [bare_tank(walls, viscosity=1e-3) for walls in ([drum], parts)]
    whole, split = (GhostMotion(case, lay_ghosts(case, 0.026)).pose for case in cases)
    assert np.array_equal(whole, split)


@pytest.mark.parametrize("thickness", [0.2, 0.012, 0.005])
def test_ghosts_of_a_structure_that_turns_show_the_velocity_of_its_face_to_what_sticks(thickness):
    """A shaft's ghosts stand inside its face and are slower, and drove water too slowly. A sheet of one row of ghosts
    shows its own along itself."""
    body = {"name": "shaft", "rectangle": (0.0, 0.0, 0.2, thickness)}
    solid = {"model": "rigid", "dx": 0.005, "density": 1000.0, "bodies": [body]}
    water = [{"name": "water", "rectangle": (0.0, -0.1, 0.2, 0.0)}]
    case = scene(water, [], solid=solid, dx=0.005, viscosity=1e-3)
    ghosts = lay_ghosts(case, 0.026)
    motion, spin, speed = GhostMotion(case, ghosts), 3.0, np.array([0.5, -0.2])
    turning = lambda x: speed + spin * np.c_[-x[:, 1], x[:, 0]]  # noqa: E731
    own = turning(ghosts.position)
    end = ghosts.position + 1e-9 * own
    motion.start(Kinematics(ghosts.position, own, 0.0 * own, own, 0.0 * own))
    motion.to(0.0, 1e-9, 1e-9, Kinematics(end, own, 0.0 * own, own, 0.0 * own))
    foot = ghosts.foot if thickness > 0.005 else np.c_[ghosts.foot[:, 0], ghosts.position[:, 1]]
    assert motion.pose[:, 2:4] == pytest.approx(turning(foot), abs=1e-7)
    assert np.all(motion.pose[:, 6:] == 0.0)
