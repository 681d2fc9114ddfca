"""Particles and regions: exact volumes, exact lattices, boundaries that bound."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.geometry.particles import fill, ghosts, wall_particles
from shared.geometry.regions import area, contains, distance_to, faces, outline
from shared.schema.fluid import Wall
from shared.schema.geometry import Shape

PLATE = Shape(rectangle=(0.0, 0.0, 0.2, 0.012))


def rounded(points, unit):
    return {tuple(p) for p in np.round(np.asarray(points) / unit * 4).astype(int)}


def test_cells_are_centred_and_carry_the_whole_volume():
    p = fill(PLATE, 1.1e-3)
    assert p.spacing == pytest.approx((0.2 / 182, 0.012 / 11))
    assert p.volume.sum() == pytest.approx(0.2 * 0.012, rel=1e-13)
    assert p.position[:, 1].min() == pytest.approx(p.spacing[1] / 2)
    assert p.position[:, 1].max() == pytest.approx(0.012 - p.spacing[1] / 2)
    assert p.position[1, 0] > p.position[0, 0]
    assert p.position[1, 1] == p.position[0, 1]


def test_rotation_turns_the_lattice_rigidly():
    turned = PLATE.model_copy(
        update={"rotate": Shape(rectangle=(0, 0, 1, 1), rotate={"angle": 30, "about": (1, 2)}).rotate}
    )
    a, b = fill(PLATE, 1e-3), fill(turned, 1e-3)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    about = np.array([1.0, 2.0])
    assert len(a.position) == len(b.position)
    assert b.position == pytest.approx((a.position - about) @ np.array([[c, s], [-s, c]]) + about, abs=1e-14)
    assert b.axes == pytest.approx(np.array([[c, s], [-s, c]]))
    assert faces(turned)["top"][0] == pytest.approx((faces(PLATE)["top"][0] - about) @ b.axes + about)


def test_faces_have_the_body_on_their_left():
    for name, outward in {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}.items():
        ((start, end),) = faces(PLATE)[name]
        along = end - start
        assert np.array([along[1], -along[0]]) / np.hypot(*along) == pytest.approx(outward)


def test_polygon_edges_keep_their_numbers_when_written_clockwise():
    corners = [(0, 0), (0, 1), (1, 0)]
    triangle = Shape(polygon=corners)
    for i in range(3):
        edge = faces(triangle)[f"edge-{i}"][0]
        assert {tuple(edge[0]), tuple(edge[1])} == {corners[i], corners[(i + 1) % 3]}
    assert area(triangle) == pytest.approx(0.5)
    assert fill(triangle, 0.01).volume.sum() == pytest.approx(0.5, rel=0.02)


NESTED = Shape(
    difference=[
        {
            "union": [
                {"rectangle": (0, 0, 1, 1)},
                {"rectangle": (1, 0.25, 2, 1)},
                {"rectangle": (0.5, 0.5, 1.5, 1)},
            ]
        },
        {"circle": {"centre": (0.5, 0.5), "radius": 0.25}},
        {"rectangle": (1.5, 0.5, 2.5, 0.75), "rotate": {"angle": 90, "about": (1.75, 0.625)}},
    ],
    rotate={"angle": 25, "about": (0.3, 0.1)},
)
NESTED_AREA = 1 + 0.75 - np.pi * 0.0625 - 0.25 * 0.625


def test_nested_shapes_have_one_closed_outline():
    segments = outline(NESTED)
    assert area(NESTED) == pytest.approx(NESTED_AREA, rel=2e-4)
    starts, ends = rounded(segments[:, 0], 1e-6), rounded(segments[:, 1], 1e-6)
    assert starts == ends
    assert fill(NESTED, 0.01).volume.sum() == pytest.approx(NESTED_AREA, rel=2e-3)


def test_outline_separates_inside_from_outside():
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 3, (4000, 2))
    near = distance_to(outline(NESTED), points) < 1e-3
    steps = points + 1e-3 * np.array([0.6, 0.8])
    changed = contains(NESTED, points) != contains(NESTED, steps)
    assert changed.any()
    assert near[changed].all()


def test_touching_shapes_share_no_point_and_leave_none_out():
    parts = [(0, 0, 1, 1), (1, 0, 2, 1), (0, 1, 2, 2)]
    x, y = np.meshgrid(np.arange(0, 2, 0.25), np.arange(0, 2, 0.25))
    points = np.c_[x.ravel(), y.ravel()]
    inside = np.array([contains(Shape(rectangle=r), points) for r in parts])
    assert np.all(inside.sum(axis=0) == 1)
    square = [contains(Shape(polygon=[(r[0], r[1]), (r[2], r[1]), (r[2], r[3]), (r[0], r[3])]), points) for r in parts]
    assert np.array_equal(inside, square)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(0, 6), st.integers(0, 6), st.integers(1, 5), st.integers(1, 5)),
        min_size=1,
        max_size=4,
    ),
    st.integers(1, 3),
)
def test_union_of_lattice_rectangles_counts_cells(boxes, refine):
    """Rectangles on a unit lattice: outline area, particle volume and count of covered cells agree."""
    shape = Shape(union=[{"rectangle": (x, y, x + w, y + h)} for x, y, w, h in boxes])
    cells = {(i, j) for x, y, w, h in boxes for i in range(x, x + w) for j in range(y, y + h)}
    assert area(shape) == pytest.approx(len(cells))
    assert fill(shape, 1 / refine).volume.sum() == pytest.approx(len(cells))


def test_ghosts_lie_near_wetted_faces_only():
    bar = Shape(rectangle=(0, 0, 1, 0.5))
    g = ghosts(bar, 0.05, 0.1, ["left", "right", "bottom"])
    assert g.position[:, 1].min() > 0.4
    assert len(g.position) == 2 * 20
    assert len(ghosts(bar, 0.05, 0.3, []).position) == len(fill(bar, 0.05).position)


def test_distance_is_to_the_segment_not_to_its_line():
    segment = np.array([[[0.0, 0.0], [1.0, 0.0]]])
    assert distance_to(segment, np.array([[0.5, -2.0], [4.0, 4.0], [-3.0, 4.0]])) == pytest.approx([2, 5, 5])


def test_tank_gets_the_global_lattice():
    dx, n = 0.05, 3
    wall = Wall(name="tank", polyline=[(0, 1), (0, 0), (2, 0), (2, 1)])
    (got,) = wall_particles([wall], dx, n * dx)
    i, j = np.meshgrid(np.arange(-n, 40 + n), np.arange(-n, 20))
    outside = (i < 0) | (i >= 40) | (j < 0)
    expected = np.c_[i[outside] + 0.5, j[outside] + 0.5] * dx
    assert len(got.position) == len(expected)
    assert rounded(got.position, dx) == rounded(expected, dx)
    assert got.volume.sum() == pytest.approx(len(expected) * dx**2)


@pytest.mark.parametrize("width", [0.1, 0.2, 1.0])
def test_baffle_is_filled_once(width):
    """A box with the fluid outside: ghosts stay within it and none stands on another, also where layers
    meet.
    """
    dx = 0.05
    box = Wall(name="box", polyline=[(0, 0), (0, 1), (width, 1), (width, 0)], closed=True)
    (got,) = wall_particles([box], dx, 4 * dx)
    assert contains(Shape(rectangle=(0, 0, width, 1)), got.position).all()
    assert len(rounded(got.position, dx)) == len(got.position)
    hollow = max(0.0, width - 8 * dx) * (1 - 8 * dx)
    assert got.volume.sum() == pytest.approx(width - hollow)


@pytest.mark.parametrize("turn", [-150, -100, -60, -20, 20, 60, 100, 150])
def test_corners_at_any_angle_neither_overlap_nor_gape(turn):
    dx, depth = 0.02, 0.1
    end = np.array([1 + np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    wall = Wall(name="bend", polyline=[(0, 0), (1, 0), tuple(end)])
    p = wall_particles([wall], dx, depth)[0].position
    apart = np.sqrt(((p[:, None] - p[None]) ** 2).sum(-1)) + np.eye(len(p))
    assert apart.min() >= 0.5 * dx
    rng = np.random.default_rng(3)
    sample = np.array([1, 0]) + rng.uniform(-0.3, 0.3, (3000, 2))
    path = np.array([[[0, 0], [1, 0]], [[1, 0], end]])
    normal_a, normal_b = np.array([0, -1]), np.array([end[1], -(end[0] - 1)])
    right_a, right_b = (sample - [1, 0]) @ normal_a > 0, (sample - [1, 0]) @ normal_b > 0
    behind = (right_a | right_b) if turn > 0 else (right_a & right_b)
    distance = distance_to(path, sample)
    deep = behind & (distance < depth - 0.7 * dx) & (distance > 0.7 * dx)
    gap = np.sqrt(((sample[deep][:, None] - p[None]) ** 2).sum(-1)).min(axis=1)
    assert gap.max() < 1.45 * dx


def test_open_ends_end_with_the_polyline():
    p = wall_particles([Wall(name="floor", polyline=[(0, 0), (1, 0)])], 0.1, 0.3)[0].position
    assert p[:, 0].min() == pytest.approx(0.05)
    assert p[:, 0].max() == pytest.approx(0.95)
    assert p[:, 1].max() == pytest.approx(-0.05)
    assert len(p) == 30
