"""Compiled sweeps of the updated-Lagrangian solid with a quadratic gradient.

Symbols as in updated_sweeps.py; d = (x_b − x_a)/h, p(d) = (d0, d1, d0²/2, d0 d1, d1²/2), w_ab = V_b W_ab. About each
particle the velocity is fitted by a full quadratic (moving least squares), M_a = Σ w p pᵀ, and

    D_a = Σ_b w_ab Γ_a p_ab (u_b − u_a),   D = (∂0, ∂1, ∂00, ∂01, ∂11) u,

with Γ the rows of M⁻¹, by h for the gradient and by h² for the second derivatives: exact for quadratic fields. Stress
is integrated over each cell with its linear variation, as in strain_gradient.py, in rates and for a square cell:

    dS/dt as in updated_material.py,   dZ_k/dt = V/12 C:ε̇,k + rotation,   C:ε = λ tr(ε) I + 2 G ε.

Forces are the transpose of the derivatives,

    du_a/dt = Σ_b m_b W_ab [ψ_a p_ab/ρ_a² − ψ_b p_ba/ρ_b² − …],   ψ = (σ, Z) Γ   (2 × 5).

Fixed particles enter the fits with their area; they carry no stress.
"""

from __future__ import annotations

import math

from numba import prange

from shared.jit import njit, parallel_njit
from shared.kernels import kernel_f, kernel_w
from solid_solver.shifting import short_range
from solid_solver.updated_material import spin

TERMS = 5
CHUNK = 32
_SINGULAR = 1.0e-9  # pivot over its diagonal below which a direction of the fit is left out


def chunks(count: int) -> int:
    """Number of chunks of `count` particles."""
    return (count + CHUNK - 1) // CHUNK


@njit
def _solve(m):
    """Gauss elimination in place of symmetric M (5, 5) beside its right-hand sides, m (5, 10); left-out rows give 0."""
    for k in range(TERMS):
        if m[k, k] < _SINGULAR:
            for j in range(k, 2 * TERMS):
                m[k, j] = 0.0
            m[k, k] = 1.0
            continue
        inverse = 1.0 / m[k, k]
        for i in range(k + 1, TERMS):
            factor = m[i, k] * inverse
            for j in range(k + 1, 2 * TERMS):
                m[i, j] -= factor * m[k, j]
    for k in range(TERMS - 1, -1, -1):
        inverse = 1.0 / m[k, k]
        for c in range(TERMS, 2 * TERMS):
            total = m[k, c]
            for j in range(k + 1, TERMS):
                total -= m[k, j] * m[j, c]
            m[k, c] = total * inverse


@njit
def _fit(a, x, u, volume, first, neighbour, code, h, m):
    """M of particle `a` into `m`, and the sums Σ w p (u_b − u_a) as two tuples."""
    px, py, ux, uy = x[0], x[1], u[0], u[1]
    inverse = 1.0 / h
    m20 = m11 = m02 = m30 = m21 = m12 = m03 = m40 = m31 = m22 = m13 = m04 = 0.0
    a0 = a1 = a2 = a3 = a4 = b0 = b1 = b2 = b3 = b4 = 0.0
    x0, x1, u0, u1 = px[a], py[a], ux[a], uy[a]
    for k in range(first[a], first[a + 1]):
        b = neighbour[k]
        r0, r1 = (px[b] - x0) * inverse, (py[b] - x1) * inverse
        w = kernel_w(code, r0 * r0 + r1 * r1, 1.0) * volume[b] * inverse * inverse
        p2, p3, p4 = 0.5 * r0 * r0, r0 * r1, 0.5 * r1 * r1
        w0, w1, w2, w3, w4 = w * r0, w * r1, w * p2, w * p3, w * p4
        du, dv = ux[b] - u0, uy[b] - u1
        m20 += w0 * r0
        m11 += w0 * r1
        m02 += w1 * r1
        m30 += w0 * p2
        m21 += w0 * p3
        m12 += w0 * p4
        m03 += w1 * p4
        m40 += w2 * p2
        m31 += w2 * p3
        m22 += w2 * p4
        m13 += w3 * p4
        m04 += w4 * p4
        a0 += w0 * du
        a1 += w1 * du
        a2 += w2 * du
        a3 += w3 * du
        a4 += w4 * du
        b0 += w0 * dv
        b1 += w1 * dv
        b2 += w2 * dv
        b3 += w3 * dv
        b4 += w4 * dv
    m[0, 0], m[0, 1], m[0, 2], m[0, 3], m[0, 4] = m20, m11, m30, m21, m12
    m[1, 0], m[1, 1], m[1, 2], m[1, 3], m[1, 4] = m11, m02, 0.5 * m21, 2.0 * m12, m03
    m[2, 0], m[2, 1], m[2, 2], m[2, 3], m[2, 4] = m30, 0.5 * m21, m40, m31, m22
    m[3, 0], m[3, 1], m[3, 2], m[3, 3], m[3, 4] = m21, 2.0 * m12, m31, 4.0 * m22, m13
    m[4, 0], m[4, 1], m[4, 2], m[4, 3], m[4, 4] = m12, m03, m22, m13, m04
    return (a0, a1, a2, a3, a4), (b0, b1, b2, b3, b4)


@njit
def _derivatives_of_chunk(chunk, x, u, volume, first, neighbour, code, h, derivatives, fits, m):
    for a in range(chunk * CHUNK, min(first.size - 1, (chunk + 1) * CHUNK)):
        du, dv = _fit(a, x, u, volume, first, neighbour, code, h, m)
        m[:, TERMS:] = 0.0
        m[0, 5] = m[1, 6] = 1.0 / h
        m[2, 7] = m[3, 8] = m[4, 9] = 1.0 / (h * h)
        _solve(m)
        for c in range(TERMS):
            s = t = 0.0
            for k in range(TERMS):
                row = m[k, TERMS + c]
                fits[TERMS * c + k, a] = row
                s += row * du[k]
                t += row * dv[k]
            at = c if c < 2 else c + 2
            derivatives[at, a], derivatives[at + (2 if c < 2 else 3), a] = s, t


@parallel_njit
def quadratic_derivatives(x, u, volume, first, neighbour, code, h, derivatives, fits, scratch):
    """D of u into `derivatives` (10, n): ∇u row by row, second derivatives of u_x, of u_y; Γ row by row into `fits`
    (25, n). `scratch` (chunks, 5, 10): room for each chunk's M."""
    for c in prange(scratch.shape[0]):
        _derivatives_of_chunk(c, x, u, volume, first, neighbour, code, h, derivatives, fits, scratch[c])


@parallel_njit
def quadratic_flux(volume, rho, stress, curvature, derivatives, fits, flux, material, dt):
    """Z over `dt` into `curvature` (6, free): xx, xy, yy of Z_0, of Z_1; then ψ/ρ² into `flux` (10, free).

    `material`: G, c² = K/ρ0, ρ0, unused.
    """
    shear, c_squared, rho0, _ = material
    lam = c_squared * rho0 - 2.0 * shear / 3.0
    for a in prange(flux.shape[1]):
        cosine, sine = spin((0.0, derivatives[1, a], derivatives[2, a], 0.0), dt)
        c2, s2, cs = cosine * cosine, sine * sine, cosine * sine
        gain = dt * volume[a] / 12.0
        x00, x01, x11 = derivatives[4, a], derivatives[5, a], derivatives[6, a]
        y00, y01, y11 = derivatives[7, a], derivatives[8, a], derivatives[9, a]
        t0, t1 = gain * lam * (x00 + y01), gain * lam * (x01 + y11)
        xx, xy, yy = curvature[0, a], curvature[1, a], curvature[2, a]
        p0, p1, p2 = (
            c2 * xx - 2.0 * cs * xy + s2 * yy,
            cs * (xx - yy) + (c2 - s2) * xy,
            s2 * xx + 2.0 * cs * xy + c2 * yy,
        )
        xx, xy, yy = curvature[3, a], curvature[4, a], curvature[5, a]
        q0, q1, q2 = (
            c2 * xx - 2.0 * cs * xy + s2 * yy,
            cs * (xx - yy) + (c2 - s2) * xy,
            s2 * xx + 2.0 * cs * xy + c2 * yy,
        )
        g = gain * shear
        z0, z1, z2 = cosine * p0 - sine * q0, cosine * p1 - sine * q1, cosine * p2 - sine * q2
        z3, z4, z5 = sine * p0 + cosine * q0, sine * p1 + cosine * q1, sine * p2 + cosine * q2
        z0, z1, z2 = z0 + t0 + 2.0 * g * x00, z1 + g * (x01 + y00), z2 + t0 + 2.0 * g * y01
        z3, z4, z5 = z3 + t1 + 2.0 * g * x01, z4 + g * (x11 + y01), z5 + t1 + 2.0 * g * y11
        curvature[0, a], curvature[1, a], curvature[2, a] = z0, z1, z2
        curvature[3, a], curvature[4, a], curvature[5, a] = z3, z4, z5
        per = 1.0 / (rho[a] * rho[a])
        pressure = c_squared * (rho[a] - rho0)
        xx, xy, yy = per * (stress[0, a] - pressure), per * stress[1, a], per * (stress[2, a] - pressure)
        z0, z1, z2, z3, z4, z5 = per * z0, per * z1, per * z2, per * z3, per * z4, per * z5
        for k in range(TERMS):
            f0, f1, f2 = fits[k, a], fits[TERMS + k, a], fits[2 * TERMS + k, a]
            f3, f4 = fits[3 * TERMS + k, a], fits[4 * TERMS + k, a]
            flux[k, a] = xx * f0 + xy * f1 + z0 * f2 + (z1 + z3) * f3 + z4 * f4
            flux[TERMS + k, a] = xy * f0 + yy * f1 + z1 * f2 + (z2 + z4) * f3 + z5 * f4


@parallel_njit
def quadratic_accelerations(x, u, mass, volume, flux, first, neighbour, code, h, viscosity, spacing, a_out, crowding):
    """du/dt of the free particles into `a_out` (2, free); arguments as in updated_sweeps.accelerations."""
    px, py, ux, uy = x[0], x[1], u[0], u[1]
    inverse, free = 1.0 / h, crowding.size
    for a in prange(free):
        f0 = f1 = crowd = 0.0
        x0, x1, u0, u1 = px[a], py[a], ux[a], uy[a]
        s0, s1, s2, s3, s4 = flux[0, a], flux[1, a], flux[2, a], flux[3, a], flux[4, a]
        t0, t1, t2, t3, t4 = flux[5, a], flux[6, a], flux[7, a], flux[8, a], flux[9, a]
        half_density = 0.5 * mass[a] / volume[a]
        for k in range(first[a], first[a + 1]):
            b = neighbour[k]
            r0, r1 = px[b] - x0, py[b] - x1
            r2 = r0 * r0 + r1 * r1
            d0, d1 = r0 * inverse, r1 * inverse
            p2, p3, p4 = 0.5 * d0 * d0, d0 * d1, 0.5 * d1 * d1
            m, v = mass[b], volume[b]
            w = kernel_w(code, d0 * d0 + d1 * d1, 1.0) * inverse * inverse * m
            approach = min(0.0, (u0 - ux[b]) * -r0 + (u1 - uy[b]) * -r1)
            pi = -viscosity * approach * v / ((r2 + 0.01 * h * h) * (half_density * v + 0.5 * m))
            f = kernel_f(code, r2, h) * m * pi
            f0 += w * (s0 * d0 + s1 * d1 + s2 * p2 + s3 * p3 + s4 * p4) + f * r0
            f1 += w * (t0 * d0 + t1 * d1 + t2 * p2 + t3 * p3 + t4 * p4) + f * r1
            if b < free:
                f0 += w * (flux[0, b] * d0 + flux[1, b] * d1 - flux[2, b] * p2 - flux[3, b] * p3 - flux[4, b] * p4)
                f1 += w * (flux[5, b] * d0 + flux[6, b] * d1 - flux[7, b] * p2 - flux[8, b] * p3 - flux[9, b] * p4)
            crowd += short_range(math.sqrt(r2) / spacing[b])
        a_out[0, a], a_out[1, a] = f0, f1
        crowding[a] = crowd
