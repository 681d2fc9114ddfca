"""Compiled sweeps of the total-Lagrangian solid: strain and stress, internal forces, time steps.

Symbols: ξ_K the lattice's own axes in the reference state, e_K their directions, D_i = (∂0, ∂1, ∂00, ∂01, ∂11) u_i,

    F_iK = e_K,i + ∂_K u_i,   F,k = ∂_k F,   E = ½ (Fᵀ F − I),   E,k = sym(Fᵀ F,k),   C:E = λ tr(E) I + 2 μ E.

The energy of a cell of volume V and sides d_k, integrated with the strain's linear variation (natural stabilisation of
nodal integration, after Hillman & Chen 2016, at finite strain, with St. Venant-Kirchhoff's law), is

    V [ ½ E:C:E + Σ_k d_k²/12 · ½ E,k:C:E,k ],

and its derivatives by F and F,k, with S = C:E and Z_k = C:E,k, are

    ∂/∂F = F S + Σ_k d_k²/12 F,k Z_k,        ∂/∂F,k = d_k²/12 F Z_k.

Artificial viscosity is of Kelvin and Voigt's kind, S = C:(E + τ Ė) and Z_k = C:(E,k + τ Ė,k): it acts on the lattice's
own highest modes (ω τ ~ 1), which elasticity alone would let ring for ever and a lagged fluid load would feed. Ė is the
difference to the strain of the step before, so that it costs no second fit, and rotations cost no energy.

The force on a particle is minus the derivative of the summed energy: the transpose of the fit applied to these.
Fields over the padded slots are kept as planes: (2, slots) vectors, (10, slots) stresses.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from shared.jit import njit, parallel_njit
from solid_solver.stencil import RUN

SUMS = 10
"""Derivatives of both displacement components."""

STRAINS = 9
"""Components of E, E,0 and E,1 kept from the step before, as planes (9, slots)."""

SCRATCH = SUMS * RUN

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
    d[:] = 0.0
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


@njit
def _stresses(d, count, strain, s, axes, moment, lam, mu, tau):
    """Turn D in `d` into minus the energy's derivative per volume by D, in place (see the module's text).

    `strain` (9, slots): strains of the step before, replaced by the present ones, from slot `s` on; `axes` (2, 2): rows
    e_K; `moment` (2,): d_k²/12 [m²]; `lam`, `mu`: Lamé's λ and μ [Pa]; `tau`: τ over the time step.
    """
    o0, o1, o2 = strain[0, s : s + count], strain[1, s : s + count], strain[2, s : s + count]
    o3, o4, o5 = strain[3, s : s + count], strain[4, s : s + count], strain[5, s : s + count]
    o6, o7, o8 = strain[6, s : s + count], strain[7, s : s + count], strain[8, s : s + count]
    e00, e01, e10, e11 = axes[0, 0], axes[1, 0], axes[0, 1], axes[1, 1]
    m0, m1 = moment[0], moment[1]
    for l in range(count):
        g00, g01, g10, g11 = d[l], d[l + RUN], d[l + 5 * RUN], d[l + 6 * RUN]
        a00, a01, a10, a11 = d[l + 2 * RUN], d[l + 3 * RUN], d[l + 7 * RUN], d[l + 8 * RUN]
        b01, b11 = d[l + 4 * RUN], d[l + 9 * RUN]
        f00, f01, f10, f11 = e00 + g00, e01 + g01, e10 + g10, e11 + g11
        # E from displacement gradients: FᵀF − I would lose the digits of small strains.
        x00 = e00 * g00 + e10 * g10 + 0.5 * (g00 * g00 + g10 * g10)
        x11 = e01 * g01 + e11 * g11 + 0.5 * (g01 * g01 + g11 * g11)
        x01 = 0.5 * (e00 * g01 + e10 * g11 + e01 * g00 + e11 * g10 + g00 * g01 + g10 * g11)
        y00 = f00 * a00 + f10 * a10
        y11 = f01 * a01 + f11 * a11
        y01 = 0.5 * (f00 * a01 + f10 * a11 + f01 * a00 + f11 * a10)
        z00 = f00 * a01 + f10 * a11
        z11 = f01 * b01 + f11 * b11
        z01 = 0.5 * (f00 * b01 + f10 * b11 + f01 * a01 + f11 * a11)
        x00, o0[l] = x00 + tau * (x00 - o0[l]), x00
        x11, o1[l] = x11 + tau * (x11 - o1[l]), x11
        x01, o2[l] = x01 + tau * (x01 - o2[l]), x01
        y00, o3[l] = y00 + tau * (y00 - o3[l]), y00
        y11, o4[l] = y11 + tau * (y11 - o4[l]), y11
        y01, o5[l] = y01 + tau * (y01 - o5[l]), y01
        z00, o6[l] = z00 + tau * (z00 - o6[l]), z00
        z11, o7[l] = z11 + tau * (z11 - o7[l]), z11
        z01, o8[l] = z01 + tau * (z01 - o8[l]), z01
        trace = lam * (x00 + x11)
        s00, s11, s01 = trace + 2.0 * mu * x00, trace + 2.0 * mu * x11, 2.0 * mu * x01
        trace = m0 * lam * (y00 + y11)
        p00, p11, p01 = trace + 2.0 * m0 * mu * y00, trace + 2.0 * m0 * mu * y11, 2.0 * m0 * mu * y01
        trace = m1 * lam * (z00 + z11)
        q00, q11, q01 = trace + 2.0 * m1 * mu * z00, trace + 2.0 * m1 * mu * z11, 2.0 * m1 * mu * z01
        d[l] = -(f00 * s00 + f01 * s01 + a00 * p00 + a01 * p01 + a01 * q00 + b01 * q01)
        d[l + RUN] = -(f00 * s01 + f01 * s11 + a00 * p01 + a01 * p11 + a01 * q01 + b01 * q11)
        d[l + 2 * RUN] = -(f00 * p00 + f01 * p01)
        d[l + 3 * RUN] = -(f00 * p01 + f01 * p11 + f00 * q00 + f01 * q01)
        d[l + 4 * RUN] = -(f00 * q01 + f01 * q11)
        d[l + 5 * RUN] = -(f10 * s00 + f11 * s01 + a10 * p00 + a11 * p01 + a11 * q00 + b11 * q01)
        d[l + 6 * RUN] = -(f10 * s01 + f11 * s11 + a10 * p01 + a11 * p11 + a11 * q01 + b11 * q11)
        d[l + 7 * RUN] = -(f10 * p00 + f11 * p01)
        d[l + 8 * RUN] = -(f10 * p01 + f11 * p11 + f10 * q00 + f11 * q01)
        d[l + 9 * RUN] = -(f10 * q01 + f11 * q11)


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
        for k in range(first, last):
            p = s + distance[k]
            q = p + count
            t0, t1, t2 = stress[5 * i, p:q], stress[5 * i + 1, p:q], stress[5 * i + 2, p:q]
            t3, t4 = stress[5 * i + 3, p:q], stress[5 * i + 4, p:q]
            c0, c1, c2, c3, c4 = coefficient[k]
            for l in range(count):
                g[l] += c0 * t0[l] + c1 * t1[l] + c2 * t2[l] + c3 * t3[l] + c4 * t4[l]


@njit
def _stress_of_chunk(chunk, u, stress, strain, d, forward, axes, moment, lam, mu, tau):
    """Stresses of the runs of one chunk."""
    run, bound, first, distance, coefficient = forward
    for n in range(bound[chunk], bound[chunk + 1]):
        s, count, c, body = run[n, 0], run[n, 1], run[n, 2], run[n, 3]
        _derivatives(d, u, s, count, first[c], first[c + 1], distance, coefficient)
        _stresses(d, count, strain, s, axes[body], moment[body], lam, mu, tau)
        for plane in range(SUMS):
            for l in range(count):
                stress[plane, s + l] = d[plane * RUN + l]


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
def steps(now, planes, gathers, axes, moment, material, loads, kicks, dt):
    """Advance by `shares.shape[0]` steps of `dt` [s]: stress sweep, then force, kick and drift, for each.

    On entry u has drifted and v stands half a step behind it; on return v is complete at u's time. `now`: u, v, a;
    `planes`: stress (10, slots), strain (9, slots), scratch (chunks, SCRATCH); `gathers`: forward, transposed of stencil.py;
    `material`: λ, μ [Pa], ρ [kg/m³], and the viscosity's τ over dt; `loads`: steady (2, slots), ramped (g, 2, slots), shares
    (steps, g); `kicks` (2, 2): factors (e, τφ) of a whole and of a half step, the half for the last.
    """
    u, v, a = now
    stress, strain, scratch = planes
    forward, transposed = gathers
    lam, mu, density, tau = material
    load, ramped, shares = loads
    count = shares.shape[0]
    for n in range(count):
        last = n == count - 1
        kick = kicks[1] if last else kicks[0]
        drift = 0.0 if last else dt
        share = shares[n]
        for c in prange(forward[1].size - 1):
            _stress_of_chunk(c, u, stress, strain, scratch[c], forward, axes, moment, lam, mu, tau)
        for c in prange(transposed[1].size - 1):
            _motion_of_chunk(c, u, v, a, stress, scratch[c], transposed, load, ramped, share, kick, drift, density)


@njit
def _derivatives_of_chunk(chunk, u, planes, d, forward):
    run, bound, first, distance, coefficient = forward
    for n in range(bound[chunk], bound[chunk + 1]):
        s, count, c = run[n, 0], run[n, 1], run[n, 2]
        _derivatives(d, u, s, count, first[c], first[c + 1], distance, coefficient)
        for plane in range(SUMS):
            for l in range(count):
                planes[plane, s + l] = d[plane * RUN + l]


@parallel_njit
def derivative_sweep(u, planes, scratch, forward):
    """D of displacements `u` at every particle into `planes` (10, slots)."""
    for c in prange(forward[1].size - 1):
        _derivatives_of_chunk(c, u, planes, scratch[c], forward)


@njit
def extremes(planes, slot, axis_of):
    """Smallest det F with its particle, and the largest principal stretch squared, from D in `planes`.

    `axis_of` (n, 2, 2): rows e_K of each particle's lattice. A NaN gives det F = NaN.
    """
    worst, where, stretch = np.inf, 0, 1.0
    for a in range(slot.size):
        s = slot[a]
        f00, f01 = axis_of[a, 0, 0] + planes[0, s], axis_of[a, 1, 0] + planes[1, s]
        f10, f11 = axis_of[a, 0, 1] + planes[5, s], axis_of[a, 1, 1] + planes[6, s]
        # The longer direction first may turn the frame left-handed: F relative to its own axes keeps the sign right.
        hand = axis_of[a, 0, 0] * axis_of[a, 1, 1] - axis_of[a, 0, 1] * axis_of[a, 1, 0]
        det = hand * (f00 * f11 - f01 * f10)
        c00, c11, c01 = f00 * f00 + f10 * f10, f01 * f01 + f11 * f11, f00 * f01 + f10 * f11
        largest = 0.5 * (c00 + c11) + np.sqrt(0.25 * (c00 - c11) ** 2 + c01 * c01)
        if not np.isfinite(det):
            return det, a, stretch
        if det < worst:
            worst, where = det, a
        stretch = max(stretch, largest)
    return worst, where, stretch
