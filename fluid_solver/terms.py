"""The pair terms of the fluid equations, one function each.

`f_ab = f_a − f_b`, `V_b = m_b/ρ_b`, `F = (1/r) dW/dr`, `∇W = F r_ab`, `d = ũ − u`. Equations: Adepu & Ramachandran
(CTVF), with the slips of the printed form mended. Every function returns what one neighbour b adds.
"""

from __future__ import annotations

from shared.jit import bits, float_of, inline_njit

EPS = 0.01  # of h²: keeps 1/(r² + EPS h²) finite
COINCIDENT = 1e-12  # of h²: below it two particles are one
_INVERSE_BITS = 0x7FDE600000000000  # less the bits of x: those of 1/x, to within 5.1 %


@inline_njit
def velocity_divergence(vol_b, rx, ry, ux, uy, F):
    """V_b u_ab·∇W: minus the divergence of u [1/s]. dρ/dt = ρ_a Σ of it, and dp/dt = ρ_a c² Σ of it."""
    return vol_b * F * (ux * rx + uy * ry)


@inline_njit
def transport(vol_b, f_ab, rx, ry, dx_b, dy_b, F):
    """−V_b f_ab d_b·∇W = d·∇f: the particle moves with ũ, not u.

    The terms of continuity, ρ_a d_ab − (ρd)_ab, and of EDAC, p_a d_ab − (pd)_ab, rearranged: equal to them, with one
    product less, and plainly blind to a constant added to f.
    """
    return -vol_b * f_ab * F * (dx_b * rx + dy_b * ry)


@inline_njit
def pressure_diffusion(vol_b, p_ab, rx, ry, rho_gx, rho_gy, nu_edac, F):
    """2 ν_e V_b p'_ab F with p' = p − ρ0 g·r: EDAC's diffusion [Pa/s] of p less its hydrostatic part.

    Printed with 4 m_b/(ρ_a + ρ_b), which is 2 V_b to within the compression (1 %). The hydrostatic part, truncated at
    a free surface, would drift a still column.
    """
    return 2.0 * nu_edac * vol_b * (p_ab - rho_gx * rx - rho_gy * ry) * F


@inline_njit
def pressure_force(pr2_a, pr2_b):
    """−(p_a/ρ_a² + p_b/ρ_b²), to be multiplied by m_b ∇W [m/s²]."""
    return -(pr2_a + pr2_b)


@inline_njit
def mean_specific_mass(m_b, vol_b, inv_rho_a):
    """m_b/ρ̄ with 1/ρ̄ = (1/ρ_a + 1/ρ_b)/2: symmetric in a and b once multiplied by m_a [m²]."""
    return 0.5 * (m_b * inv_rho_a + vol_b)


@inline_njit
def inverse(x):
    """1/x of a positive x, to within 1.4e-4 of it, without a division: guessed from the bits, with one step of
    Householder's third order.

    A division is the longest wait of a pair on processors that divide slowly (forces of wcsph: 85 ns a particle with,
    62 without).
    """
    guess = float_of(_INVERSE_BITS - bits(x))
    e = 1.0 - x * guess
    return guess + guess * (e * e + e)


@inline_njit
def artificial_viscosity(rx, ry, ux, uy, r2, h):
    """−Π_ab ρ0/(α h c0) = φ of approaching pairs, φ = u_ab·r_ab/(r² + EPS h²), to be multiplied by m_b ∇W.

    Monaghan (1992), with the sign that makes Π positive on approach, adding to the pressure, and ρ0 for the mean
    density of the pair: they differ by the compression (1 %). An `inverse` is enough of a division here: its error
    depends on r alone, so that the pair's forces stay opposite and equal, and is small beside what α is known to.
    """
    return min(0.0, ux * rx + uy * ry) * inverse(r2 + EPS * h * h)


@inline_njit
def laminar_viscosity(g_b, rx, ry, ux, uy, r2, h, nu):
    """8 ν (u_ab·r_ab/r²) m_b/ρ̄, to be multiplied by ∇W [m/s²]. Monaghan & Gingold (1983), in two dimensions.

    Along r_ab, so that angular momentum is kept, and a free surface feels no stress: the form along u_ab of Morris et
    al. (1997) dissipates ν|∇u|² in place of 2ν D:D, half of a wave's.
    """
    return 8.0 * nu * g_b * (ux * rx + uy * ry) / max(r2, COINCIDENT * h * h)


@inline_njit
def shifting_weight(vol_f, s):
    """V_b F [1 + s⁴], s⁴ = 0.2 (W/W(dx))⁴, to be multiplied by r_ab: Sun et al. (2019), against pairing."""
    s2 = s * s
    return vol_f + vol_f * (s2 * s2)
