"""Sweeps of the updated-Lagrangian solid with the gradient as printed or corrected to be exact for linear fields."""

from __future__ import annotations

import numpy as np

from shared.jit import inline_njit, ordered_njit
from solid_solver.blocks import CHUNK, GROUP, RUN
from solid_solver.updated_fields import ACTS, AX, AY, OWN, RHO, M
from solid_solver.updated_material import deformed
from solid_solver.updated_pairs import OWN_SIZE, PAIR_SIZE, force_pair, gradient_pair, load_own, load_rows, store_rows

Q0, Q1, W0, W1, W, T00, T01, T10, T11, P0, P1 = range(OWN, OWN + 11)
"""Planes of Q; of Σ m F r and Σ m F; of the fluxes."""

ROWS = OWN + 11
SUMS = 12
_AT = (SUMS - M) * RUN
_WORK = _AT + ROWS * RUN
_SINGULAR = 1.0e-3
"""Determinant of M (1 in a full neighbourhood) below which a particle's gradient stays uncorrected."""


@inline_njit
def _add_gradient(sums, pairs, count):
    """Add GROUP pairs to the sums: Σ w u_b−u_a ⊗ r (4), M (3), Σ w r (2), Σ w, Σ w (u_b − u_a) (2), w = m_b F."""
    for l in range(count):
        g00 = g01 = g10 = g11 = m00 = m01 = m11 = s0 = s1 = total = l0 = l1 = 0.0
        for g in range(GROUP):
            at = g * PAIR_SIZE + l
            r0, r1, du, dv, f = (
                pairs[at],
                pairs[at + RUN],
                pairs[at + 2 * RUN],
                pairs[at + 3 * RUN],
                pairs[at + 4 * RUN],
            )
            w0, w1 = f * r0, f * r1
            g00 += du * w0
            g01 += du * w1
            g10 += dv * w0
            g11 += dv * w1
            m00 -= r0 * w0
            m01 -= r0 * w1
            m11 -= r1 * w1
            s0 += w0
            s1 += w1
            total += f
            l0 -= f * du
            l1 -= f * dv
        sums[l] += g00
        sums[RUN + l] += g01
        sums[2 * RUN + l] += g10
        sums[3 * RUN + l] += g11
        sums[4 * RUN + l] += m00
        sums[5 * RUN + l] += m01
        sums[6 * RUN + l] += m11
        sums[7 * RUN + l] += s0
        sums[8 * RUN + l] += s1
        sums[9 * RUN + l] += total
        sums[10 * RUN + l] += l0
        sums[11 * RUN + l] += l1


@inline_njit
def _material(d, count, material, dt, corrected):
    """From the sums in `d` the rows of the state behind them, after `dt`."""
    shear, c_squared, rho0, bending = material
    rate = 1.0 / dt if dt > 0.0 else 0.0
    for l in range(count):
        at = _AT + l
        irho = 1.0 / d[at + RHO * RUN]
        m00, m01, m11 = irho * d[4 * RUN + l], irho * d[5 * RUN + l], irho * d[6 * RUN + l]
        s0, s1 = irho * d[7 * RUN + l], irho * d[8 * RUN + l]
        det = m00 * m11 - m01 * m01
        fits = corrected if det > _SINGULAR else 0.0
        inverse = fits / (det if det > _SINGULAR else 1.0)
        i00, i01, i11 = (1.0 - fits) + inverse * m11, -inverse * m01, (1.0 - fits) + inverse * m00
        step = dt * irho
        a, b, c, e = step * d[l], step * d[RUN + l], step * d[2 * RUN + l], step * d[3 * RUN + l]
        a, b, c, e = a * i00 + b * i01, a * i01 + b * i11, c * i00 + e * i01, c * i01 + e * i11
        k = 4.0 / max(m00 + m11, _SINGULAR)
        l0 = k * (step * d[10 * RUN + l] - a * s0 - b * s1)
        l1 = k * (step * d[11 * RUN + l] - c * s0 - e * s1)
        xx, xy, yy, irho, cosine, sine = deformed(d, at, (a, b, c, e), rate, shear, c_squared, rho0)
        gain = bending * d[at + M * RUN] * irho / 12.0
        q0, q1 = d[at + Q0 * RUN], d[at + Q1 * RUN]
        q0, q1 = cosine * q0 - sine * q1 + gain * l0, sine * q0 + cosine * q1 + gain * l1
        d[at + Q0 * RUN], d[at + Q1 * RUN] = q0, q1
        per = irho * irho * d[at + ACTS * RUN]
        t00, t01 = per * (xx - k * q0 * s0), per * (xy - k * q0 * s1)
        t10, t11 = per * (xy - k * q1 * s0), per * (yy - k * q1 * s1)
        d[at + T00 * RUN], d[at + T01 * RUN] = t00 * i00 + t01 * i01, t00 * i01 + t01 * i11
        d[at + T10 * RUN], d[at + T11 * RUN] = t10 * i00 + t11 * i01, t10 * i01 + t11 * i11
        d[at + P0 * RUN], d[at + P1 * RUN] = per * k * q0, per * k * q1
        d[at + W0 * RUN], d[at + W1 * RUN], d[at + W * RUN] = d[7 * RUN + l], d[8 * RUN + l], d[9 * RUN + l]


@ordered_njit
def linear_stress(chunk, blocks, S, code, h, material, dt, corrected):
    """Sums, deformation rate and stress of one chunk of blocks, with the linear or printed gradient, after `dt` [s]."""
    own, pairs, d = np.empty(OWN_SIZE), np.empty(GROUP * PAIR_SIZE), np.empty(_WORK)
    for n in range(chunk * CHUNK, min(blocks.start.size, (chunk + 1) * CHUNK)):
        s, count = blocks.start[n], blocks.count[n]
        load_own(own, S, s, count)
        for c in range(SUMS * RUN):
            d[c] = 0.0
        for k in range(blocks.first[n], blocks.first[n + 1], GROUP):
            for g in range(GROUP):
                pair = pairs[g * PAIR_SIZE : (g + 1) * PAIR_SIZE]
                gradient_pair(pair, own, S, s + blocks.distance[k + g], count, code, h)
            _add_gradient(d, pairs, count)
        load_rows(d, _AT, S, s, count, ROWS)
        _material(d, count, material, dt, corrected)
        store_rows(d, _AT, S, s, count, ROWS)


@inline_njit
def _add_force(force, pair, S, p, count):
    """Add the forces that neighbours from slot `p` on exert by their own stress, and by viscosity."""
    t00, t01, t10, t11 = S[T00, p : p + count], S[T01, p : p + count], S[T10, p : p + count], S[T11, p : p + count]
    p0, p1 = S[P0, p : p + count], S[P1, p : p + count]
    for l in range(count):
        w0, w1, f, pi = pair[l], pair[RUN + l], pair[2 * RUN + l], pair[3 * RUN + l]
        force[l] += (t00[l] - pi) * w0 + t01[l] * w1 + f * p0[l]
        force[RUN + l] += t10[l] * w0 + (t11[l] - pi) * w1 + f * p1[l]


@ordered_njit
def linear_forces(chunk, blocks, S, code, h, viscosity):
    """Accelerations of one chunk of blocks by the stress that `linear_stress` left; `viscosity`: α h c [m²/s]."""
    own, pair, force = np.empty(OWN_SIZE), np.empty(PAIR_SIZE), np.empty(2 * RUN)
    for n in range(chunk * CHUNK, min(blocks.start.size, (chunk + 1) * CHUNK)):
        s, count = blocks.start[n], blocks.count[n]
        load_own(own, S, s, count)
        for l in range(count):
            w0, w1, w = S[W0, s + l], S[W1, s + l], S[W, s + l]
            force[l] = S[T00, s + l] * w0 + S[T01, s + l] * w1 - S[P0, s + l] * w
            force[RUN + l] = S[T10, s + l] * w0 + S[T11, s + l] * w1 - S[P1, s + l] * w
        for k in range(blocks.first[n], blocks.first[n + 1]):
            p = s + blocks.distance[k]
            force_pair(pair, own, S, p, count, code, h, viscosity)
            _add_force(force, pair, S, p, count)
        for l in range(count):
            S[AX, s + l] = force[l]
        for l in range(count):
            S[AY, s + l] = force[RUN + l]
