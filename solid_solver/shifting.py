"""Iterative particle shifting (IPST) of the updated-Lagrangian solid, without a constant to retune with dx.

A particle is pushed away from neighbours that are closer than the spacing s that the lattice gave the pair,

    δ_a = κ s Σ_b n_ab w(r_ab/s),   w(q) = (1 − q)⁴ (1 + 4q) for q < 1 (Wendland C2 with support s),

a few times over. κ is a pure number. Because the support is one spacing, an unstrained lattice is not moved, not
even at its faces and corners, where sums over the full kernel see the missing side. Boundary particles move along
the face only. The fields follow by f ← f + δ·∇f with a gradient that is exact for linear fields, which is the transport
by the velocity ũ − u = δ/Δt; the material tracer stays where it is.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from shared.jit import inline_njit, parallel_njit
from shared.kernels import kernel_f
from solid_solver.updated_fields import E0, IRHO, MOVES, OWN, RHO, SZZ, M, U, V, X, Y

STRENGTH = 0.25
"""κ: two particles pushed to half a spacing apart part by 6 % of a spacing per iteration; larger values overshoot."""

ITERATIONS = 3

NEEDED = (0.85, 0.85, 0.4)
"""Distance of a pair over s below which shifting acts, by the gradient's order: in the first two beyond the elastic
compression of the solids treated. The quadratic gradient keeps particles in order, as close as the material is
compressed: to 0.51 at the clamp's corner of plate_step_load under 1500 Pa, where shifts at 0.6 break what holds."""

LARGEST = 0.05
"""Limit on a particle's shift per iteration, over s."""

BOUNDARY = 0.25
"""s |Σ V_b ∇W| from which a particle counts as one of the boundary: 0.45 in the outermost row, 0.03 in the next."""

_SINGULAR = 1.0e-3
"""Determinant of M (1 in a full neighbourhood) below which fields are not carried along."""


@inline_njit
def _short_range(q):
    """w(q), zero from q = 1."""
    t = max(0.0, 1.0 - q)
    return t * t * t * t * (1.0 + 4.0 * q)


@parallel_njit
def shifts(S, blocks, spacing, code, h, delta):
    """δ of the particles that move into `delta` (2, slots); `spacing` (slots,): s to a free or a fixed particle [m]."""
    for n in prange(blocks.start.size):
        for a in range(blocks.start[n], blocks.start[n] + blocks.count[n]):
            d0 = d1 = n0 = n1 = 0.0
            for k in range(blocks.first[n], blocks.first[n + 1]):
                b = a + blocks.distance[k]
                r0, r1 = S[X, a] - S[X, b], S[Y, a] - S[Y, b]
                r2 = r0 * r0 + r1 * r1
                r = math.sqrt(r2)
                s = spacing[b]
                w = _short_range(r / s) / max(r, 1.0e-6 * s)
                d0 += w * r0
                d1 += w * r1
                f = kernel_f(code, r2, h) * S[M, b] * S[IRHO, a]
                n0 += f * r0
                n1 += f * r1
            size = math.sqrt(n0 * n0 + n1 * n1)
            if size * spacing[a] > BOUNDARY:
                along = (d0 * n0 + d1 * n1) / (size * size)
                d0 -= along * n0
                d1 -= along * n1
            factor = STRENGTH * spacing[a] * S[MOVES, a]
            length = factor * math.sqrt(d0 * d0 + d1 * d1)
            if length > LARGEST * spacing[a]:
                factor *= LARGEST * spacing[a] / length
            delta[0, a], delta[1, a] = factor * d0, factor * d1


@parallel_njit
def field_changes(S, rows, blocks, delta, code, h, change):
    """δ·∇f of the state's `rows` into `change` (rows, slots): exact for linear fields."""
    for n in prange(blocks.start.size):
        for a in range(blocks.start[n], blocks.start[n] + blocks.count[n]):
            change[:, a] = 0.0
            m00 = m01 = m11 = 0.0
            for k in range(blocks.first[n], blocks.first[n + 1]):
                b = a + blocks.distance[k]
                r0, r1 = S[X, a] - S[X, b], S[Y, a] - S[Y, b]
                f = kernel_f(code, r0 * r0 + r1 * r1, h) * S[M, b] * S[IRHO, a]
                m00 -= f * r0 * r0
                m01 -= f * r0 * r1
                m11 -= f * r1 * r1
            det = m00 * m11 - m01 * m01
            if det < _SINGULAR or delta[0, a] == 0.0 == delta[1, a]:
                continue
            e0, e1 = (m11 * delta[0, a] - m01 * delta[1, a]) / det, (m00 * delta[1, a] - m01 * delta[0, a]) / det
            for k in range(blocks.first[n], blocks.first[n + 1]):
                b = a + blocks.distance[k]
                r0, r1 = S[X, a] - S[X, b], S[Y, a] - S[Y, b]
                f = kernel_f(code, r0 * r0 + r1 * r1, h) * S[M, b] * S[IRHO, a]
                weight = f * (e0 * r0 + e1 * r1)
                for c in range(rows.size):
                    change[c, a] += weight * (S[rows[c], b] - S[rows[c], a])


def shift(S: np.ndarray, blocks: tuple, spacing: np.ndarray, curvature: int, code: int, h: float) -> None:
    """Shift the particles that move, in place, and carry their fields along (see the module's text).

    `curvature`: number of rows from OWN on that are carried too.
    """
    rows = np.array([U, V, *range(RHO, SZZ + 1), *range(OWN, OWN + curvature)])
    delta, change = np.zeros((2, S.shape[1])), np.zeros((len(rows), S.shape[1]))
    for _ in range(ITERATIONS):
        shifts(S, blocks, spacing, code, h, delta)
        field_changes(S, rows, blocks, delta, code, h, change)
        S[X : Y + 1] += delta
        S[E0 : E0 + 2] -= delta
        S[rows] += change
        S[IRHO] = 1.0 / S[RHO]
