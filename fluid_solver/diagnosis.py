"""Is the state sane? And the domain outside which fluid is given up."""

from __future__ import annotations

import numpy as np

from fluid_solver.fields import FLUID, RHO, M, P, U, V, X, Y
from shared.contract import SolverFailed
from shared.geometry import outline
from shared.jit import njit
from shared.schema import Scene

LARGEST_COMPRESSION = 0.2  # |ρ/ρ0 − 1| beyond which the fluid is not weakly compressible any more
HEADROOM = 3.0  # of the scene's height, above it, in the automatic domain: splashes fall back
_NAMES = {X: "position", Y: "position", U: "velocity", V: "velocity", RHO: "density", P: "pressure"}


@njit
def first_bad(S, kind, count, rho0, compression):
    """Index of the first fluid particle, parked ones included, with a non-finite or far-off value, and its row."""
    for i in range(S.shape[1]):
        if i < count and kind[i] != FLUID:
            continue
        for row in (X, Y, U, V, P, RHO):
            if not np.isfinite(S[row, i]):
                return i, row
        if i < count and abs(S[RHO, i] / rho0 - 1.0) > compression:
            return i, M
    return -1, -1


def check(store, c) -> None:
    """Raise SolverFailed, naming quantity, value and place, for a non-finite state or a density far off."""
    i, row = first_bad(store.S, store.kind, store.count, c.rho0, LARGEST_COMPRESSION)
    if i < 0:
        return
    S = store.S
    place = f"fluid particle {store.ids[i]} at ({S[X, i]:.4g}, {S[Y, i]:.4g}) m"
    if row != M:
        raise SolverFailed(
            f"the {_NAMES[row]} of {place} is {S[row, i]:.4g}: the fluid diverged. "
            f"Lower fluid.courant, raise fluid.alpha, or look for overlapping bodies or a wall that moves too fast."
        )
    speed = float(np.hypot(S[U, i], S[V, i]))
    raise SolverFailed(
        f"the density of {place} is {S[RHO, i]:.4g} kg/m³, more than {LARGEST_COMPRESSION:.0%} off "
        f"{c.rho0:g} (speed {speed:.3g} m/s, sound speed {c.c0:.3g} m/s): the fluid is not weakly compressible any more. "
        f"Raise fluid.sound_speed if the speed is real, lower fluid.courant if it is not."
    )


def domain_of(scene: Scene) -> np.ndarray:
    """x0, y0, x1, y1 [m]: the scene's, or everything in it, with three times its height above (against gravity)."""
    if scene.domain != "auto":
        return np.array([*scene.domain.lower, *scene.domain.upper], dtype=float)
    bodies = [*scene.fluid.bodies, *(scene.solid.bodies if scene.solid else [])]
    points = [outline(body).reshape(-1, 2) for body in bodies]
    for wall in scene.walls:
        corners = np.asarray(wall.polyline, dtype=float)
        shifts = wall.motion.translation if wall.motion and wall.motion.translation else [(0.0, 0.0)]
        points.extend(corners + shift for shift in shifts)
    points = np.concatenate(points)
    lower, upper = points.min(axis=0), points.max(axis=0)
    margin = 4.0 * scene.fluid.dx
    g = np.asarray(scene.gravity)
    size = HEADROOM * (upper - lower)
    lower, upper = lower - np.where(g > 0.0, size, margin), upper + np.where(g < 0.0, size, margin)
    return np.concatenate([lower, upper])
