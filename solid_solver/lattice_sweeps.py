"""Compiled sweeps of the total-Lagrangian solid: derivatives by the fit, internal forces, time steps.

Symbols: u, v, a displacement, velocity, acceleration; D_i = (∂0, ∂1, ∂00, ∂01, ∂11) u_i along the lattice's own axes;
energy and stress as in strain_gradient.py. The force on a particle is minus the derivative of the summed energy: the
transpose of the fit applied to the energy's derivatives by D. Fields over the padded slots are kept as planes:
(2, slots) vectors, (10, slots) stresses. Clamps in motion add to D what stencil.py's `Driven` says, times the present
`sizes` (g, 2) of their fields.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from shared.jit import inline_njit, njit, parallel_njit
from solid_solver.stencil import RUN
from solid_solver.strain_gradient import STRAINS, stresses

SUMS = 10
"""Derivatives of both displacement components."""

SCRATCH = (SUMS + STRAINS) * RUN

SHORT = 5
"""Particles from which a run is worth a loop over its particles: about half a vector register."""


@njit
def _derivatives_one_by_one(d, u, s, count, first, last, distance, coefficient):
    """As `_derivatives`, for runs too short for a loop over their particles."""
    ux = u[0]
    uy = u[1]
    for l in range(count):
        x0 = x1 = x2 = x3 = x4 = y0 = y1 = y2 = y3 = y4 = 0.0
        for k in range(first, last):
            p = s + l + distance[k]
            f, g = ux[p], uy[p]
            c0, c1, c2, c3, c4 = coefficient[k]
            x0 += c0 * f
            x1 += c1 * f
            x2 += c2 * f
            x3 += c3 * f
            x4 += c4 * f
            y0 += c0 * g
            y1 += c1 * g
            y2 += c2 * g
            y3 += c3 * g
            y4 += c4 * g
        d[l], d[l + RUN], d[l + 2 * RUN], d[l + 3 * RUN], d[l + 4 * RUN] = x0, x1, x2, x3, x4
        d[l + 5 * RUN], d[l + 6 * RUN], d[l + 7 * RUN], d[l + 8 * RUN], d[l + 9 * RUN] = y0, y1, y2, y3, y4


@njit
def _derivatives(d, u, s, count, first, last, distance, coefficient):
    """D of `count` particles from slot `s` on into d[c RUN + l], c = 5 i + derivative."""
    if count < SHORT:
        _derivatives_one_by_one(d, u, s, count, first, last, distance, coefficient)
        return
    d[: SUMS * RUN] = 0.0
    ux = u[0]
    uy = u[1]
    for k in range(first, last, 3):
        p, q, r = s + distance[k], s + distance[k + 1], s + distance[k + 2]
        a0, a1, a2, a3, a4 = coefficient[k]
        b0, b1, b2, b3, b4 = coefficient[k + 1]
        c0, c1, c2, c3, c4 = coefficient[k + 2]
        xp, xq, xr = ux[p : p + count], ux[q : q + count], ux[r : r + count]
        yp, yq, yr = uy[p : p + count], uy[q : q + count], uy[r : r + count]
        for l in range(count):
            f, g, h = xp[l], xq[l], xr[l]
            d[l] += a0 * f + b0 * g + c0 * h
            d[l + RUN] += a1 * f + b1 * g + c1 * h
            d[l + 2 * RUN] += a2 * f + b2 * g + c2 * h
            d[l + 3 * RUN] += a3 * f + b3 * g + c3 * h
            d[l + 4 * RUN] += a4 * f + b4 * g + c4 * h
            f, g, h = yp[l], yq[l], yr[l]
            d[l + 5 * RUN] += a0 * f + b0 * g + c0 * h
            d[l + 6 * RUN] += a1 * f + b1 * g + c1 * h
            d[l + 7 * RUN] += a2 * f + b2 * g + c2 * h
            d[l + 8 * RUN] += a3 * f + b3 * g + c3 * h
            d[l + 9 * RUN] += a4 * f + b4 * g + c4 * h


@inline_njit
def _add_driven(d, n, driven, sizes):
    """Add to D in `d` what clamps in motion contribute to run `n`."""
    first, place, field, weight = driven
    for k in range(first[n], first[n + 1]):
        l = place[k]
        ux, uy = sizes[field[k], 0], sizes[field[k], 1]
        for c in range(5):
            d[l + c * RUN] += weight[k, c] * ux
            d[l + (5 + c) * RUN] += weight[k, c] * uy


@njit
def _forces(f, stress, s, count, first, last, distance, coefficient):
    """Force per volume of `count` particles from slot `s` on, into f[l] (x) and f[l + RUN] (y)."""
    if count < SHORT:
        for l in range(count):
            fx = fy = 0.0
            for k in range(first, last):
                p = s + l + distance[k]
                for c in range(5):
                    fx += coefficient[k, c] * stress[c, p]
                    fy += coefficient[k, c] * stress[5 + c, p]
            f[l], f[l + RUN] = fx, fy
        return
    f[: 2 * RUN] = 0.0
    for i in range(2):
        g = f[i * RUN : (i + 1) * RUN]
        t0, t1, t2, t3, t4 = stress[5 * i], stress[5 * i + 1], stress[5 * i + 2], stress[5 * i + 3], stress[5 * i + 4]
        for k in range(first, last, 3):
            p, q, r = s + distance[k], s + distance[k + 1], s + distance[k + 2]
            a0, a1, a2, a3, a4 = coefficient[k]
            b0, b1, b2, b3, b4 = coefficient[k + 1]
            c0, c1, c2, c3, c4 = coefficient[k + 2]
            p0, p1, p2, p3, p4 = t0[p:], t1[p:], t2[p:], t3[p:], t4[p:]
            q0, q1, q2, q3, q4 = t0[q:], t1[q:], t2[q:], t3[q:], t4[q:]
            r0, r1, r2, r3, r4 = t0[r:], t1[r:], t2[r:], t3[r:], t4[r:]
            for l in range(count):
                sum_p = a0 * p0[l] + a1 * p1[l] + a2 * p2[l] + a3 * p3[l] + a4 * p4[l]
                sum_q = b0 * q0[l] + b1 * q1[l] + b2 * q2[l] + b3 * q3[l] + b4 * q4[l]
                sum_r = c0 * r0[l] + c1 * r1[l] + c2 * r2[l] + c3 * r3[l] + c4 * r4[l]
                g[l] += sum_p + sum_q + sum_r


@njit
def _stress_of_chunk(chunk, u, stress, strain, d, forward, driven, sizes, axes, moment, lam, mu, tau):
    """Stresses of the runs of one chunk."""
    run, bound, first, distance, coefficient = forward
    for n in range(bound[chunk], bound[chunk + 1]):
        s, count, c, body = run[n, 0], run[n, 1], run[n, 2], run[n, 3]
        _derivatives(d, u, s, count, first[c], first[c + 1], distance, coefficient)
        _add_driven(d, n, driven, sizes)
        for plane in range(STRAINS):
            for l in range(count):
                d[(SUMS + plane) * RUN + l] = strain[plane, s + l]
        stresses(d, count, axes[body], moment[body], lam, mu, tau)
        for plane in range(SUMS):
            for l in range(count):
                stress[plane, s + l] = d[plane * RUN + l]
        for plane in range(STRAINS):
            for l in range(count):
                strain[plane, s + l] = d[(SUMS + plane) * RUN + l]


@njit
def _motion_of_chunk(chunk, u, v, a, stress, f, transposed, load, ramped, share, kick, drift, density):
    """Forces of the runs of one chunk, then kick and drift of their particles.

    `kick`: factors (e, τφ) of v ← e v + τφ a; `drift` [s]; `share` (g,): present factors of the `ramped` loads.
    """
    run, bound, first, distance, coefficient = transposed
    for n in range(bound[chunk], bound[chunk + 1]):
        s, count, c = run[n, 0], run[n, 1], run[n, 2]
        _forces(f, stress, s, count, first[c], first[c + 1], distance, coefficient)
        for i in range(2):
            for l in range(count):
                a[i, s + l] = f[i * RUN + l] / density
            for l in range(count):
                f[i * RUN + l] = a[i, s + l] + load[i, s + l]
            for g in range(share.size):
                for l in range(count):
                    f[i * RUN + l] += share[g] * ramped[g, i, s + l]
            for l in range(count):
                v[i, s + l] = kick[0] * v[i, s + l] + kick[1] * f[i * RUN + l]
            for l in range(count):
                u[i, s + l] += drift * v[i, s + l]


@parallel_njit
def steps(now, planes, gathers, clamps, axes, moment, material, loads, kicks, dt):
    """Advance by `shares.shape[0]` steps of `dt` [s]: stress sweep, then force, kick and drift, for each.

    On entry u has drifted and v stands half a step behind it; on return v is complete at u's time. `now`: u, v, a;
    `planes`: stress (10, slots), strain (9, slots), scratch (chunks, SCRATCH); `gathers`: forward, transposed of
    stencil.py; `clamps`: its driven entries, and the sizes of their fields after each step (steps, g, 2); `material`:
    λ, μ [Pa], ρ [kg/m³], and the viscosity's τ over dt; `loads`: steady (2, slots), ramped (g, 2, slots), shares
    (steps, g); `kicks` (2, 2): factors (e, τφ) of a whole and of a half step, the half for the last.
    """
    u, v, a = now
    stress, strain, scratch = planes
    forward, transposed = gathers
    driven, sizes = clamps
    lam, mu, density, tau = material
    load, ramped, shares = loads
    count = shares.shape[0]
    for n in range(count):
        last = n == count - 1
        kick = kicks[1] if last else kicks[0]
        drift = 0.0 if last else dt
        share = shares[n]
        for k in prange(forward[1].size - 1):
            c = np.uint64(k)
            _stress_of_chunk(c, u, stress, strain, scratch[c], forward, driven, sizes[n], axes, moment, lam, mu, tau)
        for k in prange(transposed[1].size - 1):
            c = np.uint64(k)
            _motion_of_chunk(c, u, v, a, stress, scratch[c], transposed, load, ramped, share, kick, drift, density)


@njit
def _derivatives_of_chunk(chunk, u, planes, d, forward, driven, sizes):
    run, bound, first, distance, coefficient = forward
    for n in range(bound[chunk], bound[chunk + 1]):
        s, count, c = run[n, 0], run[n, 1], run[n, 2]
        _derivatives(d, u, s, count, first[c], first[c + 1], distance, coefficient)
        _add_driven(d, n, driven, sizes)
        for plane in range(SUMS):
            for l in range(count):
                planes[plane, s + l] = d[plane * RUN + l]


@parallel_njit
def derivative_sweep(u, planes, scratch, forward, driven, sizes):
    """D of displacements `u` at every particle into `planes` (10, slots); `sizes` (g, 2) of the clamps' fields."""
    for c in prange(forward[1].size - 1):
        _derivatives_of_chunk(np.uint64(c), u, planes, scratch[c], forward, driven, sizes)
