"""The fluid's fields between its particles: kernel sums at a place, and where its surface stands."""

from __future__ import annotations

import numpy as np

from fluid_solver.cells import COLUMNS, neighbour
from fluid_solver.fields import FLUID, PARKED, RHO, VOL, P, U, V, X, Y
from fluid_solver.motion import nearest_image
from shared.jit import njit
from shared.kernels import kernel_w

HALF = 0.5  # share of its support that water fills at a flat surface
BURIED = 0.6  # share of its support that ghosts fill beyond which a place is behind a face: half of it on one
FILLED = 0.8  # share of its support that every particle finds filled where there is no free surface: half at one
_STEP = 0.25  # of h: stride of the search for the surface


@njit
def sample(S, kind, kernel, x, y, grid, c):
    """Pressure [Pa] and velocity u, v [m/s] at (x, y), normalised by Σ W; pressure by eq. 14 at a point that stands
    still, exact for linear fields. All zero without fluid."""
    total = p = u = v = 0.0
    for b in range(kind.size):
        if kind[b] == FLUID:
            rx = nearest_image(x - S[X, b], 0.0, grid.period_x)
            ry = nearest_image(y - S[Y, b], 0.0, grid.period_y)
            r2 = rx * rx + ry * ry
            if r2 < c.support * c.support:
                w = kernel_w(kernel, r2, c.h)
                total += w
                p += w * (S[P, b] + S[RHO, b] * (c.gx * rx + c.gy * ry))
                u += w * S[U, b]
                v += w * S[V, b]
    return (p / total, u / total, v / total) if total > 0.0 else (0.0, 0.0, 0.0)


@njit
def surface_at(S, kind, kernel, x, grid, c):
    """Highest y [m] where water fills half of the support that walls and structures leave at abscissa `x`; NaN where
    there is no fluid."""
    near = np.empty(kind.size, dtype=np.int64)
    n, top, lowest = 0, -np.inf, np.inf
    for b in range(kind.size):
        if kind[b] != PARKED and abs(nearest_image(x - S[X, b], 0.0, grid.period_x)) < c.support:
            near[n] = b
            n += 1
            if kind[b] == FLUID:
                top = max(top, S[Y, b])
                lowest = min(lowest, S[Y, b])
    outside = top + c.support
    inside = outside
    while inside > lowest and _filled(S, kind, near[:n], kernel, x, inside, grid, c) < HALF:
        outside = inside
        inside -= _STEP * c.h
    if not inside > lowest:
        return np.nan
    for _ in range(30):  # halvings: to rounding
        middle = 0.5 * (inside + outside)
        if _filled(S, kind, near[:n], kernel, x, middle, grid, c) < HALF:
            outside = middle
        else:
            inside = middle
    return inside


@njit
def _filled(S, kind, near, kernel, x, y, grid, c):
    """Σ V W of the fluid over what that of the ghosts leaves to it; within a wall 0."""
    fluid = ghosts = 0.0
    for b in near:
        rx = nearest_image(x - S[X, b], 0.0, grid.period_x)
        ry = y - S[Y, b]
        share = S[VOL, b] * kernel_w(kernel, rx * rx + ry * ry, c.h)
        if kind[b] == FLUID:
            fluid += share
        else:
            ghosts += share
    return fluid / (1.0 - ghosts) if ghosts < BURIED else 0.0


@njit
def lowest_filling(S, start, grid, c):
    """Least share of its support that any particle finds filled, by fluid or ghosts."""
    least = np.inf
    full = np.pi * c.support * c.support
    for cell in range(grid.columns, grid.columns * (grid.rows - 1)):
        for a in range(start[2 * cell], start[2 * cell + 1]):
            total = 0.0
            for j in range(-1, 2):
                for i in range(-COLUMNS, COLUMNS + 1):
                    other, x, y = neighbour(grid, cell % grid.columns + i, cell // grid.columns + j)
                    for b in range(start[2 * other], start[2 * other + 2]):
                        rx, ry = S[X, a] - S[X, b] - x, S[Y, a] - S[Y, b] - y
                        if rx * rx + ry * ry < c.support * c.support:
                            total += S[VOL, b]
            least = min(least, total / full)
    return least
