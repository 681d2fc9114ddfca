"""The state in which a body starts: velocity (uniform, spinning, in a bending mode) and a uniform stretch."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from shared.elasticity import bulk_modulus
from shared.geometry.regions import SIDES, own_box
from shared.geometry.segments import right_of
from shared.schema.solid import Solid, SolidBody


def cantilever_root(mode: int) -> float:
    """βL of a thin cantilever's bending `mode` 1, 2, …: the roots of cos βL cosh βL = −1."""
    return brentq(lambda x: math.cos(x) + 1.0 / math.cosh(x), (mode - 1) * math.pi, mode * math.pi, xtol=1e-14)


def cantilever_mode(mode: int, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """F(x)/F(L) and L F'(x)/F(L) of a thin cantilever's mode at `share` = x/L, 0 at the clamp.

    F = (cos βL + cosh βL)(cosh βx − cos βx) + (sin βL − sinh βL)(sinh βx − sin βx) (Landau & Lifshitz, Theory of
    Elasticity, §25), as in Gray, Monaghan & Swift (2001).
    """
    root = cantilever_root(mode)
    a, b = math.cos(root) + math.cosh(root), math.sin(root) - math.sinh(root)

    def shape(x):
        return a * (np.cosh(x) - np.cos(x)) + b * (np.sinh(x) - np.sin(x))

    def slope(x):
        return a * (np.sinh(x) + np.sin(x)) + b * (np.cosh(x) - np.cos(x))

    tip = shape(root)
    return shape(root * share) / tip, root * slope(root * share) / tip


def _mode(solid: Solid, body: SolidBody, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity (n, 2) [m/s] of the body's bending mode at `points` (n, 2) [m], and its rate of rotation (n,) [1/s]."""
    wanted = body.velocity_mode
    lower, upper = own_box(body)
    angle = math.radians(body.rotate.angle) if body.rotate else 0.0
    about = np.array(body.rotate.about) if body.rotate else np.zeros(2)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])  # rows: body's axes
    own = about + (points - about) @ turn.T
    axis, sense = SIDES[wanted.clamped]
    outward = np.zeros(2)
    outward[axis] = sense
    length = float((upper - lower)[axis])
    face = lower[axis] if sense < 0.0 else upper[axis]
    shape, slope = cantilever_mode(wanted.mode, np.abs(own[:, axis] - face) / length)
    speed = wanted.tip_speed
    if speed is None:
        speed = wanted.tip_speed_over_c0 * math.sqrt(bulk_modulus(solid) / solid.density)
    across = right_of(outward) @ turn  # the way to the tip is −outward; a quarter turn on
    return speed * shape[:, None] * across, speed * slope / length


def start_velocity(solid: Solid, body: SolidBody, points: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Initial velocity (n, 2) [m/s] of the body at reference `points` (n, 2) [m]; `centre` (2,): it spins about it."""
    arm = stretched(body, points, centre) - centre
    velocity = np.array(body.velocity) + body.spin * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    return velocity + _mode(solid, body, points)[0] if body.velocity_mode else velocity


def start_rotation(solid: Solid, body: SolidBody, points: np.ndarray) -> np.ndarray:
    """Initial rate of rotation (n,) [1/s] of the sections at `points` (n, 2) [m] of a slender body."""
    spin = np.full(len(points), body.spin)
    return spin + _mode(solid, body, points)[1] if body.velocity_mode else spin


def prestrain(body: SolidBody) -> np.ndarray:
    """The body's uniform initial stretch ε (2, 2)."""
    xx, yy, xy = body.prestrain
    return np.array([[xx, xy], [xy, yy]])


def stretched(body: SolidBody, points: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Places (n, 2) [m] at t = 0 of reference `points` (n, 2) [m] of the body."""
    return points + (points - centre) @ prestrain(body)
