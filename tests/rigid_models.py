"""A rigid block as a model, for the tests of models rigid and spring."""

from __future__ import annotations

from solid_solver.models import make_model
from tests.solid_scenes import solid_scene

BLOCK = {"name": "block", "rectangle": [0.0, 0.0, 1.0, 0.5]}
MASS, INERTIA = 500.0, 500.0 * (1.0**2 + 0.5**2) / 12.0
CENTRE_Y = {"name": "y", "body": "block", "point": [0.5, 0.25], "quantity": "displacement-y"}
CORNER_X = {"name": "x", "body": "block", "point": [1.0, 0.5], "quantity": "displacement-x"}


def model_of(kind, **solid):
    keys = {"model": kind, "youngs_modulus": None, "bodies": [BLOCK], "dx": 0.1}
    return make_model(solid_scene(**(keys | solid)), False, 1)
