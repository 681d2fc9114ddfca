"""Models of the updated-Lagrangian solid off their lattice, and access to their state, for its tests."""

from __future__ import annotations

import numpy as np

from solid_solver.models import make_model
from solid_solver.updated_fields import AX, AY, G00, G11, OWN, RHO, SXX, U, X, Y
from tests.solid_scenes import solid_scene

DX = 0.1
H = 1.3 * DX
DT = 1.0e-9  # s, a step that moves nothing


def jittered(jitter=0.15, **solid):
    """A ctvf model of a square block whose particles are off the lattice by up to `jitter` spacings."""
    keys = {"model": "ctvf", "gradient": "linear", "youngs_modulus": 1.0, "alpha": 0.0, "shifting": False}
    scene = solid_scene(**(keys | solid))
    model, dx = make_model(scene, False, 1), scene.solid.dx
    model._S[X : Y + 1, model._slot] += jitter * dx * np.random.default_rng(5).uniform(-1.0, 1.0, (2, len(model._slot)))
    model._stepper.list_pairs(model._S[X : Y + 1])
    return model


def put(model, row, values):
    """Set rows of the state from `row` on, (k, n) in published order."""
    model._S[row : row + len(values), model._slot] = values


def get(model, first, last):
    return model._S[first : last + 1, model._slot]


def power_of_stresses(model, curvature, rng):
    """Σ F·u, and −Σ V (σ:∇u + Q:∇²u), for random velocities and random stresses; `curvature`: rows of Q or Z.

    Also the stress (3, n) as xx, xy, yy.
    """
    count = len(model._slot)
    u, place = rng.standard_normal((2, count)), get(model, X, Y)
    put(model, U, u)
    model._at_once(DT)
    gradient, second = get(model, G00, G11), get(model, OWN, OWN + curvature - 1) / DT
    s, q = rng.standard_normal((4, count)), 0.1 * rng.standard_normal((curvature, count))
    put(model, X, place)
    put(model, SXX, s)
    put(model, OWN, q)
    put(model, RHO, np.full((1, count), 1100.0))
    model._at_once(0.0)
    _, c_squared, density, _ = model._moduli()
    pressure = c_squared * (1100.0 - density)
    power = (s[0] - pressure) * gradient[0] + s[1] * (gradient[1] + gradient[2]) + (s[2] - pressure) * gradient[3]
    force = model._mass * get(model, AX, AY)
    return np.sum(force * u), power, q, second, force, s[:3] - pressure * np.array([[1.0], [0.0], [1.0]])
