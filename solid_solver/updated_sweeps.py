"""Compiled sweeps of the updated-Lagrangian solid: velocity gradient, rates of density and stress, forces.

Symbols as in the paper of Adepu & Ramachandran (CTVF): u velocity, ρ, p pressure, S deviatoric stress (xx, xy, yy, zz),
m mass, V = m/ρ, W kernel, f_ab = f_a − f_b, r_ab = x_a − x_b, ε̇ and Ω symmetric and skew part of ∇u.

    (∇u)_a = Σ_b V_b (u_b − u_a) ⊗ B_a ∇W_ab,   B_a = (Σ_b V_b (x_b − x_a) ⊗ ∇W_ab)⁻ᵀ        (linear) or I (printed)
    dρ/dt = −ρ ∇·u,   dS/dt = 2G (ε̇ − tr(ε̇) I/3) + S Ωᵀ + Ω S,   p = c² (ρ − ρ0),  c² = K/ρ0
    du_a/dt = Σ_b m_b [(σ_a B_a/ρ_a² + σ_b B_b/ρ_b²) − Π_ab I] ∇W_ab,   σ = S − p I
    Π_ab = −α h c φ/ρ̄ where φ = u_ab·r_ab/(r² + 0.01 h²) < 0

The rate of S is stated with the trace that the paper's print lacks. B in the force is the transpose of B in the gradient,
so that the stress does on the particles the work that it does on the strain.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from shared.jit import njit, parallel_njit
from shared.kernels import kernel_f
from solid_solver.shifting import short_range

_SINGULAR = 1.0e-3
"""Determinant of Σ V r ⊗ ∇W (1 in a full neighbourhood) below which a particle's gradient stays uncorrected."""


@parallel_njit
def velocity_gradients(x, u, volume, first, neighbour, code, h, corrected, gradient, correction):
    """∇u into `gradient` (4, n: xx, xy, yx, yy; ∂_j u_i row by row) and B into `correction` (4, n)."""
    px, py, ux, uy = x[0], x[1], u[0], u[1]
    for a in prange(first.size - 1):
        g00 = g01 = g10 = g11 = 0.0
        m00 = m01 = m10 = m11 = 0.0
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
            m10 -= r1 * w0
            m11 -= r1 * w1
        det = m00 * m11 - m01 * m10
        if corrected and det > _SINGULAR:
            # Σ V (f_b − f_a) ∇W = ∇f · M for linear f: the inverse of M makes the gradient exact.
            i00, i01, i10, i11 = m11 / det, -m01 / det, -m10 / det, m00 / det
        else:
            i00, i01, i10, i11 = 1.0, 0.0, 0.0, 1.0
        gradient[0, a] = g00 * i00 + g01 * i10
        gradient[1, a] = g00 * i01 + g01 * i11
        gradient[2, a] = g10 * i00 + g11 * i10
        gradient[3, a] = g10 * i01 + g11 * i11
        correction[0, a], correction[1, a], correction[2, a], correction[3, a] = i00, i01, i10, i11


@njit
def turned_stress(s, gradient, shear_modulus, dt):
    """S (xx, xy, yy, zz) after `dt` under a constant velocity gradient (xx, xy, yx, yy).

    The skew part turns S by the rotation of Cayley's transform, which is the Jaumann rate without its error in time
    (Hughes & Winget 1980): a rigid rotation leaves the principal stresses as they are.
    """
    xx, yy = gradient[0], gradient[3]
    xy = 0.5 * (gradient[1] + gradient[2])
    third = (xx + yy) / 3.0
    half = 0.25 * dt * (gradient[2] - gradient[1])
    cosine = (1.0 - half * half) / (1.0 + half * half)
    sine = 2.0 * half / (1.0 + half * half)
    c2, s2, cs = cosine * cosine, sine * sine, cosine * sine
    rate = 2.0 * shear_modulus * dt
    return (
        c2 * s[0] - 2.0 * cs * s[1] + s2 * s[2] + rate * (xx - third),
        cs * (s[0] - s[2]) + (c2 - s2) * s[1] + rate * xy,
        s2 * s[0] + 2.0 * cs * s[1] + c2 * s[2] + rate * (yy - third),
        s[3] - rate * third,
    )


@njit
def carried(offset, gradient, dt):
    """An `offset` (2,) from a particle to its material tracer after `dt`: advected by u_a + ∇u·offset (Cayley)."""
    a, b, c, d = 0.5 * dt * gradient[0], 0.5 * dt * gradient[1], 0.5 * dt * gradient[2], 0.5 * dt * gradient[3]
    p = (1.0 + a) * offset[0] + b * offset[1]
    q = c * offset[0] + (1.0 + d) * offset[1]
    det = (1.0 - a) * (1.0 - d) - b * c
    return ((1.0 - d) * p + b * q) / det, (c * p + (1.0 - a) * q) / det


@parallel_njit
def update_material(mass, volume, rho, stress, offset, gradient, correction, flux, material, dt):
    """ρ, V, S and tracer offsets over `dt` from ∇u, then σB/ρ² into `flux` (4, n). `material`: G, c², ρ0."""
    shear_modulus, c_squared, rho0 = material
    for a in prange(rho.size):
        grad = (gradient[0, a], gradient[1, a], gradient[2, a], gradient[3, a])
        half = 0.5 * dt * (grad[0] + grad[3])
        rho[a] *= (1.0 - half) / (1.0 + half)
        volume[a] = mass[a] / rho[a]
        s = turned_stress((stress[0, a], stress[1, a], stress[2, a], stress[3, a]), grad, shear_modulus, dt)
        stress[0, a], stress[1, a], stress[2, a], stress[3, a] = s
        offset[0, a], offset[1, a] = carried((offset[0, a], offset[1, a]), grad, dt)
        pressure = c_squared * (rho[a] - rho0)
        per = 1.0 / (rho[a] * rho[a])
        xx, xy, yy = per * (s[0] - pressure), per * s[1], per * (s[2] - pressure)
        i00, i01, i10, i11 = correction[0, a], correction[1, a], correction[2, a], correction[3, a]
        flux[0, a] = xx * i00 + xy * i01
        flux[1, a] = xx * i10 + xy * i11
        flux[2, a] = xy * i00 + yy * i01
        flux[3, a] = xy * i10 + yy * i11


@parallel_njit
def accelerations(x, u, mass, volume, flux, first, neighbour, code, h, viscosity, spacing, a_out, crowding):
    """du/dt by stress and artificial viscosity of the free particles into `a_out` (2, free).

    `viscosity`: α h c [m²/s]; `crowding` (free,): Σ w(r/s), see shifting.py; `spacing` (n,) [m].
    """
    px, py, ux, uy = x[0], x[1], u[0], u[1]
    t00, t01, t10, t11 = flux[0], flux[1], flux[2], flux[3]
    for a in prange(crowding.size):
        f0 = f1 = crowd = 0.0
        x0, x1, u0, u1 = px[a], py[a], ux[a], uy[a]
        s00, s01, s10, s11 = t00[a], t01[a], t10[a], t11[a]
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
            f0 += (s00 + t00[b] - pi) * w0 + (s01 + t01[b]) * w1
            f1 += (s10 + t10[b]) * w0 + (s11 + t11[b] - pi) * w1
            crowd += short_range(math.sqrt(r2) / spacing[b])
        a_out[0, a], a_out[1, a] = f0, f1
        crowding[a] = crowd


@parallel_njit
def nearest_distances(x, first, neighbour, spacing, nearest):
    """Smallest r/s over the neighbours of each of the free particles into `nearest` (free,); `spacing`: s by neighbour."""
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

    `now`: x (2, n), u (2, n), a (2, free); `material_state`: m, V, ρ, S, tracer offsets; `sums`: ∇u, B, σB/ρ²,
    crowding; `pairs`: first, neighbour, positions at the list's making, allowed displacement; `kernel`:
    code, h; `loads`: steady (2, free), ramped (g, 2, free), shares (steps + 1, g); `kicks`: (e, τφ) of half a step;
    `numbers`: dt, α h c, (G, c², ρ0), corrected, first step to take, spacings (n,), crowding that calls for
    shifting.
    Returns the number of the next step and whether shifting is due. One step:

        1. u ← half a kick under the loads at its start     2. x ← x + ½ Δt u
        3. ∇u and B there; ρ, S, offsets over Δt            4. x ← x + ½ Δt u
        5. accelerations there                              6. u ← half a kick under the loads at its end
    """
    x, u, a = now
    mass, volume, rho, stress, offset = material_state
    gradient, correction, flux, crowding = sums
    first, neighbour, built, allowed = pairs
    code, h = kernel
    steady, ramped, shares = loads
    dt, viscosity, material, corrected, begin, spacing, crowded = numbers
    free = a.shape[1]
    for n in range(begin, shares.shape[0] - 1):
        if n > begin and moved_too_far(x, u, built, allowed, dt):
            return n, False
        kicked(u, a, steady, ramped, shares[n], kicks)
        drifted(x, u, 0.5 * dt, free)
        velocity_gradients(x, u, volume, first, neighbour, code, h, corrected, gradient, correction)
        update_material(mass, volume, rho, stress, offset, gradient, correction, flux, material, dt)
        drifted(x, u, 0.5 * dt, free)
        accelerations(x, u, mass, volume, flux, first, neighbour, code, h, viscosity, spacing, a, crowding)
        kicked(u, a, steady, ramped, shares[n + 1], kicks)
        if np.any(crowding > crowded):
            return n + 1, True
    return shares.shape[0] - 1, False
