"""Pairs of a block of the updated-Lagrangian solid: differences and kernel, one neighbour distance at a time.

A block's own values and those of its pairs lie in planes of RUN in small arrays that stay in the first-level cache:
`own`: x, y, u, v, 1/ρ; a pair's: as each function says. `S`: the state, see updated_fields.py.
"""

from __future__ import annotations

from shared.jit import inline_njit
from shared.kernels import kernel_f, kernel_w
from solid_solver.blocks import RUN
from solid_solver.updated_fields import IRHO, RHO, M, U, V, X, Y

OWN_SIZE = 5 * RUN
PAIR_SIZE = 5 * RUN


@inline_njit
def load_own(own, S, s, count):
    """The block's own values, from slot `s` on."""
    for l in range(count):
        own[l] = S[X, s + l]
    for l in range(count):
        own[RUN + l] = S[Y, s + l]
    for l in range(count):
        own[2 * RUN + l] = S[U, s + l]
    for l in range(count):
        own[3 * RUN + l] = S[V, s + l]
    for l in range(count):
        own[4 * RUN + l] = S[IRHO, s + l]


@inline_njit
def load_rows(d, at, S, s, count, end):
    """The block's rows of the state from M up to `end` into `d`, row number r at `at` + r RUN."""
    for row in range(M, end):
        for l in range(count):
            d[at + row * RUN + l] = S[row, s + l]


@inline_njit
def store_rows(d, at, S, s, count, end):
    """Back into the state, from ρ on: what a step changes."""
    for row in range(RHO, end):
        for l in range(count):
            S[row, s + l] = d[at + row * RUN + l]


@inline_njit
def gradient_pair(pair, own, S, p, count, code, h):
    """r_ab (2), u_b − u_a (2) and m_b F_ab of the neighbours from slot `p` on into `pair`."""
    xb, yb, ub, vb = S[X, p : p + count], S[Y, p : p + count], S[U, p : p + count], S[V, p : p + count]
    mb = S[M, p : p + count]
    for l in range(count):
        r0, r1 = own[l] - xb[l], own[RUN + l] - yb[l]
        pair[l] = r0
        pair[RUN + l] = r1
        pair[2 * RUN + l] = ub[l] - own[2 * RUN + l]
        pair[3 * RUN + l] = vb[l] - own[3 * RUN + l]
        pair[4 * RUN + l] = mb[l] * kernel_f(code, r0 * r0 + r1 * r1, h)


@inline_njit
def force_pair(pair, own, S, p, count, code, h, viscosity):
    """m_b F_ab r_ab (2), m_b F_ab, and m_b Π_ab F_ab r_ab (2) of the neighbours from slot `p` on into `pair`.

    Π = −α h c φ/ρ̄, φ = u_ab·r_ab/(r² + 0.01 h²) < 0, with 1/ρ̄ the mean of both 1/ρ; `viscosity`: α h c [m²/s].
    """
    xb, yb, ub, vb = S[X, p : p + count], S[Y, p : p + count], S[U, p : p + count], S[V, p : p + count]
    mb, ib = S[M, p : p + count], S[IRHO, p : p + count]
    half, least = -0.5 * viscosity, 0.01 * h * h
    for l in range(count):
        r0, r1 = own[l] - xb[l], own[RUN + l] - yb[l]
        r2 = r0 * r0 + r1 * r1
        f = mb[l] * kernel_f(code, r2, h)
        approach = min(0.0, (own[2 * RUN + l] - ub[l]) * r0 + (own[3 * RUN + l] - vb[l]) * r1)
        pi = half * approach * (own[4 * RUN + l] + ib[l]) / (r2 + least)
        pair[l] = f * r0
        pair[RUN + l] = f * r1
        pair[2 * RUN + l] = f
        pair[3 * RUN + l] = pi


@inline_njit
def fit_pair(pair, own, S, p, count, code, h):
    """d_ab = −r_ab/h (2), u_b − u_a (2) and m_b W_ab of the neighbours from slot `p` on into `pair`."""
    xb, yb, ub, vb = S[X, p : p + count], S[Y, p : p + count], S[U, p : p + count], S[V, p : p + count]
    mb = S[M, p : p + count]
    inverse = 1.0 / h
    for l in range(count):
        d0, d1 = inverse * (xb[l] - own[l]), inverse * (yb[l] - own[RUN + l])
        pair[l] = d0
        pair[RUN + l] = d1
        pair[2 * RUN + l] = ub[l] - own[2 * RUN + l]
        pair[3 * RUN + l] = vb[l] - own[3 * RUN + l]
        pair[4 * RUN + l] = mb[l] * inverse * inverse * kernel_w(code, d0 * d0 + d1 * d1, 1.0)


@inline_njit
def fit_force_pair(pair, own, S, p, count, code, h, viscosity):
    """d_ab = −r_ab/h (2), m_b W_ab and h m_b Π_ab F_ab of the neighbours from slot `p` on into `pair`."""
    xb, yb, ub, vb = S[X, p : p + count], S[Y, p : p + count], S[U, p : p + count], S[V, p : p + count]
    mb, ib = S[M, p : p + count], S[IRHO, p : p + count]
    inverse, factor = 1.0 / h, 0.5 * viscosity
    for l in range(count):
        d0, d1 = inverse * (xb[l] - own[l]), inverse * (yb[l] - own[RUN + l])
        r2 = d0 * d0 + d1 * d1
        m = mb[l] * inverse * inverse
        approach = min(0.0, (ub[l] - own[2 * RUN + l]) * d0 + (vb[l] - own[3 * RUN + l]) * d1)
        pi = factor * approach * (own[4 * RUN + l] + ib[l]) / (r2 + 0.01)
        pair[l] = d0
        pair[RUN + l] = d1
        pair[2 * RUN + l] = m * kernel_w(code, r2, 1.0)
        pair[3 * RUN + l] = -pi * m * inverse * inverse * kernel_f(code, r2, 1.0)
