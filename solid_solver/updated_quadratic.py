"""Sweeps of the updated-Lagrangian solid with a gradient that is exact for quadratic fields (see updated_fit.py)."""

from __future__ import annotations

import numpy as np

from shared.jit import inline_njit, ordered_njit
from solid_solver.blocks import CHUNK, GROUP, RUN
from solid_solver.updated_fields import ACTS, AX, AY, OWN, RHO, M
from solid_solver.updated_fit import SUMS, add_differences, add_moments, factors, solved
from solid_solver.updated_material import deformed, turned
from solid_solver.updated_pairs import OWN_SIZE, PAIR_SIZE, fit_force_pair, fit_pair, load_own, load_rows, store_rows
from solid_solver.updated_pull import pull, pulled, spread

Z0, Z1, Z2, Z3, Z4, Z5, W0, W1, W2, W3, W4, P0, P1, P2, P3, P4, R0, R1, R2, R3, R4, PULL = range(OWN, OWN + 22)
"""Planes of Z; of the sums that the forces need again; of the fluxes; of the energy of A per volume."""

ROWS, Z_ROWS = OWN + 22, 6
_AT = (SUMS - M) * RUN
_WORK = _AT + ROWS * RUN


@inline_njit
def _material(d, count, material, h, dt):
    """From the sums in `d` the rows of the state behind them, after `dt`; the forces get Z + A of updated_pull.py."""
    shear, c_squared, rho0, _ = material
    lam = c_squared * rho0 - 2.0 * shear / 3.0
    rate, share = 1.0 / dt if dt > 0.0 else 0.0, 0.5 * lam / (lam + shear)
    per_h, per_h2 = 1.0 / h, 1.0 / (h * h)
    for l in range(count):
        at = _AT + l
        irho = 1.0 / d[at + RHO * RUN]
        fit = factors(d, l, irho)
        step = dt * irho
        r0, r1, r2, r3, r4 = d[14 * RUN + l], d[15 * RUN + l], d[16 * RUN + l], d[17 * RUN + l], d[18 * RUN + l]
        a, b, x00, x01, x11 = solved(fit, step * r0, step * r1, step * r2, step * r3, step * r4)
        r0, r1, r2, r3, r4 = d[19 * RUN + l], d[20 * RUN + l], d[21 * RUN + l], d[22 * RUN + l], d[23 * RUN + l]
        c, e, y00, y01, y11 = solved(fit, step * r0, step * r1, step * r2, step * r3, step * r4)
        a, b, c, e = per_h * a, per_h * b, per_h * c, per_h * e
        xx, xy, yy, irho, cosine, sine = deformed(d, at, (a, b, c, e), rate, shear, c_squared, rho0)
        p0, p1, p2 = turned(d[at + Z0 * RUN], d[at + Z1 * RUN], d[at + Z2 * RUN], cosine, sine)
        q0, q1, q2 = turned(d[at + Z3 * RUN], d[at + Z4 * RUN], d[at + Z5 * RUN], cosine, sine)
        gain = per_h2 * d[at + M * RUN] * irho / 12.0
        g = gain * shear
        t0, t1 = gain * lam * (x00 + y01), gain * lam * (x01 + y11)
        z0 = cosine * p0 - sine * q0 + t0 + 2.0 * g * x00
        z1 = cosine * p1 - sine * q1 + g * (x01 + y00)
        z2 = cosine * p2 - sine * q2 + t0 + 2.0 * g * y01
        z3 = sine * p0 + cosine * q0 + t1 + 2.0 * g * x01
        z4 = sine * p1 + cosine * q1 + g * (x11 + y01)
        z5 = sine * p2 + cosine * q2 + t1 + 2.0 * g * y11
        d[at + Z0 * RUN], d[at + Z1 * RUN], d[at + Z2 * RUN] = z0, z1, z2
        d[at + Z3 * RUN], d[at + Z4 * RUN], d[at + Z5 * RUN] = z3, z4, z5
        per = irho * irho * d[at + ACTS * RUN]
        one, two = per * per_h, per * per_h2
        tension, n = pull(xx, xy, yy)
        per_strain = 6.0 / (shear * d[at + M * RUN] * irho)
        k = h * h * tension * spread(d, l, n) * per_strain
        a0, a1, a2, a3, a4, a5, energy = pulled(z0, z1, z2, z3, z4, z5, n, k, share)
        d[at + PULL * RUN] = per_strain * energy
        z0, z1, z2, z3, z4, z5 = z0 + a0, z1 + a1, z2 + a2, z3 + a3, z4 + a4, z5 + a5
        r0, r1, r2, r3, r4 = solved(fit, one * xx, one * xy, two * z0, two * (z1 + z3), two * z4)
        d[at + P0 * RUN], d[at + P1 * RUN], d[at + P2 * RUN], d[at + P3 * RUN], d[at + P4 * RUN] = r0, r1, r2, r3, r4
        r0, r1, r2, r3, r4 = solved(fit, one * xy, one * yy, two * z1, two * (z2 + z4), two * z5)
        d[at + R0 * RUN], d[at + R1 * RUN], d[at + R2 * RUN], d[at + R3 * RUN], d[at + R4 * RUN] = r0, r1, r2, r3, r4
        d[at + W0 * RUN], d[at + W1 * RUN] = d[12 * RUN + l], d[13 * RUN + l]
        d[at + W2 * RUN], d[at + W3 * RUN], d[at + W4 * RUN] = 0.5 * d[l], d[RUN + l], 0.5 * d[2 * RUN + l]


@ordered_njit
def quadratic_stress(chunk, blocks, S, code, h, material, dt):
    """Sums, deformation rate and stress of one chunk of blocks, with the quadratic gradient, after `dt` [s]."""
    own, pairs, d = np.empty(OWN_SIZE), np.empty(GROUP * PAIR_SIZE), np.empty(_WORK)
    for n in range(chunk * CHUNK, min(blocks.start.size, (chunk + 1) * CHUNK)):
        s, count = blocks.start[n], blocks.count[n]
        load_own(own, S, s, count)
        for c in range(SUMS * RUN):
            d[c] = 0.0
        for k in range(blocks.first[n], blocks.first[n + 1], GROUP):
            for g in range(GROUP):
                pair = pairs[g * PAIR_SIZE : (g + 1) * PAIR_SIZE]
                fit_pair(pair, own, S, s + blocks.distance[k + g], count, code, h)
            add_moments(d, pairs, count)
            add_differences(d, pairs, count)
        load_rows(d, _AT, S, s, count, ROWS)
        _material(d, count, material, h, dt)
        store_rows(d, _AT, S, s, count, ROWS)


@inline_njit
def _add_force(force, pair, S, first, p, count):
    """Add one component of the forces that neighbours from slot `p` on exert by their own stress."""
    a, b, c = S[first, p : p + count], S[first + 1, p : p + count], S[first + 2, p : p + count]
    d, e = S[first + 3, p : p + count], S[first + 4, p : p + count]
    for l in range(count):
        d0, d1, w = pair[l], pair[RUN + l], pair[2 * RUN + l]
        odd = a[l] * d0 + b[l] * d1
        force[l] += w * (odd - 0.5 * d0 * d0 * c[l] - d0 * d1 * d[l] - 0.5 * d1 * d1 * e[l])


@inline_njit
def _add_viscosity(force, pair, count):
    for l in range(count):
        force[l] += pair[3 * RUN + l] * pair[l]
        force[RUN + l] += pair[3 * RUN + l] * pair[RUN + l]


@ordered_njit
def quadratic_forces(chunk, blocks, S, code, h, viscosity):
    """Accelerations of one chunk of blocks by the stress that `quadratic_stress` left; `viscosity`: α h c [m²/s]."""
    own, pair, force = np.empty(OWN_SIZE), np.empty(PAIR_SIZE), np.empty(2 * RUN)
    fx, fy = force[:RUN], force[RUN:]
    for n in range(chunk * CHUNK, min(blocks.start.size, (chunk + 1) * CHUNK)):
        s, count = blocks.start[n], blocks.count[n]
        load_own(own, S, s, count)
        for l in range(2 * RUN):
            force[l] = 0.0
        for row in range(5):
            for l in range(count):
                fx[l] += S[P0 + row, s + l] * S[W0 + row, s + l]
            for l in range(count):
                fy[l] += S[R0 + row, s + l] * S[W0 + row, s + l]
        for k in range(blocks.first[n], blocks.first[n + 1]):
            p = s + blocks.distance[k]
            fit_force_pair(pair, own, S, p, count, code, h, viscosity)
            _add_force(fx, pair, S, P0, p, count)
            _add_force(fy, pair, S, R0, p, count)
            _add_viscosity(force, pair, count)
        for l in range(count):
            S[AX, s + l] = fx[l]
        for l in range(count):
            S[AY, s + l] = fy[l]
