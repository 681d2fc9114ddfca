"""The numbers of a fluid run, fixed from its start to its end."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shared.kernels import Kernel, evaluate
from shared.schema import Fluid, Scene

EDAC_ALPHA = 0.5  # ν_e = EDAC_ALPHA h c0/8 (Ramachandran & Puri 2019)
COURANT = {"ctvf": 0.4, "wcsph": 0.7}


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
    w_dx: float  # W at the distance dx [1/m²]


def parameters(scene: Scene, kernel: Kernel, c0: float) -> Parameters:
    """The scene's numbers, with sound speed `c0` [m/s]."""
    fluid = scene.fluid
    h = fluid.h_over_dx * fluid.dx
    w_dx = evaluate(kernel, np.array([fluid.dx]), h)[0][0]
    gx, gy = scene.gravity
    values = (
        h, fluid.dx, kernel.support * h, fluid.density, c0, fluid.alpha, fluid.viscosity, EDAC_ALPHA * h * c0 / 8.0,
        gx, gy, w_dx,
    )  # fmt: skip
    return Parameters(*(float(value) for value in values))


def stable_courant(fluid: Fluid) -> float:
    """Time step over h/(c0 + speed) that was measured to be stable."""
    return COURANT[fluid.model]
