"""Is the state sane? And the domain outside which fluid is given up."""

from __future__ import annotations

import logging

import numpy as np
from numba import prange

from fluid_solver.cells import BLOCK
from fluid_solver.fields import FLUID, PARKED, RHO, P, U, V, X, Y
from fluid_solver.period import period_of
from shared.contract import SolverFailed
from shared.geometry.regions import outline
from shared.jit import njit, parallel_njit
from shared.schema.scene import Scene

log = logging.getLogger("shearwater")

LARGEST_COMPRESSION = 0.2  # |ρ/ρ0 − 1| beyond which a particle is not weakly compressible any more
_HUGE = 1e300
FRACTION = 2e-3  # of the fluid that may be so: single particles are in splashes, of no weight for the rest
FEW = 3  # particles that may be so in any case
_PLACES = 6  # decimals of a place [m] that is told
HEADROOM = 3.0  # of the scene's height, above it, in the automatic domain: splashes fall back
_DIVERGED = (
    "the fluid diverged. Lower fluid.courant, raise fluid.alpha, or look for overlapping bodies or a wall that moves "
    "too fast."
)
_NAMES = {X: "position", Y: "position", U: "velocity", V: "velocity", RHO: "density", P: "pressure"}


@parallel_njit
def mark_suspicious(S, kind, count, rho0, compression, blocks):
    """Leaves in `blocks` per block 1 if any fluid particle has a value that is not finite or is off in density, else
    0."""
    n = S.shape[1]
    for block in prange((n + BLOCK - 1) // BLOCK):
        found = 0.0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, n)):
            if i >= count or kind[i] == FLUID:
                finite = abs(S[X, i] + S[Y, i] + S[U, i] + S[V, i] + S[P, i]) < _HUGE
                if not finite or not abs(S[RHO, i] / rho0 - 1.0) <= compression:
                    found = 1.0
        blocks[block] = found


@njit
def first_bad(S, kind, count):
    """Index of the first fluid particle, parked ones included, with a non-finite value, and its row; else −1."""
    for i in range(S.shape[1]):
        if i < count and kind[i] != FLUID:
            continue
        for row in (X, Y, U, V, P, RHO):
            if not np.isfinite(S[row, i]):
                return i, row
    return -1, -1


@njit
def far_off(S, kind, count, rho0, compression):
    """Number of fluid particles whose density is off by more than `compression`, and the index of the worst."""
    found, worst, most = 0, -1, compression
    for i in range(count):
        if kind[i] == FLUID:
            off = abs(S[RHO, i] / rho0 - 1.0)
            if off > compression:
                found += 1
            if off > most:
                worst, most = i, off
    return found, worst


def report_lost(store, reported: int) -> int:
    """Say so when fluid has left the domain: the first time, and each time that twice as much has as was `reported`.

    Returns how much has been reported.
    """
    if store.parked < max(1, 2 * reported):
        return reported
    x, y = _first_gone(store)
    log.warning(
        "%d fluid particles have left the domain and are taken out, one near (%.4g, %.4g) m", store.parked, x, y
    )
    return store.parked


def losses(store, fluid: int) -> dict[str, object]:
    """What of `fluid` particles has left the domain; see `LeakyModel.losses`."""
    found = {"lost": store.parked, "lost_fraction": store.parked / fluid}
    return found | {"lost_near": [round(float(c), _PLACES) for c in _first_gone(store)]} if store.parked else found


def _first_gone(store) -> np.ndarray:
    """Where (2,) [m] one of the first particles out of the domain was when it was taken out."""
    return store.S[[X, Y], np.flatnonzero(store.kind == PARKED)[-1]]


def check(store, c) -> None:
    """Raise SolverFailed, naming quantity, value and place, for a non-finite state or densities far off."""
    if store.parked and (i := beyond_period(store)) >= 0:
        raise SolverFailed(f"{_place(store, i)} has moved by more than a whole period at once: {_DIVERGED}")
    blocks = store.speeds[0, : (store.S.shape[1] + BLOCK - 1) // BLOCK]
    mark_suspicious(store.S, store.kind, store.count, c.rho0, LARGEST_COMPRESSION, blocks)
    if not blocks.any():
        return
    i, row = first_bad(store.S, store.kind, store.count)
    if i >= 0:
        raise SolverFailed(f"the {_NAMES[row]} of {_place(store, i)} is {store.S[row, i]:.4g}: {_DIVERGED}")
    found, i = far_off(store.S, store.kind, store.count, c.rho0, LARGEST_COMPRESSION)
    if found > max(FEW, FRACTION * store.count):
        speed = float(np.hypot(store.S[U, i], store.S[V, i]))
        raise SolverFailed(
            f"the density of {found} fluid particles is more than {LARGEST_COMPRESSION:.0%} off {c.rho0:g} kg/m³, "
            f"worst {store.S[RHO, i]:.4g} kg/m³ of {_place(store, i)} (speed {speed:.3g} m/s, sound speed "
            f"{c.c0:.3g} m/s): the fluid is not weakly compressible any more. Raise "
            f"fluid.sound_speed if the speed is real, lower fluid.courant if it is not."
        )


def beyond_period(store) -> int:
    """Index of the first particle taken out that is beyond the period, where there is one; else −1."""
    first, last = store.period.T[:, :, None]
    beyond = (first < last) & ~((first <= store.S[[X, Y]]) & (store.S[[X, Y]] <= last))
    found = np.flatnonzero(beyond.any(axis=0) & (store.kind == PARKED))
    return int(found[0]) if found.size else -1


def _place(store, i: int) -> str:
    return f"fluid particle {store.ids[i]} at ({store.S[X, i]:.4g}, {store.S[Y, i]:.4g}) m"


def domain_of(scene: Scene) -> np.ndarray:
    """x0, y0, x1, y1 [m]: as in `_bounds`; in a periodic direction the period, where nothing is beyond it but what has
    moved by more than a whole one at once."""
    lower, upper = _bounds(scene).reshape(2, 2)
    first, last = period_of(scene).T
    return np.concatenate([np.where(first < last, first, lower), np.where(first < last, last, upper)])


def _bounds(scene: Scene) -> np.ndarray:
    """x0, y0, x1, y1 [m]: the scene's, or everything in it, with three times its height above (against gravity)."""
    if scene.domain != "auto":
        return np.array([*scene.domain.lower, *scene.domain.upper], dtype=float)
    bodies = [*scene.fluid.bodies, *(scene.solid.bodies if scene.solid else [])]
    points = [outline(body).reshape(-1, 2) for body in bodies]
    for wall in scene.walls:
        corners = np.asarray(wall.polyline, dtype=float)
        shifts = wall.motion.translation if wall.motion and wall.motion.translation else [(0.0, 0.0)]
        if wall.motion and wall.motion.rotation:  # the square around the circle that its corners may run through
            reach = np.hypot(*(corners - wall.motion.about).T).max()
            corners = np.asarray(wall.motion.about) + reach * np.array([[-1.0, -1.0], [1.0, 1.0]])
        points.extend(corners + shift for shift in shifts)
    points = np.concatenate(points)
    lower, upper = points.min(axis=0), points.max(axis=0)
    margin = 4.0 * scene.fluid.dx
    g = np.asarray(scene.gravity)
    size = HEADROOM * (upper - lower)
    lower, upper = lower - np.where(g > 0.0, size, margin), upper + np.where(g < 0.0, size, margin)
    return np.concatenate([lower, upper])
