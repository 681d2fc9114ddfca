"""Shifting velocity of the fluid: Sun et al. (2019), δu = −M 2h c0 ∇C with M c0 the largest speed.

The largest speed counts up to `FASTEST`: one drop of spray must not stir all the water.
"""

from __future__ import annotations

import math

from fluid_solver.surface import ISOLATED
from shared.jit import inline_njit

FASTEST = 0.1  # of c0: the speed that the sound speed was chosen for
LARGEST = 0.1  # of the largest speed: limit of |δu|; in bulk it is a tenth of that


@inline_njit
def shift_velocity(cx, cy, near_x, near_y, div_r, u_max, c):
    """δu [m/s] from ∇C = (cx, cy) [1/m].

    `near`: kernel sum of the surface normals in reach, zero away from the surface; there the part of δu along it,
    outward, is taken off, or the surface would creep out. Particles in splashes are not shifted.
    """
    if div_r < ISOLATED:
        return 0.0, 0.0
    speed = min(u_max, FASTEST * c.c0)
    dx = -2.0 * c.h * speed * cx
    dy = -2.0 * c.h * speed * cy
    near2 = near_x * near_x + near_y * near_y
    if near2 > 0.0:
        outward = max(0.0, dx * near_x + dy * near_y) / near2
        dx -= outward * near_x
        dy -= outward * near_y
    limit = LARGEST * speed
    size = math.sqrt(dx * dx + dy * dy)
    if size > limit:
        dx *= limit / size
        dy *= limit / size
    return dx, dy
