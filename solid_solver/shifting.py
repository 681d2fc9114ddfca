"""Iterative particle shifting (IPST) of the updated-Lagrangian solid, without a constant to retune with dx.

A particle is pushed away from neighbours that are closer than the spacing s that the lattice gave the pair,

    δ_a = κ s Σ_b n_ab w(r_ab/s),   w(q) = (1 − q)⁴ (1 + 4q) for q < 1 (Wendland C2 with support s),

a few times over. κ is a pure number. Because the support is one spacing, an unstrained lattice is not moved, not
even at its faces and corners, where sums over the full kernel see the missing side. Boundary particles move along
the face only. The fields follow by f ← f + δ·∇f, which is the transport by the velocity ũ − u = δ/Δt; the material
tracer stays where it is.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from shared.jit import inline_njit, parallel_njit
from shared.kernels import kernel_f

STRENGTH = 0.25
"""κ: two particles pushed to half a spacing apart part by 6 % of a spacing per iteration; larger values overshoot."""

ITERATIONS = 3

NEEDED = 0.85
"""Distance of a pair over s below which shifting acts: beyond the elastic compression of the solids treated."""

LARGEST = 0.05
"""Limit on a particle's shift per iteration, over s."""

BOUNDARY = 0.25
"""s |Σ V_b ∇W| from which a particle counts as one of the boundary: 0.45 in the outermost row, 0.03 in the next."""


@inline_njit
def short_range(q):
    """w(q), zero from q = 1."""
    t = max(0.0, 1.0 - q)
    return t * t * t * t * (1.0 + 4.0 * q)


@parallel_njit
def shifts(x, volume, spacing, free, first, neighbour, code, h, delta):
    """δ of the first `free` particles into `delta` (2, free); `spacing` (n,): s to a free or a fixed particle [m]."""
    for a in prange(free):
        d0 = d1 = n0 = n1 = 0.0
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x[0, a] - x[0, b], x[1, a] - x[1, b]
            r2 = r0 * r0 + r1 * r1
            r = math.sqrt(r2)
            s = spacing[b]
            w = short_range(r / s) / max(r, 1.0e-6 * s)
            d0 += w * r0
            d1 += w * r1
            f = kernel_f(code, r2, h) * volume[b]
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
        delta[0, a], delta[1, a] = factor * d0, factor * d1


@parallel_njit
def field_changes(x, fields, volume, correction, delta, free, first, neighbour, code, h, change):
    """δ·∇f = Σ_b V_b (f_b − f_a) (δ_a·B_a ∇W_ab) for `fields` (c, n) into `change` (c, free): exact for linear ones."""
    for a in prange(free):
        change[:, a] = 0.0
        # δ·(raw M⁻¹) = raw·(M⁻¹ δ)
        e0 = correction[0, a] * delta[0, a] + correction[1, a] * delta[1, a]
        e1 = correction[2, a] * delta[0, a] + correction[3, a] * delta[1, a]
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x[0, a] - x[0, b], x[1, a] - x[1, b]
            weight = kernel_f(code, r0 * r0 + r1 * r1, h) * volume[b] * (e0 * r0 + e1 * r1)
            for c in range(fields.shape[0]):
                change[c, a] += weight * (fields[c, b] - fields[c, a])


def shift(x, u, material, correction, spacing, free, first, neighbour, code, h) -> None:
    """Shift the first `free` particles, in place, and carry their fields along (see the module's text).

    `material`: m, V, ρ, S, Q and tracer offsets, as in updated_sweeps.steps.
    """
    mass, volume, rho, stress, curvature, offset = material
    delta = np.zeros((2, free))
    fields = np.empty((7 + len(curvature), len(rho)))
    change = np.empty((7 + len(curvature), free))
    for _ in range(ITERATIONS):
        shifts(x, volume, spacing, free, first, neighbour, code, h, delta)
        fields[:2], fields[2], fields[3:7], fields[7:] = u, rho, stress, curvature
        field_changes(x, fields, volume, correction, delta, free, first, neighbour, code, h, change)
        x[:, :free] += delta
        offset[:, :free] -= delta
        u[:, :free] += change[:2]
        rho[:free] += change[2]
        volume[:free] = mass[:free] / rho[:free]
        stress[:, :free] += change[3:7]
        curvature[:, :free] += change[7:]
