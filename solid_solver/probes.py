"""The solid's probes: what each model can tell of a material point or a body, and what several models tell alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from shared.schema.scene import Scene
from solid_solver.bodies import LatticeBody

_REACH = 2.6  # spacings: particles about a point that its stress is fitted to


def body_probes(
    scene: Scene,
    at_point: Mapping[str, Callable[[int, np.ndarray], Callable[[], float]]],
    of_body: Mapping[str, Callable[[int], float]],
) -> dict[str, Callable[[], float]]:
    """The probes of the solid that a model can tell, by name, as functions without arguments.

    By quantity: `at_point[quantity](k, point)` makes the function for a material point of body k,
    `of_body[quantity](k)` is the value of body k.
    """
    number = {body.name: k for k, body in enumerate(scene.solid.bodies)}
    result: dict[str, Callable[[], float]] = {}
    for probe in scene.probes:
        k = number.get(probe.body)
        if k is not None and probe.quantity in at_point:
            result[probe.name] = at_point[probe.quantity](k, np.array(probe.point))
        elif k is not None and probe.quantity in of_body:
            result[probe.name] = partial(of_body[probe.quantity], k)
    return result


def wants_work(scene: Scene) -> bool:
    """Whether a probe needs the work of the loads kept."""
    return any(probe.quantity in ("external-work", "dissipated") for probe in scene.probes)


# ---- at a point -------------------------------------------------------------------------------------------------


def displacement_weights(body: LatticeBody, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Particles (k,), numbered among all bodies', and weights (k,) that give the displacement of a reference `point`
    (2,) [m] of a body from theirs: from the fit with points held still, or where a clamp moves, without them."""
    if body.moving:
        return field_weights(body, point)
    _, particles, weights = body.point_weights(point[None])
    return particles, weights


def field_weights(body: LatticeBody, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Particles (k,) near a reference `point` (2,) [m] of a body, numbered among all bodies', and weights (k,) that
    carry a field known at particles there.

    From a least-squares fit of a quadratic, or as much of one as the particles determine.
    """
    s = (body.position - point) @ body.axes.T / body.spacing
    distance = np.sqrt(np.sum(s * s, axis=1))
    reach = max(_REACH, float(distance.min()) + _REACH - 0.5)
    near = np.flatnonzero(distance < reach)
    a, b = s[near].T
    basis = np.stack([np.ones_like(a), a, b, 0.5 * a * a, a * b, 0.5 * b * b], axis=1)
    weight = 1.0 - distance[near] / reach
    return body.first + near, np.linalg.pinv(weight[:, None] * basis)[0] * weight


def von_mises(xx: float, yy: float, xy: float, pressure: float) -> float:
    """Von Mises' stress [Pa] of Cauchy stresses and `pressure` = −(xx + yy + zz)/3 [Pa]."""
    zz = -3.0 * pressure - xx - yy
    return float(np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2))


# ---- of a body --------------------------------------------------------------------------------------------------


def kinetic_energy(mass: np.ndarray, velocity: np.ndarray) -> float:
    """½ Σ m v² [J/m] of particles of `mass` (n,) [kg/m]."""
    return float(0.5 * mass @ np.sum(velocity**2, axis=1))


def angular_momentum(mass: np.ndarray, place: np.ndarray, velocity: np.ndarray) -> float:
    """Σ m x × v [N s] about the origin of particles of `mass` (n,) [kg/m] at `place` (n, 2) [m]."""
    return float(mass @ (place[:, 0] * velocity[:, 1] - place[:, 1] * velocity[:, 0]))


def nearest_gap(place: np.ndarray, spacing: np.ndarray) -> float:
    """Largest distance of a point at `place` (n, 2) [m] to its nearest one, over the smaller `spacing` (2,)."""
    return float(cKDTree(place).query(place, k=2)[0][:, 1].max() / spacing.min())


def largest_speed(velocity: np.ndarray) -> float:
    """Largest of the speeds [m/s] of points with `velocity` (n, 2)."""
    return float(np.sqrt(np.max(np.sum(velocity**2, axis=1))))
