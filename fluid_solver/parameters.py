"""The numbers of a fluid run, fixed from its start to its end."""

from __future__ import annotations

import logging
import math
from typing import NamedTuple

import numpy as np

from shared.fluid_step import COURANT, LARGEST_COURANT
from shared.kernels import Kernel, evaluate, f_scale, kernel_named, w_scale
from shared.schema.fluid import Fluid
from shared.schema.scene import Scene

CONTACT = 0.75  # of dx: less than the distance from a wall's face, between two ghosts, to either
STIFFNESS = 0.2  # of ρ0 c0²: pressure of a closed gap with few neighbours; stops a drop at 0.4 c0
PAIRING = 0.2  # R of Sun et al. (2019): weight of the term against pairing
EDAC_ALPHA = 0.5  # ν_e = EDAC_ALPHA h c0/8 (Ramachandran & Puri 2019)
_WEAKEST = {"limited": -0.01, "none": 0.0, "free": -math.inf}
"""Lowest pressure over ρ0 c0². Limited: c0 is ten times the largest speed expected, so this is twice the flow's own
dynamic pressure. Beyond it, pulled particles clump, lose the density that would stop them at a wall, and shoot out."""
log = logging.getLogger("shearwater")


class Parameters(NamedTuple):
    """Constants of the compiled sweeps, all float64."""

    h: float  # smoothing length [m]
    dx: float  # particle spacing [m]
    support: float  # radius of the kernel's support [m]
    rho0: float  # reference density [kg/m³]
    c0: float  # sound speed [m/s]
    alpha: float  # artificial viscosity coefficient
    nu: float  # kinematic viscosity [m²/s]
    nu_edac: float  # diffusivity of the EDAC pressure [m²/s]
    gx: float  # gravity [m/s²]
    gy: float
    slope: float  # F over the kernel's f_shape [1/m⁴], times gradient_factor
    pairing: float  # W over the kernel's w_shape, over W at the distance dx, times PAIRING^¼
    weakest: float  # lowest pressure, the tension that is kept [Pa]; −∞ for any
    closed: float  # pressure of a closed gap between fluid and a ghost [Pa]
    filled: float = 0.0  # 1 for fluid that is shifted and fills its room, with no free surface


def parameters(scene: Scene, kernel: Kernel, c0: float) -> Parameters:
    """The scene's numbers, with sound speed `c0` [m/s]."""
    fluid = scene.fluid
    h = fluid.h_over_dx * fluid.dx
    gx, gy = scene.gravity
    values = (
        h, fluid.dx, kernel.support * h, fluid.density, c0, fluid.alpha, fluid.viscosity, EDAC_ALPHA * h * c0 / 8.0,
        gx, gy, slope_of(kernel, h, fluid.dx), pairing_of(kernel, h, fluid.dx),
        _WEAKEST[fluid.negative_pressure] * fluid.density * c0**2,
        closed_of(kernel, fluid.h_over_dx) * fluid.density * c0**2,
    )  # fmt: skip
    return Parameters(*(float(value) for value in values))


def slope_of(kernel: Kernel, h: float, dx: float) -> float:
    """F over its shape [1/m⁴], with the factor on ∇W, for smoothing length `h` [m] and spacing `dx` [m]."""
    return f_scale(kernel.code, h) * gradient_factor(kernel, h / dx)


def pairing_of(kernel: Kernel, h: float, dx: float) -> float:
    """The factor on the shape of W whose fourth power is PAIRING (W/W(dx))⁴."""
    return PAIRING**0.25 * w_scale(kernel.code, h) / evaluate(kernel, np.array([dx]), h)[0][0]


def closed_of(kernel: Kernel, h_over_dx: float) -> float:
    """Pressure of a closed gap over ρ0 c0²: half-way through it a ghost pushes one particle, by F, no less than with
    the softest of few neighbours, the quintic spline with h = dx."""
    half = np.array([0.5 * CONTACT])
    softest = evaluate(kernel_named("quintic-spline"), half, 1.0)[1][0]
    return STIFFNESS * max(1.0, softest / evaluate(kernel, half, h_over_dx)[1][0])


def gradient_factor(kernel: Kernel, h_over_dx: float) -> float:
    """Factor that makes Σ V_b r_ab ⊗ ∇W = −I on the mean of a square and a hexagonal lattice.

    Particles start on one and settle towards the other. Wendland C2 at h = 1.3 dx is 2.6 and 1.5 % low there: as much
    too low is a gradient of pressure, and too high the bottom pressure of a tank. One factor for all terms keeps
    divergence and gradient adjoint, and so energy.
    """
    i, j = np.meshgrid(np.arange(-12, 13), np.arange(-12, 13))
    side = math.sqrt(2.0 / math.sqrt(3.0))  # spacing of a hexagonal lattice with one particle per unit area
    total = 0.0
    for x, y in ((i, j), (side * (i + 0.5 * j), side * math.sqrt(0.75) * j)):
        r = np.hypot(x, y)
        total -= np.sum(r * r * evaluate(kernel, r, h_over_dx)[1]) / 2.0
    return 2.0 / total


def courant_of(fluid: Fluid) -> float:
    """Time step over h/(c0 + u): the scene's, or what was measured to be stable and accurate (shared/fluid_step.py)."""
    if fluid.courant == "auto":
        return COURANT[fluid.model]
    if fluid.courant > LARGEST_COURANT[fluid.model]:
        log.warning(
            "fluid.courant = %g: dam breaks were measured to be stable up to %g only with %s; watch the total energy",
            fluid.courant,
            LARGEST_COURANT[fluid.model],
            fluid.model,
        )
    return fluid.courant
