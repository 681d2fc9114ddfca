"""The map H: linear fields exactly, total force, moment and virtual work exactly."""

from __future__ import annotations

import numpy as np
import pytest

from coupler.mapping import build_mapping
from shared.contract import BadInput, Description, Kinematics, Loads


def lattice(nx, ny, width=0.2, height=0.05):
    x, y = (np.arange(nx) + 0.5) * width / nx, (np.arange(ny) + 0.5) * height / ny
    return np.array([[a, b] for b in y for a in x])


def described(position, spacing, role="structure", body=None):
    count = len(position)
    body = np.zeros(count, dtype=np.int64) if body is None else body
    return Description(role, role, "test", 1.0, spacing, position, np.full(count, spacing**2), body)


@pytest.fixture(params=[(40, 10), (37, 9), (80, 20), (16, 4)])
def pair(request):
    """A structure at 40 × 10 or otherwise, and ghosts at 40 × 10."""
    ghosts = lattice(40, 10)
    points = lattice(*request.param)
    return described(points, 0.2 / request.param[0]), described(ghosts, 0.005, "fluid")


def test_rigid_and_linear_motion_is_exact(pair):
    structure, fluid = pair
    mapping = build_mapping(structure, fluid)
    move = np.array([[0.3, -0.7], [0.9, 0.2]])
    still = Kinematics.at_rest(structure.position[mapping.selection] @ move + [0.1, 0.2])
    np.testing.assert_allclose(mapping.motion(still).position, fluid.position @ move + [0.1, 0.2], atol=1e-13)


def test_force_moment_and_work_are_kept(pair):
    structure, fluid = pair
    mapping = build_mapping(structure, fluid)
    rng = np.random.default_rng(0)
    force = rng.normal(size=fluid.position.shape)
    still = Kinematics.at_rest(structure.position[mapping.selection])
    on_points = mapping.loads(Loads(np.ones(len(force)), force), still, Kinematics.at_rest(fluid.position))
    np.testing.assert_allclose(on_points.force.sum(axis=0), force.sum(axis=0), atol=1e-12)
    place = structure.position[mapping.selection]
    torque = [
        np.sum(x[:, 0] * f[:, 1] - x[:, 1] * f[:, 0]) for x, f in ((place, on_points.force), (fluid.position, force))
    ]
    assert torque[0] == pytest.approx(torque[1], abs=1e-12)
    motion = rng.normal(size=place.shape)
    moved = mapping.motion(Kinematics.at_rest(motion)).position
    assert np.sum(on_points.force * motion) == pytest.approx(np.sum(force * moved), rel=1e-12)
    np.testing.assert_allclose(on_points.pressure, 1.0, rtol=1e-12)


def test_coinciding_points_give_the_identity():
    points = lattice(20, 5)
    mapping = build_mapping(described(points, 0.01), described(points.copy(), 0.01, "fluid"))
    assert (mapping.matrix.toarray() == np.eye(100)).all()


def test_only_points_of_the_own_body_serve():
    points = np.concatenate([lattice(10, 4), lattice(10, 4) + [0.2, 0.0]])
    body = np.repeat([0, 1], 40)
    mapping = build_mapping(described(points, 0.02, body=body), described(points * 0.99, 0.02, "fluid", body))
    matrix = mapping.matrix.tocoo()
    assert (body[matrix.row] == body[mapping.selection][matrix.col]).all()


def test_single_row_of_points_is_refused():
    with pytest.raises(BadInput, match="on one line"):
        build_mapping(described(lattice(40, 1), 0.005), described(lattice(40, 4), 0.005, "fluid"))


@pytest.mark.parametrize("fluid", [(40, 4), (20, 2), (80, 8), (40, 1)])
def test_water_on_both_sides_of_a_thin_plate_squeezes_it_and_water_on_one_side_pushes_it(fluid):
    """Each side's ghosts load the points below that side: a squeeze is not mistaken for nothing, nor for a push."""
    structure, ghosts = described(lattice(40, 4), 0.005), lattice(*fluid)
    mapping = build_mapping(structure, described(ghosts, 0.2 / fluid[0], "fluid"))
    place = structure.position[mapping.selection]
    upper = place[:, 1] > 0.025
    below, above = np.isclose(ghosts[:, 1], ghosts[:, 1].min()), np.isclose(ghosts[:, 1], ghosts[:, 1].max())
    places = Kinematics.at_rest(place), Kinematics.at_rest(ghosts)
    loads = Loads(np.ones(len(ghosts)), np.where(above[:, None], [0.0, -1.0], 0.0))
    push = mapping.loads(loads, *places).force[:, 1]
    assert push.sum() == pytest.approx(-above.sum(), rel=1e-12)
    if fluid[1] > 1:
        squeeze = (below[:, None] * np.array([0.0, 1.0])) - (above[:, None] * np.array([0.0, 1.0]))
        force = mapping.loads(Loads(np.ones(len(ghosts)), squeeze), *places).force[:, 1]
        assert force.sum() == pytest.approx(0.0, abs=1e-12 * above.sum())
        moment = (ghosts[:, 1] * squeeze[:, 1]).sum()
        assert (force * place[:, 1]).sum() == pytest.approx(moment, rel=1e-11)
        assert force[upper].sum() < -0.9 * above.sum()
