"""What a step does to the material of the updated-Lagrangian solid at a particle.

    dρ/dt = −ρ ∇·u,   dS/dt = 2G (ε̇ − tr(ε̇) I/3) + S Ωᵀ + Ω S,   p = c² (ρ − ρ0),  c² = K/ρ0

The rate of S is stated with the trace that the paper's print lacks. Symbols: L = ∂Δx/∂x (00, 01, 10, 11) the gradient
of a step's displacement by the places at its end. Then F⁻¹ = I − L takes the material back over the step, exactly, and
∂Δx/∂x_m = L (I − L/2)⁻¹ is the gradient by the places x_m at its middle, whose skew part gives the rotation without
error (Hughes & Winget 1980): one set of neighbour sums, at the end of the step, serves strain and forces.
"""

from __future__ import annotations

from shared.jit import inline_njit
from solid_solver.blocks import RUN
from solid_solver.updated_fields import E0, E1, G00, G01, G10, G11, IRHO, RHO, SXX, SXY, SYY, SZZ


@inline_njit
def spin(middle):
    """Cosine and sine of the angle by which a step turns the material; `middle`: gradient by places at its middle."""
    half = 0.25 * (middle[2] - middle[1])
    return (1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half)


@inline_njit
def by_middle(a, b, c, d):
    """L (I − L/2)⁻¹ of L = (a, b, c, d)."""
    per = 1.0 / ((1.0 - 0.5 * a) * (1.0 - 0.5 * d) - 0.25 * b * c)
    p, q, r, s = per * (1.0 - 0.5 * d), per * 0.5 * b, per * 0.5 * c, per * (1.0 - 0.5 * a)
    return a * p + b * r, a * q + b * s, c * p + d * r, c * q + d * s


@inline_njit
def turned_stress(s, middle, shear_modulus):
    """S (xx, xy, yy, zz) after a step with the displacement's gradient `middle` by the places at its middle."""
    xx, yy = middle[0], middle[3]
    xy = 0.5 * (middle[1] + middle[2])
    third = (xx + yy) / 3.0
    cosine, sine = spin(middle)
    p, q, r = turned(s[0], s[1], s[2], cosine, sine)
    rate = 2.0 * shear_modulus
    return p + rate * (xx - third), q + rate * xy, r + rate * (yy - third), s[3] - rate * third


@inline_njit
def turned(xx, xy, yy, cosine, sine):
    """A symmetric tensor turned by the angle of `cosine` and `sine`."""
    c2, s2, cs = cosine * cosine, sine * sine, cosine * sine
    return c2 * xx - 2.0 * cs * xy + s2 * yy, cs * (xx - yy) + (c2 - s2) * xy, s2 * xx + 2.0 * cs * xy + c2 * yy


@inline_njit
def carried(e0, e1, a, b, c, d):
    """F e: the offset from a particle to its material tracer after a step with L = (a, b, c, d)."""
    per = 1.0 / ((1.0 - a) * (1.0 - d) - b * c)
    return per * ((1.0 - d) * e0 + b * e1), per * (c * e0 + (1.0 - a) * e1)


@inline_njit
def deformed(d, at, step, rate, shear, c_squared, rho0):
    """Rows ∂_j u_i, ρ, 1/ρ, tracer offset and S of the particle whose rows stand in `d` from `at` on, after a step.

    `step`: L (4); `rate`: 1/Δt [1/s]. Returns σ = S − p I as xx, xy, yy, 1/ρ, and the cosine and sine of the turn.
    """
    a, b, c, e = step
    d[at + G00 * RUN], d[at + G01 * RUN] = a * rate, b * rate
    d[at + G10 * RUN], d[at + G11 * RUN] = c * rate, e * rate
    rho = d[at + RHO * RUN] * ((1.0 - a) * (1.0 - e) - b * c)
    d[at + RHO * RUN], d[at + IRHO * RUN] = rho, 1.0 / rho
    d[at + E0 * RUN], d[at + E1 * RUN] = carried(d[at + E0 * RUN], d[at + E1 * RUN], a, b, c, e)
    middle = by_middle(a, b, c, e)
    stress = (d[at + SXX * RUN], d[at + SXY * RUN], d[at + SYY * RUN], d[at + SZZ * RUN])
    xx, xy, yy, zz = turned_stress(stress, middle, shear)
    d[at + SXX * RUN], d[at + SXY * RUN], d[at + SYY * RUN], d[at + SZZ * RUN] = xx, xy, yy, zz
    cosine, sine = spin(middle)
    pressure = c_squared * (rho - rho0)
    return xx - pressure, xy, yy - pressure, 1.0 / rho, cosine, sine
