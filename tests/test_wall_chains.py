"""Walls that meet: ghosts as of one polyline, each with one owner; and where they must not be joined."""

import itertools

import numpy as np
import pytest

from shared.contract import BadInput
from shared.geometry.particles import wall_particles
from shared.geometry.regions import distance_to
from shared.geometry.wall_chains import chains, segments_of
from shared.scene.reading import load_scene
from shared.scene.warnings import scene_warnings
from shared.schema.fluid import Wall
from tests.fluid_models import scene

DX, DEPTH = 0.04, 0.104
TANK = [(0.0, 1.0), (0.0, 0.0), (2.0, 0.0), (2.0, 1.0)]
SLOPE = [(0.0, 2.0), (0.0, 0.0), (1.0, 0.268), (1.0, 2.0)]
STEP = [(0.0, 1.0), (0.0, 0.4), (0.5, 0.4), (0.5, 0.0), (1.0, 0.0), (1.3, 1.0)]
BOX = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.72), (0.0, 0.72), (0.0, 0.0)]
THIN = [(0.0, 0.0), (0.0, 1.0), (0.12, 1.0), (0.12, 0.0), (0.0, 0.0)]
MOTION = {"times": [0.0, 1.0], "translation": [(0.0, 0.0), (0.1, 0.0)]}


def one_each(corners, **more) -> list[Wall]:
    """A wall for every segment."""
    return [Wall(name=f"w{k}", polyline=list(pair), **more) for k, pair in enumerate(itertools.pairwise(corners))]


def one_for_all(corners) -> Wall:
    closed = corners[0] == corners[-1]
    return Wall(name="all", polyline=corners[:-1] if closed else corners, closed=closed)


def in_order(points):
    return points[np.lexsort(np.round(points / DX * 1e6).T)]


def apart(points) -> float:
    """Least distance between two points."""
    return (np.hypot(*(points[:, None] - points[None]).T) + 9.0 * np.eye(len(points))).min()


@pytest.mark.parametrize("corners", [TANK, SLOPE, STEP, BOX, THIN])
def test_walls_that_meet_have_the_ghosts_of_one_polyline(corners):
    (whole,) = wall_particles([one_for_all(corners)], DX, DEPTH)
    walls = one_each(corners)
    parts = wall_particles(walls, DX, DEPTH)
    assert np.array_equal(np.concatenate([p.position for p in parts]), whole.position)
    assert np.array_equal(np.concatenate([p.volume for p in parts]), whole.volume)
    backwards = wall_particles(walls[::-1], DX, DEPTH)
    position = np.concatenate([p.position for p in backwards])
    assert in_order(position) == pytest.approx(in_order(whole.position), abs=1e-6 * DX)


@pytest.mark.parametrize("corners", [TANK, SLOPE, STEP, BOX, THIN])
def test_a_ghost_belongs_to_the_wall_whose_face_is_nearest(corners):
    walls = one_each(corners)
    for wall, part in zip(walls, wall_particles(walls, DX, DEPTH), strict=True):
        nearest = distance_to(np.concatenate([segments_of(other) for other in walls]), part.position)
        assert distance_to(segments_of(wall), part.position) == pytest.approx(nearest, abs=0.25 * DX)


def test_ends_that_a_rounded_number_keeps_apart_meet():
    walls = [Wall(name="floor", polyline=[(0, 0), (1, 0)]), Wall(name="side", polyline=[(1 + 0.05 * DX, 0), (1, 1)])]
    assert len(chains(walls, DX)) == 1
    assert len(chains(walls, 0.1 * DX)) == 2


def test_a_wall_that_ends_where_it_starts_is_closed():
    (got,) = wall_particles([Wall(name="box", polyline=BOX)], DX, DEPTH)
    assert np.array_equal(got.position, wall_particles([one_for_all(BOX)], DX, DEPTH)[0].position)


def test_walls_of_unlike_motions_are_not_joined():
    floor, side = one_each(TANK[1:])
    piston = side.model_copy(update={"motion": Wall(name="x", polyline=TANK[:2], motion=MOTION).motion})
    alone = [wall_particles([wall], DX, DEPTH)[0].position for wall in (floor, piston)]
    for part, same in zip(wall_particles([floor, piston], DX, DEPTH), alone, strict=True):
        assert np.array_equal(part.position, same)
    both = one_each(TANK[1:], motion=MOTION)
    assert len(chains(both, DX)) == 1


def test_walls_walked_against_each_other_are_not_joined():
    walls = [Wall(name="a", polyline=[(0, 0), (1, 0)]), Wall(name="b", polyline=[(1, 1), (1, 0)])]
    assert len(chains(walls, DX)) == 2


def test_three_walls_in_a_point_end_there_and_the_scene_says_so():
    ends = [[(0, 0), (1, 0)], [(1, 0), (2, 0)], [(1, 0), (1, 1)]]
    walls = [Wall(name=name, polyline=line) for name, line in zip("abc", ends, strict=True)]
    for wall, part in zip(walls, wall_particles(walls, DX, DEPTH), strict=True):
        assert np.array_equal(part.position, wall_particles([wall], DX, DEPTH)[0].position)
    water = [{"name": "water", "rectangle": (0.0, 0.0, 1.0, 0.5)}]
    said = scene_warnings(scene(water, [wall.model_dump() for wall in walls], dx=DX))
    assert any("'a', 'b', 'c' meet in one point" in warning for warning in said)
    assert not any("meet" in warning for warning in scene_warnings(scene(water, [], dx=DX)))


@pytest.mark.parametrize("lean", [35, 60, 75, 90, 105, 120, 145])
def test_a_baffle_on_a_floor_neither_overlaps_it_nor_gapes(lean):
    """A slab with both faces wetted stands on the floor at any angle: its ghosts fill it down to the floor."""
    along = np.array([1.0 / np.tan(np.radians(lean)), 1.0])
    left, right = np.array([1.0, 0.0]), np.array([1.0 + 5 * DX / np.sin(np.radians(lean)), 0.0])
    slab = Wall(name="slab", polyline=[tuple(p) for p in (left, left + 0.5 * along, right + 0.5 * along, right)])
    floor = Wall(name="floor", polyline=[(0, 0), (3, 0)])
    under, inside = (part.position for part in wall_particles([floor, slab], DX, DEPTH))
    assert np.array_equal(under, wall_particles([floor], DX, DEPTH)[0].position)
    assert inside[:, 1].min() > 0.0
    assert apart(np.concatenate([under, inside])) >= 0.49 * DX
    share, up = np.meshgrid(np.linspace(0.1, 0.9, 9), np.linspace(0.3 * DX, 3 * DX, 9))
    places = left + share[..., None] * (right - left) + up[..., None] * along
    ghosts = np.concatenate([under, inside])
    gaps = np.hypot(*(places.reshape(-1, 1, 2) - ghosts[None]).T)
    assert gaps.min(axis=0).max() < 1.1 * DX


@pytest.mark.parametrize("gap", [2.0, 2.5, 3.0, 4.5])
@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_two_tanks_side_by_side_share_what_is_between_them(gap, lean):
    """Found: layers of either stood in the water of the other, which left at 6 m/s."""
    here = [(-1.0, 1.0), (-1.0, 0.0), (0.0, 0.0), (lean, 1.0)]
    there = [(gap * DX + lean, 1.0), (gap * DX, 0.0), (1.0, 0.0), (1.0, 1.0)]
    laid = wall_particles([Wall(name="a", polyline=here), Wall(name="b", polyline=there)], DX, DEPTH)
    points = np.concatenate([particles.position for particles in laid])
    above = points[(points[:, 1] > 0.0) & (points[:, 1] < 0.9) & (np.abs(points[:, 0]) < 0.9)]
    x = above[:, 0] - lean * above[:, 1]
    assert x.min() > 0.0
    assert x.max() < gap * DX
    assert apart(points) > 0.4 * DX


BACK_TO_BACK = """\
schema = 1
title = "A wall between two levels"
end_time = 0.1
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 0.01
bodies = [{ name = "a", rectangle = [0.0, 0.0, 0.3, 0.3] }, { name = "b", rectangle = [RIGHT, 0.0, 0.6, 0.1] }]
[[walls]]
name = "left"
polyline = [[0.0, 0.6], [0.0, 0.0], [0.3, 0.0], [0.3, 0.5]]
[[walls]]
name = "right"
polyline = [[RIGHT, 0.5], [RIGHT, 0.0], [0.6, 0.0], [0.6, 0.6]]
"""


@pytest.mark.parametrize(("right", "thick"), [(0.32, True), (0.31, False), (0.305, False)])
def test_a_wall_that_its_ghosts_cannot_hold_two_waters_apart_by_is_refused(tmp_path, right, thick):
    """Found: half a dx thick it bore 0.2 N/m of 392, and the levels ran together."""
    (tmp_path / "case.toml").write_text(BACK_TO_BACK.replace("RIGHT", str(right)))
    if thick:
        assert not [text for text in scene_warnings(load_scene(tmp_path / "case.toml")) if "thick" in text]
        return
    with pytest.raises(BadInput, match=r"walls\[0\]: the wall of 'left' and 'right' is .* with water on both sides"):
        load_scene(tmp_path / "case.toml")


def test_a_thin_wall_with_a_dry_side_is_warned_of_and_a_slot_or_a_spike_is_not(tmp_path):
    dry = BACK_TO_BACK.replace(', { name = "b", rectangle = [RIGHT, 0.0, 0.6, 0.1] }', "")
    slot = dry.replace("RIGHT, 0.0", "0.55, 0.0").replace("RIGHT", "0.55").replace("0.6, ", "0.56, ")
    spike = dry.replace("[0.3, 0.0], [0.3, 0.5]", "[0.3, 0.0], [0.32, 0.1], [0.34, 0.0]").replace("RIGHT", "0.5")
    found = []
    for text in (dry.replace("RIGHT", "0.31"), slot, spike):
        (tmp_path / "case.toml").write_text(text)
        found.append([said for said in scene_warnings(load_scene(tmp_path / "case.toml")) if "thick near" in said])
    assert [len(said) for said in found] == [1, 0, 0]


@pytest.mark.parametrize("side", [0.14, 0.15, 0.16])
def test_the_layers_of_a_corner_that_stands_into_the_water_leave_no_hole_between_them(side):
    """Of spacings that differ from their depths, particles on the bisector were nearer to the other face, by a hair,
    and left out of both: water at rest over a ridge of 45 degrees was stirred to 1.8 m/s and got in."""
    dx = 0.0125
    ridge = Wall(name="ridge", polyline=[(0.0, 0.0), (side, side), (2.0 * side, 0.0)])
    (layers,) = wall_particles([ridge], dx, 4.0 * dx)
    below = np.c_[np.full(50, side), side - np.linspace(0.75, 3.5, 50) * dx]
    gap = np.hypot(*(layers.position[:, None] - below[None]).transpose(2, 0, 1)).min(axis=0)
    assert gap.max() < 0.75 * dx
