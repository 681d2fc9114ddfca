"""Energy, stress and viscosity of a lattice cell with a linearly varying strain, St. Venant-Kirchhoff's law.

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
"""

from __future__ import annotations

import numpy as np

from shared.jit import njit
from solid_solver.stencil import RUN

STRAINS = 9
"""Components of E, E,0 and E,1 kept from the step before, as planes (9, slots)."""


@njit
def stresses(d, count, axes, moment, lam, mu, tau):
    """Turn D in `d` into minus the energy's derivative per volume by D, in place (see the module's text).

    `d` holds D, and behind it the strains of the step before, which become the present ones; `axes` (2, 2): rows
    e_K; `moment` (2,): d_k²/12 [m²]; `lam`, `mu`: Lamé's λ and μ [Pa]; `tau`: τ over the time step.
    """
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
        x00, d[l + 10 * RUN] = x00 + tau * (x00 - d[l + 10 * RUN]), x00
        x11, d[l + 11 * RUN] = x11 + tau * (x11 - d[l + 11 * RUN]), x11
        x01, d[l + 12 * RUN] = x01 + tau * (x01 - d[l + 12 * RUN]), x01
        y00, d[l + 13 * RUN] = y00 + tau * (y00 - d[l + 13 * RUN]), y00
        y11, d[l + 14 * RUN] = y11 + tau * (y11 - d[l + 14 * RUN]), y11
        y01, d[l + 15 * RUN] = y01 + tau * (y01 - d[l + 15 * RUN]), y01
        z00, d[l + 16 * RUN] = z00 + tau * (z00 - d[l + 16 * RUN]), z00
        z11, d[l + 17 * RUN] = z11 + tau * (z11 - d[l + 17 * RUN]), z11
        z01, d[l + 18 * RUN] = z01 + tau * (z01 - d[l + 18 * RUN]), z01
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
