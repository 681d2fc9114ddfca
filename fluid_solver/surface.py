"""Marks of the free surface, from sums that the force sweep makes anyway."""

from __future__ import annotations

import math

from shared.jit import inline_njit

SURFACE = 1.5  # ∇·r below which a particle is at the surface; 2 inside (Lee et al. 2008)
ISOLATED = 1.0  # ∇·r below which a particle has too few neighbours to know a normal: splash


@inline_njit
def surface_normal(cx, cy, div_r, c):
    """Outward unit normal of a particle at the free surface, −∇C/|∇C|; (0, 0) inside, in splashes, and in a room that
    water fills: what looks like a surface there is a gap, which shifting is to close."""
    size = math.sqrt(cx * cx + cy * cy)
    if c.filled > 0.0 or div_r >= SURFACE or div_r < ISOLATED or size == 0.0:
        return 0.0, 0.0
    return -cx / size, -cy / size
