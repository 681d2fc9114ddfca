"""Elastic constants of a solid, plane strain, and the speed of its sound."""

from __future__ import annotations

import math

from shared.schema.solid import Solid


def lame(solid: Solid) -> tuple[float, float]:
    """Lamé's λ and μ [Pa]."""
    e, nu = solid.youngs_modulus, solid.poisson_ratio
    return e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu))


def bulk_modulus(solid: Solid) -> float:
    """K = E/(3 (1 − 2ν)) [Pa]."""
    return solid.youngs_modulus / (3.0 * (1.0 - 2.0 * solid.poisson_ratio))


def plane_modulus(solid: Solid) -> float:
    """E' = E/(1 − ν²) [Pa]: stress over strain of a plate that is pulled or bent along one direction."""
    return solid.youngs_modulus / (1.0 - solid.poisson_ratio**2)


def wave_speed(solid: Solid) -> float:
    """Speed of P waves c_p = √((λ + 2μ)/ρ) [m/s]."""
    lam, mu = lame(solid)
    return math.sqrt((lam + 2.0 * mu) / solid.density)
