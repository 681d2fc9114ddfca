"""The quadratic fit and the values that it gives at material points."""

import numpy as np
import pytest

from shared.contract import BadInput
from solid_solver.bodies import lattice_bodies
from solid_solver.loads import traction_forces
from tests.solid_scenes import beam_scene, solid_scene

SHAPES = {
    "square": {"rectangle": [0.0, 0.0, 1.0, 1.0]},
    "upright": {"rectangle": [0.0, 0.0, 0.43, 1.0]},
    "turned": {"rectangle": [0.0, 0.0, 1.0, 0.5], "rotate": {"angle": 27.0, "about": [0.2, 0.1]}},
    "disc": {"circle": {"centre": [0.3, 0.2], "radius": 0.6}},
    "triangle": {"polygon": [[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]]},
    "ring": {
        "difference": [
            {"circle": {"centre": [0.0, 0.0], "radius": 0.7}},
            {"circle": {"centre": [0.0, 0.0], "radius": 0.3}},
        ]
    },
}


def body_of(shape, **solid):
    return lattice_bodies(solid_scene(bodies=[{"name": "block", "free": True, **shape}], **solid))[0]


def quadratic(x):
    return 0.3 + 2.0 * x[:, 0] - x[:, 1] + 0.7 * x[:, 0] ** 2 - 1.1 * x[:, 0] * x[:, 1] + 0.4 * x[:, 1] ** 2


def fitted(body, f):
    """Derivatives (n, 5) along the lattice's own axes of a field given at the particles."""
    number = {tuple(i): k for k, i in enumerate(body.index)}
    result = np.zeros((len(f), 5))
    for a, i in enumerate(body.index):
        for k, o in enumerate(body.fit.offset):
            b = number.get(tuple(i + o))
            if b is not None:
                result[a] += body.fit.coefficient[a, k] * f[b]
            else:
                assert not body.fit.coefficient[a, k].any()
    return result * body.scale


@pytest.mark.parametrize("name", SHAPES)
def test_derivatives_of_a_quadratic_are_exact_up_to_the_faces(name):
    body = body_of(SHAPES[name])
    x = body.position
    gradient = np.stack([2.0 + 1.4 * x[:, 0] - 1.1 * x[:, 1], -1.0 - 1.1 * x[:, 0] + 0.8 * x[:, 1]], axis=1)
    hessian = np.array([[1.4, -1.1], [-1.1, 0.8]])
    own = body.axes @ hessian @ body.axes.T
    found = fitted(body, quadratic(x))
    np.testing.assert_allclose(found[:, :2], gradient @ body.axes.T, atol=1e-10)
    np.testing.assert_allclose(found[:, 2:], np.tile([own[0, 0], own[0, 1], own[1, 1]], (len(x), 1)), atol=1e-8)


@pytest.mark.parametrize("name", SHAPES)
def test_points_take_the_value_of_a_quadratic_on_faces_and_inside(name):
    body = body_of(SHAPES[name])
    points = np.concatenate([body.position[:5] + 0.013, body.position[-3:] - [0.05, 0.02]])
    row, column, weight = body.point_weights(points)
    found = np.zeros(len(points))
    np.add.at(found, row, weight * quadratic(body.position)[column])
    np.testing.assert_allclose(found, quadratic(points), atol=1e-10)


def test_clamped_points_hold_the_field_at_zero_on_the_face():
    body = lattice_bodies(beam_scene(6))[0]
    x = body.position
    f = x[:, 0] * (0.2 - x[:, 0])  # zero on both clamped faces
    found = fitted(body, f)
    np.testing.assert_allclose(found[:, 0], 0.2 - 2.0 * x[:, 0], atol=1e-10)
    np.testing.assert_allclose(found[:, 2], -2.0, atol=1e-6)


@pytest.mark.parametrize("traction", [(0.0, -3.0), (2.0, 0.0)])
@pytest.mark.parametrize("face", ["top", "left"])
def test_traction_keeps_total_force_and_moment_shear_included(face, traction):
    body = body_of(SHAPES["turned"])
    force = traction_forces(body, face, traction, len(body.position))
    length, start, end = {"top": (1.0, (1.0, 0.5), (0.0, 0.5)), "left": (0.5, (0.0, 0.5), (0.0, 0.0))}[face]
    middle = 0.5 * (np.array(start) + np.array(end))
    angle = np.deg2rad(27.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    centre = turn @ (middle - [0.2, 0.1]) + [0.2, 0.1]
    np.testing.assert_allclose(force.sum(axis=0), np.array(traction) * length, atol=1e-12)
    moment = np.sum(body.position[:, 0] * force[:, 1] - body.position[:, 1] * force[:, 0])
    wanted = length * (centre[0] * traction[1] - centre[1] * traction[0])
    assert moment == pytest.approx(wanted, abs=1e-12)


def test_two_particles_across_are_refused_with_the_way_out():
    with pytest.raises(BadInput, match="three or more particles across"):
        lattice_bodies(beam_scene(2))
