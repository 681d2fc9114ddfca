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

_SINGULAR = 1.0e-3
"""Determinant of Σ V r ⊗ ∇W (1 in a full neighbourhood) below which a particle's gradient stays uncorrected."""


@parallel_njit
def velocity_gradients(x, u, mass, rho, first, neighbour, code, h, corrected, gradient, correction):
    """∇u into `gradient` (n, 4: xx, xy, yx, yy = ∂_j u_i row by row) and B into `correction` (n, 4)."""
    for a in prange(first.size - 1):
        g00 = g01 = g10 = g11 = 0.0
        m00 = m01 = m10 = m11 = 0.0
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1]
            f = kernel_f(code, r0 * r0 + r1 * r1, h) * mass[b] / rho[b]
            w0, w1 = f * r0, f * r1
            du, dv = u[b, 0] - u[a, 0], u[b, 1] - u[a, 1]
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
            # rows of M are (x_b − x_a)_i; ∇f = raw · M⁻¹ makes linear fields exact
            i00, i01, i10, i11 = m11 / det, -m01 / det, -m10 / det, m00 / det
        else:
            i00, i01, i10, i11 = 1.0, 0.0, 0.0, 1.0
        gradient[a, 0] = g00 * i00 + g01 * i10
        gradient[a, 1] = g00 * i01 + g01 * i11
        gradient[a, 2] = g10 * i00 + g11 * i10
        gradient[a, 3] = g10 * i01 + g11 * i11
        correction[a, 0], correction[a, 1], correction[a, 2], correction[a, 3] = i00, i01, i10, i11


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
def update_material(rho, stress, offset, gradient, correction, flux, material, dt):
    """ρ, S and tracer offsets over `dt` from ∇u, then σB/ρ² into `flux` (n, 4). `material`: G, c², ρ0."""
    shear_modulus, c_squared, rho0 = material
    for a in prange(rho.size):
        half = 0.5 * dt * (gradient[a, 0] + gradient[a, 3])
        rho[a] *= (1.0 - half) / (1.0 + half)
        stress[a, 0], stress[a, 1], stress[a, 2], stress[a, 3] = turned_stress(
            stress[a], gradient[a], shear_modulus, dt
        )
        offset[a, 0], offset[a, 1] = carried(offset[a], gradient[a], dt)
        pressure = c_squared * (rho[a] - rho0)
        xx, xy, yy = stress[a, 0] - pressure, stress[a, 1], stress[a, 2] - pressure
        per = 1.0 / (rho[a] * rho[a])
        i00, i01, i10, i11 = correction[a, 0], correction[a, 1], correction[a, 2], correction[a, 3]
        flux[a, 0] = per * (xx * i00 + xy * i01)
        flux[a, 1] = per * (xx * i10 + xy * i11)
        flux[a, 2] = per * (xy * i00 + yy * i01)
        flux[a, 3] = per * (xy * i10 + yy * i11)


@parallel_njit
def accelerations(x, u, mass, rho, flux, first, neighbour, code, h, viscosity, free, a_out, nearest):
    """du/dt by stress and artificial viscosity of the first `free` particles into `a_out` (free, 2).

    `viscosity`: α h c [m²/s]; `nearest` (n,): distance to the closest particle [m].
    """
    for a in prange(free):
        f0 = f1 = 0.0
        closest = math.inf
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1]
            r2 = r0 * r0 + r1 * r1
            f = kernel_f(code, r2, h) * mass[b]
            w0, w1 = f * r0, f * r1
            phi = ((u[a, 0] - u[b, 0]) * r0 + (u[a, 1] - u[b, 1]) * r1) / (r2 + 0.01 * h * h)
            pi = -viscosity * min(phi, 0.0) * 2.0 / (rho[a] + rho[b])
            f0 += (flux[a, 0] + flux[b, 0] - pi) * w0 + (flux[a, 1] + flux[b, 1]) * w1
            f1 += (flux[a, 2] + flux[b, 2]) * w0 + (flux[a, 3] + flux[b, 3] - pi) * w1
            closest = min(closest, r2)
        a_out[a, 0], a_out[a, 1] = f0, f1
        nearest[a] = math.sqrt(closest)


@njit
def moved_too_far(x, u, built, allowed, dt):
    """Whether a particle may be farther than `allowed` [m] from where the neighbour list saw it after one more step."""
    worst = 0.0
    for a in range(u.shape[0]):
        d0, d1 = x[a, 0] - built[a, 0], x[a, 1] - built[a, 1]
        distance = math.sqrt(d0 * d0 + d1 * d1) + dt * math.sqrt(u[a, 0] * u[a, 0] + u[a, 1] * u[a, 1])
        worst = max(worst, distance)
    return worst > allowed


@njit
def kicked(u, a, load, ramped, share, kick, free):
    """u ← e u + τφ (a + loads) for the first `free` particles; `kick`: (e, τφ)."""
    for p in range(free):
        for i in range(2):
            total = a[p, i] + load[p, i]
            for g in range(share.size):
                total += share[g] * ramped[g, p, i]
            u[p, i] = kick[0] * u[p, i] + kick[1] * total


@njit
def drifted(x, u, tau, free):
    """x ← x + τ u for the first `free` particles."""
    for p in range(free):
        x[p, 0] += tau * u[p, 0]
        x[p, 1] += tau * u[p, 1]


@njit
def extreme_state(rho, stress, nearest):
    """Smallest and largest ρ and largest nearest distance, with the particle of each; NaN and its particle if any."""
    low, high, gap = np.inf, 0.0, 0.0
    where = np.zeros(3, dtype=np.int64)
    for a in range(rho.size):
        if not np.isfinite(rho[a] + stress[a, 0] + stress[a, 1] + stress[a, 2]):
            where[:] = a
            return math.nan, math.nan, math.nan, where
        if rho[a] < low:
            low, where[0] = rho[a], a
        if rho[a] > high:
            high, where[1] = rho[a], a
    for a in range(nearest.size):
        if nearest[a] > gap:
            gap, where[2] = nearest[a], a
    return low, high, gap, where


@njit
def steps(now, material_state, sums, pairs, kernel, loads, kicks, numbers):
    """Take steps until `kicks` is used up, the neighbour list is outgrown, or shifting is due.

    `now`: x (n, 2), u (n, 2), a (free, 2); `material_state`: mass, ρ, S, tracer offsets; `sums`: ∇u, B, σB/ρ²,
    nearest distance; `pairs`: first, neighbour, positions at the list's making, allowed displacement; `kernel`:
    code, h; `loads`: steady (free, 2), ramped (g, free, 2), shares (steps + 1, g); `kicks`: (e, τφ) of half a step;
    `numbers`: dt, α h c, (G, c², ρ0), corrected, first step to take, distance that calls for shifting (n,).
    Returns the number of the next step and whether shifting is due. One step:

        1. u ← half a kick under the loads at its start     2. x ← x + ½ Δt u
        3. ∇u and B there; ρ, S, offsets over Δt            4. x ← x + ½ Δt u
        5. accelerations there                              6. u ← half a kick under the loads at its end
    """
    x, u, a = now
    mass, rho, stress, offset = material_state
    gradient, correction, flux, nearest = sums
    first, neighbour, built, allowed = pairs
    code, h = kernel
    steady, ramped, shares = loads
    dt, viscosity, material, corrected, begin, close = numbers
    free = a.shape[0]
    for n in range(begin, shares.shape[0] - 1):
        if n > begin and moved_too_far(x, u, built, allowed, dt):
            return n, False
        kicked(u, a, steady, ramped, shares[n], kicks, free)
        drifted(x, u, 0.5 * dt, free)
        velocity_gradients(x, u, mass, rho, first, neighbour, code, h, corrected, gradient, correction)
        update_material(rho, stress, offset, gradient, correction, flux, material, dt)
        drifted(x, u, 0.5 * dt, free)
        accelerations(x, u, mass, rho, flux, first, neighbour, code, h, viscosity, free, a, nearest)
        kicked(u, a, steady, ramped, shares[n + 1], kicks, free)
        if np.any(nearest < close):
            return n + 1, True
    return shares.shape[0] - 1, False
