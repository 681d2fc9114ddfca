"""Compiled sweeps of the updated-Lagrangian solid: velocity derivatives and forces.

Symbols as in the paper of Adepu & Ramachandran (CTVF): u velocity, ρ, p pressure, S deviatoric stress (xx, xy, yy, zz),
m mass, V = m/ρ, W kernel, ∇W = F r_ab, r_ab = x_a − x_b, ε̇ and Ω symmetric and skew part of ∇u.

    (∇u)_a = Σ_b V_b (u_b − u_a) ⊗ B_a ∇W_ab,   B_a = M_a⁻ᵀ (linear) or I (printed),   M = Σ V_b (x_b − x_a) ⊗ ∇W_ab
    (∇²u)_a = k_a [Σ_b V_b |F_ab| (u_b − u_a) − ∇u_a·s_a],   s_a = Σ V_b |F_ab| (x_b − x_a),   k_a = 4/tr M_a
    du_a/dt = Σ_b m_b [(T_a B_aᵀ/ρ_a² + T_b B_bᵀ/ρ_b² − Π_ab I) ∇W_ab + |F_ab| (k_a Q_a/ρ_a² − k_b Q_b/ρ_b²)]
    T = σ − k Q ⊗ s,   σ = S − p I,   Π_ab = −α h c φ/ρ̄ where φ = u_ab·r_ab/(r² + 0.01 h²) < 0

∇u is exact for linear fields, ∇²u zero for them. Forces are the exact transpose of these derivatives, so that σ and Q
(see updated_material.py) do on the particles the work that they do on the material, and momentum is kept.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from shared.jit import njit, parallel_njit
from shared.kernels import kernel_f
from solid_solver.shifting import short_range
from solid_solver.updated_material import update_material
from solid_solver.updated_quadratic import quadratic_accelerations, quadratic_derivatives, quadratic_flux

_SINGULAR = 1.0e-3
"""Determinant of M (1 in a full neighbourhood) below which a particle's gradient stays uncorrected."""


@parallel_njit
def velocity_derivatives(x, u, volume, first, neighbour, code, h, corrected, derivatives, correction):
    """∇u (xx, xy, yx, yy; ∂_j u_i row by row) and ∇²u into `derivatives` (6, n); B, k, s into `correction` (7, n)."""
    px, py, ux, uy = x[0], x[1], u[0], u[1]
    for a in prange(first.size - 1):
        g00 = g01 = g10 = g11 = 0.0
        m00 = m01 = m11 = s0 = s1 = l0 = l1 = 0.0
        x0, x1, u0, u1 = px[a], py[a], ux[a], uy[a]
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x0 - px[b], x1 - py[b]
            f = kernel_f(code, r0 * r0 + r1 * r1, h) * volume[b]
            w0, w1 = f * r0, f * r1
            du, dv = ux[b] - u0, uy[b] - u1
            g00 += du * w0
            g01 += du * w1
            g10 += dv * w0
            g11 += dv * w1
            m00 -= r0 * w0
            m01 -= r0 * w1
            m11 -= r1 * w1
            s0 += w0
            s1 += w1
            l0 -= f * du
            l1 -= f * dv
        det = m00 * m11 - m01 * m01
        if corrected and det > _SINGULAR:
            # Σ V (f_b − f_a) ∇W = ∇f · M for linear f: the inverse of M makes the gradient exact.
            i00, i01, i10, i11 = m11 / det, -m01 / det, -m01 / det, m00 / det
        else:
            i00, i01, i10, i11 = 1.0, 0.0, 0.0, 1.0
        xx, xy = g00 * i00 + g01 * i10, g00 * i01 + g01 * i11
        yx, yy = g10 * i00 + g11 * i10, g10 * i01 + g11 * i11
        k = 4.0 / max(m00 + m11, _SINGULAR)
        derivatives[0, a], derivatives[1, a], derivatives[2, a], derivatives[3, a] = xx, xy, yx, yy
        derivatives[4, a], derivatives[5, a] = k * (l0 - xx * s0 - xy * s1), k * (l1 - yx * s0 - yy * s1)
        correction[0, a], correction[1, a], correction[2, a], correction[3, a] = i00, i01, i10, i11
        correction[4, a], correction[5, a], correction[6, a] = k, s0, s1


@parallel_njit
def accelerations(x, u, mass, volume, flux, first, neighbour, code, h, viscosity, spacing, a_out, crowding):
    """du/dt by stresses and artificial viscosity of the free particles into `a_out` (2, free).

    `viscosity`: α h c [m²/s]; `crowding` (free,): Σ w(r/s), see shifting.py; `spacing` (n,) [m].
    """
    px, py, ux, uy = x[0], x[1], u[0], u[1]
    t00, t01, t10, t11, q0, q1 = flux[0], flux[1], flux[2], flux[3], flux[4], flux[5]
    for a in prange(crowding.size):
        f0 = f1 = crowd = 0.0
        x0, x1, u0, u1 = px[a], py[a], ux[a], uy[a]
        s00, s01, s10, s11, p0, p1 = t00[a], t01[a], t10[a], t11[a], q0[a], q1[a]
        half_density = 0.5 * mass[a] / volume[a]
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x0 - px[b], x1 - py[b]
            r2 = r0 * r0 + r1 * r1
            m, v = mass[b], volume[b]
            f = kernel_f(code, r2, h) * m
            w0, w1 = f * r0, f * r1
            approach = min(0.0, (u0 - ux[b]) * r0 + (u1 - uy[b]) * r1)
            pi = -viscosity * approach * v / ((r2 + 0.01 * h * h) * (half_density * v + 0.5 * m))
            f0 += (s00 + t00[b] - pi) * w0 + (s01 + t01[b]) * w1 - f * (p0 - q0[b])
            f1 += (s10 + t10[b]) * w0 + (s11 + t11[b] - pi) * w1 - f * (p1 - q1[b])
            crowd += short_range(math.sqrt(r2) / spacing[b])
        a_out[0, a], a_out[1, a] = f0, f1
        crowding[a] = crowd


@parallel_njit
def nearest_distances(x, first, neighbour, spacing, nearest):
    """Smallest r/s over the neighbours of each free particle into `nearest` (free,); `spacing`: s by neighbour."""
    for a in prange(nearest.size):
        closest = math.inf
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r2 = (x[0, a] - x[0, b]) ** 2 + (x[1, a] - x[1, b]) ** 2
            closest = min(closest, r2 / (spacing[b] * spacing[b]))
        nearest[a] = math.sqrt(closest)


@njit
def moved_too_far(x, u, built, allowed, dt):
    """Whether a particle may be farther than `allowed` [m] from where the neighbour list saw it after one more step."""
    worst = 0.0
    for a in range(u.shape[1]):
        d0, d1 = x[0, a] - built[0, a], x[1, a] - built[1, a]
        distance = math.sqrt(d0 * d0 + d1 * d1) + dt * math.sqrt(u[0, a] * u[0, a] + u[1, a] * u[1, a])
        worst = max(worst, distance)
    return worst > allowed


@njit
def kicked(u, a, load, ramped, share, kick):
    """u ← e u + τφ (a + loads) for the free particles; `kick`: (e, τφ)."""
    for i in range(2):
        for p in range(a.shape[1]):
            total = a[i, p] + load[i, p]
            for g in range(share.size):
                total += share[g] * ramped[g, i, p]
            u[i, p] = kick[0] * u[i, p] + kick[1] * total


@njit
def drifted(x, u, tau, free):
    """x ← x + τ u for the first `free` particles."""
    for i in range(2):
        for p in range(free):
            x[i, p] += tau * u[i, p]


@njit
def extreme_density(rho, stress):
    """Smallest and largest ρ with the particle of each; NaN and its particle if the state is not finite."""
    low, high, lowest, highest = np.inf, 0.0, 0, 0
    for a in range(rho.size):
        if not np.isfinite(rho[a] + stress[0, a] + stress[1, a] + stress[2, a]):
            return math.nan, math.nan, a, a
        if rho[a] < low:
            low, lowest = rho[a], a
        if rho[a] > high:
            high, highest = rho[a], a
    return low, high, lowest, highest


@njit
def steps(now, material_state, sums, pairs, kernel, loads, kicks, numbers):
    """Take steps until `kicks` is used up, the neighbour list is outgrown, or shifting is due.

    `now`: x (2, n), u (2, n), a (2, free); `material_state`: m, V, ρ, S, Q or Z, tracer offsets; `sums`: derivatives,
    correction, flux, crowding, and the fits and scratch of updated_quadratic.py; `pairs`: first, neighbour, positions
    at the list's making, allowed displacement; `kernel`: code, h; `loads`: steady (2, free), ramped (g, 2, free),
    shares (steps + 1, g); `kicks`: (e, τφ) of half a step; `numbers`: dt, α h c, (G, c², ρ0, E'), order of the
    gradient (0: as printed), first step to take, spacings (n,), crowding that calls for shifting.
    Returns the number of the next step and whether shifting is due. One step:

        1. u ← half a kick under the loads at its start     2. x ← x + ½ Δt u
        3. ∇u, ∇²u there; ρ, S, Q, offsets over Δt            4. x ← x + ½ Δt u
        5. accelerations there                              6. u ← half a kick under the loads at its end
    """
    x, u, a = now
    mass, volume, rho, stress, curvature, offset = material_state
    derivatives, correction, flux, crowding, fits, scratch = sums
    first, neighbour, built, allowed = pairs
    code, h = kernel
    steady, ramped, shares = loads
    dt, viscosity, material, order, begin, spacing, crowded = numbers
    free = a.shape[1]
    for n in range(begin, shares.shape[0] - 1):
        if n > begin and moved_too_far(x, u, built, allowed, dt):
            return n, False
        kicked(u, a, steady, ramped, shares[n], kicks)
        drifted(x, u, 0.5 * dt, free)
        if order == 2:
            quadratic_derivatives(x, u, volume, first, neighbour, code, h, derivatives, fits, scratch)
        else:
            velocity_derivatives(x, u, volume, first, neighbour, code, h, order == 1, derivatives, correction)
        update_material(mass, volume, rho, stress, curvature, offset, derivatives, correction, flux, material, dt)
        drifted(x, u, 0.5 * dt, free)
        if order == 2:
            quadratic_flux(volume, rho, stress, curvature, derivatives, fits, flux, material, dt)
            quadratic_accelerations(
                x, u, mass, volume, flux, first, neighbour, code, h, viscosity, spacing, a, crowding
            )
        else:
            accelerations(x, u, mass, volume, flux, first, neighbour, code, h, viscosity, spacing, a, crowding)
        kicked(u, a, steady, ramped, shares[n + 1], kicks)
        if np.any(crowding > crowded):
            return n + 1, True
    return shares.shape[0] - 1, False
