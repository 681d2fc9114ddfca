"""Iterative particle shifting (IPST) of the updated-Lagrangian solid, without a constant to retune with dx.

A particle is pushed away from neighbours that are closer than the spacing s that the lattice gave the pair,

    δ_a = κ s Σ_b n_ab w(r_ab/s),   w(q) = (1 − q)⁴ (1 + 4q) for q < 1 (Wendland C2 with support s),

a few times over. κ is a pure number. Because the support is one spacing, an unstrained lattice is not moved, not
even at its faces and corners, where sums over the full kernel see the missing side. Boundary particles move along
the face only. The fields follow by f ← f + δ·∇f, which is the transport by the velocity ũ − u = δ/Δt; the material tracer
stays where it is.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from shared.jit import njit, parallel_njit
from shared.kernels import kernel_f

STRENGTH = 0.25
"""κ: two particles pushed to half a spacing apart part by 6 % of a spacing per iteration; larger values overshoot."""

ITERATIONS = 3

NEEDED = 0.85
"""Nearest distance over s below which shifting acts: beyond the elastic compression of the solids treated."""

LARGEST = 0.05
"""Limit on a particle's shift per iteration, over s."""

BOUNDARY = 0.25
"""s |Σ V_b ∇W| from which a particle counts as one of the boundary: 0.45 in the outermost row, 0.03 in the next."""


@njit
def short_range(q):
    """w(q), zero from q = 1."""
    t = max(0.0, 1.0 - q)
    return t * t * t * t * (1.0 + 4.0 * q)


@parallel_njit
def shifts(x, mass, rho, spacing, free, first, neighbour, code, h, delta):
    """δ of the first `free` particles into `delta` (free, 2); `spacing` [m] between free particles, half of it to fixed ones."""
    for a in prange(free):
        d0 = d1 = n0 = n1 = 0.0
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1]
            r2 = r0 * r0 + r1 * r1
            r = math.sqrt(r2)
            s = spacing[a] if b < free else 0.5 * spacing[a]
            w = short_range(r / s) / max(r, 1.0e-6 * s)
            d0 += w * r0
            d1 += w * r1
            f = kernel_f(code, r2, h) * mass[b] / rho[b]
            n0 += f * r0
            n1 += f * r1
        size = math.sqrt(n0 * n0 + n1 * n1)
        if size * spacing[a] > BOUNDARY:
            along = (d0 * n0 + d1 * n1) / (size * size)
            d0 -= along * n0
            d1 -= along * n1
        factor = STRENGTH * spacing[a]
        length = factor * math.sqrt(d0 * d0 + d1 * d1)
        if length > LARGEST * spacing[a]:
            factor *= LARGEST * spacing[a] / length
        delta[a, 0], delta[a, 1] = factor * d0, factor * d1


@parallel_njit
def field_changes(x, fields, mass, rho, correction, delta, free, first, neighbour, code, h, change):
    """δ·∇f = Σ_b V_b (f_b − f_a) (δ_a·B_a ∇W_ab) for `fields` (n, c) into `change` (free, c): exact for linear fields."""
    for a in prange(free):
        change[a] = 0.0
        # δ·(raw M⁻¹) = raw·(M⁻¹ δ)
        e0 = correction[a, 0] * delta[a, 0] + correction[a, 1] * delta[a, 1]
        e1 = correction[a, 2] * delta[a, 0] + correction[a, 3] * delta[a, 1]
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1]
            weight = kernel_f(code, r0 * r0 + r1 * r1, h) * mass[b] / rho[b] * (e0 * r0 + e1 * r1)
            for c in range(fields.shape[1]):
                change[a, c] += weight * (fields[b, c] - fields[a, c])


def shift(x, u, rho, stress, offset, mass, correction, spacing, free, first, neighbour, code, h) -> None:
    """Shift the first `free` particles, in place, and carry their fields along (see the module's text)."""
    delta = np.zeros((free, 2))
    fields = np.empty((len(rho), 7))
    change = np.empty((free, 7))
    for _ in range(ITERATIONS):
        shifts(x, mass, rho, spacing, free, first, neighbour, code, h, delta)
        fields[:, :2], fields[:, 2], fields[:, 3:] = u, rho, stress
        field_changes(x, fields, mass, rho, correction, delta, free, first, neighbour, code, h, change)
        x[:free] += delta
        offset[:free] -= delta
        u[:free] += change[:, :2]
        rho[:free] += change[:, 2]
        stress[:free] += change[:, 3:]
