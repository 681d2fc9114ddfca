"""The time step of a structure: its limits, and the shares and Courant numbers that were measured.

total-lagrangian   Central differences on a lattice of largest frequency ω whose viscosity has the time constant τ: of
                   v' = v − Δt ω²(x + τ v), x' = x + Δt v' follows Δt² + 2 τ Δt < 4/ω². The solver finds ω for each
                   scene by power iteration; before, LATTICE_LIMIT and FREE_LIMIT say it.
ctvf               A Courant number over dx/c_p by the order of the gradient.
beam               Implicit: any step is stable, and the first mode's period is the measure of accuracy.
"""

from __future__ import annotations

import math

from shared.elasticity import wave_speed
from shared.schema.solid import Solid

LATTICE_SHARE = 0.85
"""Of the lattice's limit, that "auto" takes; the rest is for the error of the power iteration."""
LATTICE_LIMIT = 0.73
"""2/ω over dx/c_p of a plain block clamped at both ends (0.64 for a plate 4 particles across, 0.54 for 3)."""
FREE_LIMIT = (0.675, -0.23)
"""The same with a free corner, at ν = 0 and per ν (dam_break_plate, oscillating_plate, plate_step_load)."""
UPDATED_COURANT = {"printed": 0.7, "linear": 0.7, "quadratic": 0.45}
"""Δt over dx/c_p that "auto" takes for model ctvf, by its gradient."""
LARGEST_UPDATED_COURANT = {"printed": 1.0, "linear": 1.0, "quadratic": 0.5}
"""The same up to which loaded beams ran."""
BEAM_STEPS = 100
"""Of a beam in the period of its first bending mode (period 0.03 % too long, the second mode of a cantilever 1.2 %)."""
FIRST_ROOT = {0: 4.730041, 1: 1.875104, 2: 4.730041}
"""βL of a thin beam's first bending mode by its number of clamped ends: free, cantilever, clamped at both ends."""


def viscous_time(solid: Solid) -> float:
    """Time constant τ [s] of the artificial viscosity: ρ c_p² τ = ρ α h c_p/8, the viscosity that Monaghan's α stands
    for in two dimensions (Monaghan, Rep. Prog. Phys. 68 (2005) 1703)."""
    return solid.alpha * solid.h_over_dx * solid.dx / (8.0 * wave_speed(solid))


def lattice_step(limit: float, tau: float) -> float:
    """Step [s] that "auto" takes on a lattice of largest frequency ω = 2/`limit` [1/s], viscous time `tau` [s]."""
    return LATTICE_SHARE * limit**2 / (math.hypot(tau, limit) + tau)  # √(τ² + limit²) − τ, also where τ is long


def expected_limit(clamped_ends: int, poisson_ratio: float) -> float:
    """2/ω over dx/c_p as it will be found, of a plate."""
    return LATTICE_LIMIT if clamped_ends == 2 else FREE_LIMIT[0] + FREE_LIMIT[1] * poisson_ratio


def first_frequency(clamped_ends: int, length: float, stiffness: float, mass: float) -> float:
    """First bending frequency [1/s] of a thin beam of bending `stiffness` [N m] and `mass` [kg/m²]: a little above the
    true one."""
    return (FIRST_ROOT[clamped_ends] / length) ** 2 * math.sqrt(stiffness / mass) / (2.0 * math.pi)


def beam_step(frequency: float) -> float:
    """Step [s] of a beam of first `frequency` [1/s]."""
    return 1.0 / (BEAM_STEPS * frequency)
