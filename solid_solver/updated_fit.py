"""Quadratic moving-least-squares fit of the updated-Lagrangian solid: sums over pairs, and the fit's factors.

Symbols: d = (x_b − x_a)/h, p(d) = (d0, d1, d0²/2, d0 d1, d1²/2), weights w_ab = m_b W_ab h⁻²·h² (pure after division by
ρ_a). About each particle the velocity is fitted by a full quadratic, M_a = Σ w p pᵀ, and the derivatives in units of
h are M⁻¹ Σ w p (u_b − u_a). The sums of a block's particles stand in planes of RUN: twelve different entries of M,
Σ w d (2), Σ w p (u_b − u_a) (5), Σ w p (v_b − v_a) (5).
"""

from __future__ import annotations

from shared.jit import inline_njit
from solid_solver.blocks import GROUP, RUN
from solid_solver.updated_pairs import PAIR_SIZE

SUMS = 24
"""Planes of sums."""

_SINGULAR = 1.0e-9
"""Pivot of M below which a direction of the fit is left out."""


@inline_njit
def add_moments(sums, pairs, count):
    """Add GROUP pairs to M (12 different entries) and to Σ w d (2)."""
    for l in range(count):
        m20 = m11 = m02 = m30 = m21 = m12 = m03 = m40 = m31 = m22 = m13 = m04 = s0 = s1 = 0.0
        for g in range(GROUP):
            at = g * PAIR_SIZE + l
            d0, d1, w = pairs[at], pairs[at + RUN], pairs[at + 4 * RUN]
            p2, p3, p4 = 0.5 * d0 * d0, d0 * d1, 0.5 * d1 * d1
            w0, w1, w2, w3, w4 = w * d0, w * d1, w * p2, w * p3, w * p4
            s0 += w0
            s1 += w1
            m20 += w0 * d0
            m11 += w0 * d1
            m02 += w1 * d1
            m30 += w0 * p2
            m21 += w0 * p3
            m12 += w0 * p4
            m03 += w1 * p4
            m40 += w2 * p2
            m31 += w2 * p3
            m22 += w2 * p4
            m13 += w3 * p4
            m04 += w4 * p4
        sums[l] += m20
        sums[RUN + l] += m11
        sums[2 * RUN + l] += m02
        sums[3 * RUN + l] += m30
        sums[4 * RUN + l] += m21
        sums[5 * RUN + l] += m12
        sums[6 * RUN + l] += m03
        sums[7 * RUN + l] += m40
        sums[8 * RUN + l] += m31
        sums[9 * RUN + l] += m22
        sums[10 * RUN + l] += m13
        sums[11 * RUN + l] += m04
        sums[12 * RUN + l] += s0
        sums[13 * RUN + l] += s1


@inline_njit
def add_differences(sums, pairs, count):
    """Add GROUP pairs to Σ w p (u_b − u_a) and Σ w p (v_b − v_a), five each."""
    for l in range(count):
        a0 = a1 = a2 = a3 = a4 = b0 = b1 = b2 = b3 = b4 = 0.0
        for g in range(GROUP):
            at = g * PAIR_SIZE + l
            d0, d1, w = pairs[at], pairs[at + RUN], pairs[at + 4 * RUN]
            du, dv = w * pairs[at + 2 * RUN], w * pairs[at + 3 * RUN]
            p2, p3, p4 = 0.5 * d0 * d0, d0 * d1, 0.5 * d1 * d1
            a0 += d0 * du
            a1 += d1 * du
            a2 += p2 * du
            a3 += p3 * du
            a4 += p4 * du
            b0 += d0 * dv
            b1 += d1 * dv
            b2 += p2 * dv
            b3 += p3 * dv
            b4 += p4 * dv
        sums[14 * RUN + l] += a0
        sums[15 * RUN + l] += a1
        sums[16 * RUN + l] += a2
        sums[17 * RUN + l] += a3
        sums[18 * RUN + l] += a4
        sums[19 * RUN + l] += b0
        sums[20 * RUN + l] += b1
        sums[21 * RUN + l] += b2
        sums[22 * RUN + l] += b3
        sums[23 * RUN + l] += b4


@inline_njit
def _inverse(pivot):
    """1/pivot, or 0 for a direction that the neighbours do not span."""
    return 1.0 / pivot if pivot > _SINGULAR else 0.0


@inline_njit
def factors(d, at, irho):
    """M = L D Lᵀ of the particle whose sums stand in `d` from `at` on: the ten entries of L below its diagonal, 1/D."""
    m20, m11, m02 = irho * d[at], irho * d[at + RUN], irho * d[at + 2 * RUN]
    m30, m21, m12, m03 = irho * d[at + 3 * RUN], irho * d[at + 4 * RUN], irho * d[at + 5 * RUN], irho * d[at + 6 * RUN]
    m40, m31, m22 = irho * d[at + 7 * RUN], irho * d[at + 8 * RUN], irho * d[at + 9 * RUN]
    m13, m04 = irho * d[at + 10 * RUN], irho * d[at + 11 * RUN]
    i0 = _inverse(m20)
    l10, l20, l30, l40 = m11 * i0, m30 * i0, m21 * i0, m12 * i0
    i1 = _inverse(m02 - l10 * m11)
    c2, c3, c4 = 0.5 * m21 - l10 * m30, 2.0 * m12 - l10 * m21, m03 - l10 * m12
    l21, l31, l41 = c2 * i1, c3 * i1, c4 * i1
    i2 = _inverse(m40 - l20 * m30 - l21 * c2)
    e3, e4 = m31 - l20 * m21 - l21 * c3, m22 - l20 * m12 - l21 * c4
    l32, l42 = e3 * i2, e4 * i2
    i3 = _inverse(4.0 * m22 - l30 * m21 - l31 * c3 - l32 * e3)
    f4 = m13 - l30 * m12 - l31 * c4 - l32 * e4
    l43 = f4 * i3
    i4 = _inverse(m04 - l40 * m12 - l41 * c4 - l42 * e4 - l43 * f4)
    return l10, l20, l30, l40, l21, l31, l41, l32, l42, l43, i0, i1, i2, i3, i4


@inline_njit
def solved(fit, b0, b1, b2, b3, b4):
    """M⁻¹ b from the factors of M."""
    l10, l20, l30, l40, l21, l31, l41, l32, l42, l43, i0, i1, i2, i3, i4 = fit
    b1 -= l10 * b0
    b2 -= l20 * b0 + l21 * b1
    b3 -= l30 * b0 + l31 * b1 + l32 * b2
    b4 -= l40 * b0 + l41 * b1 + l42 * b2 + l43 * b3
    b4 *= i4
    b3 = i3 * b3 - l43 * b4
    b2 = i2 * b2 - l32 * b3 - l42 * b4
    b1 = i1 * b1 - l21 * b2 - l31 * b3 - l41 * b4
    b0 = i0 * b0 - l10 * b1 - l20 * b2 - l30 * b3 - l40 * b4
    return b0, b1, b2, b3, b4
