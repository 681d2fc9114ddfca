"""Pointwise updates of the updated-Lagrangian solid: density, stress, curvature stress and tracer over a step.

    dρ/dt = −ρ ∇·u,   dS/dt = 2G (ε̇ − tr(ε̇) I/3) + S Ωᵀ + Ω S,   p = c² (ρ − ρ0),  c² = K/ρ0
    dQ/dt = E' V/12 ∇²u + Ω Q,   E' = E/(1 − ν²)

The rate of S is stated with the trace that the paper's print lacks. Q is not in the paper: it belongs to the energy
V/12 · ½ E' |∇²u|² of the strain's variation over a cell, which the stress at the particle does not see. That is what
bending about the particle itself costs, and it makes the modes stiff that alternate from particle to particle: without
it a strip pulled by 4 % pairs its particles and breaks. Nothing to tune.
"""

from __future__ import annotations

from numba import prange

from shared.jit import inline_njit, parallel_njit


@inline_njit
def spin(gradient, dt):
    """Cosine and sine of the angle by which `gradient` (xx, xy, yx, yy) turns the material in `dt`, after Cayley."""
    half = 0.25 * dt * (gradient[2] - gradient[1])
    return (1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half)


@inline_njit
def turned_stress(s, gradient, shear_modulus, dt):
    """S (xx, xy, yy, zz) after `dt` under a constant velocity gradient (xx, xy, yx, yy).

    The skew part turns S by the rotation of Cayley's transform, which is the Jaumann rate without its error in time
    (Hughes & Winget 1980): a rigid rotation leaves the principal stresses as they are.
    """
    xx, yy = gradient[0], gradient[3]
    xy = 0.5 * (gradient[1] + gradient[2])
    third = (xx + yy) / 3.0
    cosine, sine = spin(gradient, dt)
    c2, s2, cs = cosine * cosine, sine * sine, cosine * sine
    rate = 2.0 * shear_modulus * dt
    return (
        c2 * s[0] - 2.0 * cs * s[1] + s2 * s[2] + rate * (xx - third),
        cs * (s[0] - s[2]) + (c2 - s2) * s[1] + rate * xy,
        s2 * s[0] + 2.0 * cs * s[1] + c2 * s[2] + rate * (yy - third),
        s[3] - rate * third,
    )


@inline_njit
def carried(offset, gradient, dt):
    """An `offset` (2,) from a particle to its material tracer after `dt`: advected by u_a + ∇u·offset (Cayley)."""
    a, b, c, d = 0.5 * dt * gradient[0], 0.5 * dt * gradient[1], 0.5 * dt * gradient[2], 0.5 * dt * gradient[3]
    p = (1.0 + a) * offset[0] + b * offset[1]
    q = c * offset[0] + (1.0 + d) * offset[1]
    det = (1.0 - a) * (1.0 - d) - b * c
    return ((1.0 - d) * p + b * q) / det, (c * p + (1.0 - a) * q) / det


@parallel_njit
def update_material(mass, volume, rho, stress, curvature, offset, derivatives, correction, flux, material, dt):
    """ρ, V, S, Q and tracer offsets over `dt`, then the fluxes of stress into `flux` (6, n).

    `derivatives` (6, n): ∇u, ∇²u; `correction` (7, n): B, k, s; `flux`: (σ − k Q ⊗ s) B/ρ² row by row, k Q/ρ²;
    `material`: G, c², ρ0, E' (0: no Q).
    """
    shear_modulus, c_squared, rho0, bending = material
    for a in prange(rho.size):
        grad = (derivatives[0, a], derivatives[1, a], derivatives[2, a], derivatives[3, a])
        half = 0.5 * dt * (grad[0] + grad[3])
        rho[a] *= (1.0 - half) / (1.0 + half)
        volume[a] = mass[a] / rho[a]
        s = turned_stress((stress[0, a], stress[1, a], stress[2, a], stress[3, a]), grad, shear_modulus, dt)
        stress[0, a], stress[1, a], stress[2, a], stress[3, a] = s
        offset[0, a], offset[1, a] = carried((offset[0, a], offset[1, a]), grad, dt)
        cosine, sine = spin(grad, dt)
        q0 = q1 = 0.0
        if bending > 0.0:
            gain = bending * volume[a] / 12.0 * dt
            q0 = cosine * curvature[0, a] - sine * curvature[1, a] + gain * derivatives[4, a]
            q1 = sine * curvature[0, a] + cosine * curvature[1, a] + gain * derivatives[5, a]
            curvature[0, a], curvature[1, a] = q0, q1
        pressure = c_squared * (rho[a] - rho0)
        per = 1.0 / (rho[a] * rho[a])
        k, s0, s1 = correction[4, a], correction[5, a], correction[6, a]
        xx, xy = per * (s[0] - pressure - k * q0 * s0), per * (s[1] - k * q0 * s1)
        yx, yy = per * (s[1] - k * q1 * s0), per * (s[2] - pressure - k * q1 * s1)
        i00, i01, i10, i11 = correction[0, a], correction[1, a], correction[2, a], correction[3, a]
        flux[0, a] = xx * i00 + xy * i01
        flux[1, a] = xx * i10 + xy * i11
        flux[2, a] = yx * i00 + yy * i01
        flux[3, a] = yx * i10 + yy * i11
        flux[4, a], flux[5, a] = per * k * q0, per * k * q1
