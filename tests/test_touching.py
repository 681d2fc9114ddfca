"""Bodies that get into walls or into each other are named."""

from __future__ import annotations

import numpy as np
import pytest

from coupler.touching import Touching
from fluid_solver.models import make_model
from shared.contract import SolverFailed
from tests.scenes import scene_of

DISCS = """\
schema = 1
title = "Two discs in a tank that is carried along"
end_time = 2.0
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 0.01
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.1, 0.4] }]
[[walls]]
name = "tank"
polyline = [[0.0, 0.5], [0.0, 0.0], [0.4, 0.0], [0.4, 0.5]]
motion = { times = [0.0, 1.0, 2.0], translation = [[0.0, 0.0], [0.0, 1.0], [0.0, 2.0]], rotation = [0.0, 90.0, 90.0] }
[solid]
model = "spring"
dx = 0.01
density = 2000.0
bodies = [
    { name = "one", circle = { centre = [0.16, 0.2], radius = 0.05 } },
    { name = "other", circle = { centre = [0.26, 0.2], radius = 0.05 } },
]
"""


def test_a_body_that_gets_into_a_wall_or_another_body_is_named(tmp_path):
    """A disc on the floor, and beside another that it touches, is in its place; a spacing farther it is not."""
    scene = scene_of(DISCS, tmp_path, ["solid.bodies.one.free=true", "solid.bodies.other.free=true"])
    described = make_model(scene, True, 1).describe()
    touching, one = Touching(scene, described), described.body == 0

    def moved(*way: float) -> np.ndarray:
        return described.position + np.where(one[:, None], way, 0.0)

    for way in ((0.0, 0.0), (0.0, -0.15), (-0.11, 0.0), (0.0, 0.4), (-0.11, 0.4), (0.003, 0.0)):
        touching.check(0.0, moved(*way))
    with pytest.raises(SolverFailed, match=r"t = 0 s: 'one' has got into wall 'tank' near \(0.1.*, -0.01\) m"):
        touching.check(0.0, moved(0.0, -0.165))
    with pytest.raises(SolverFailed, match="'one' has got into 'other'"):
        touching.check(0.0, moved(0.02, 0.005))
    at_rest = described.position @ [[0.0, 1.0], [-1.0, 0.0]] + [0.0, 1.0]  # in the tank, risen and turned
    touching.check(1.0, at_rest)
    touching.check(1.0, at_rest + [0.15, 0.0])
    with pytest.raises(SolverFailed, match="wall 'tank'"):
        touching.check(1.0, at_rest + [0.165, 0.0])
