"""Shear that a lattice of particles bears under pressure, which makes waves too fast, at any dx.

Particles at rest stand on a square lattice and press on each other by p Σ V r ⊗ ∇W, −p of a fluid. Strained, the sum
departs from that, for it is no integral: a lattice under the pressure p has shear moduli ε p, of kernel and h/dx alone,
ε_1 where it is stretched along its rows and ε_2 where they slide along each other.

A standing wave of wavenumber k on water H deep strains it by k a cosh k(H − z)/sinh kH along the rows, and shears it by
k a sinh k(H − z)/sinh kH; with p = ρ g z that holds, over the wave's own energy, twice

    s = (ε_1 + ε_2)/2 + (ε_1 − ε_2)/2 (kH/sinh kH)²

so that its period is shorter by s, until the lattice melts. One with a negative modulus leaves its rows. Found on
standing_wave (ctvf, 100 deep; * 50 deep, where 0.2 to 0.5 less is due to dx), and s, in percent:

    wendland-c2, h/dx   1.0*    1.1*   1.2*   1.3    1.4*   1.45*  1.5    1.52    1.54   1.55   1.6*   2.0
    shorter by          4.3    −2.2    1.4    6.2    4.5    2.4    0.74   0.06   −0.51  −0.75  −2.0    0.50
    s                   5.4    −3.7   −0.4    5.8    4.5    2.4    0.60  −0.03   −0.50  −0.70  −1.4    0.66
    ε_1, ε_2            7, 4  −3, −4   5, −5  11, 0  9, 0   6, −1  2, −1  1, −1   0, −1  −1, −1 −2, 0   1, 0

    quintic-spline      0.95: 0.03 found, s 0.18; 1.0: −0.27, s −0.19
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from shared.kernels import evaluate, kernel_named
from shared.schema.scene import Scene

STIFF = 0.03  # of the pressure: from here on a lattice holds up small waves as well
RESTLESS = 0.02  # below minus this a lattice leaves its rows, and what it does to waves is known no better
LOOSEST = {"wendland-c2": 1.52, "quintic-spline": 0.95}
"""h/dx of few neighbours that bears no shear; it costs what 1.3 does, whose steps are shorter."""
STRAIN = 1e-4  # of the differences that moduli are taken by


@cache
def shear_moduli(kernel: str, h_over_dx: float) -> tuple[float, float]:
    """ε_1 and ε_2: shear moduli over the pressure of a square lattice, along its rows and across."""
    reach = math.ceil(kernel_named(kernel).support * h_over_dx) + 1
    rows = np.arange(-reach, reach + 1)
    lattice = np.stack(np.meshgrid(rows, rows), axis=-1).reshape(-1, 2).astype(float)

    def pressed(strain: np.ndarray) -> np.ndarray:
        r = lattice @ (np.eye(2) + strain)
        return -np.einsum("n,na,nb->ab", evaluate(kernel_named(kernel), np.linalg.norm(r, axis=1), h_over_dx)[1], r, r)

    def slope(strain: np.ndarray) -> np.ndarray:
        return (pressed(STRAIN * strain) - pressed(-STRAIN * strain)) / (2.0 * STRAIN * pressed(np.zeros((2, 2)))[0, 0])

    stretched, sheared = slope(np.diag([1.0, -1.0])), slope(np.array([[0.0, 0.5], [0.5, 0.0]]))
    return (stretched[1, 1] - stretched[0, 0]) / 4.0, -sheared[0, 1]


def too_fast(kernel: str, h_over_dx: float, phase: float) -> float:
    """Share s by which the lattice shortens the period of a wave; `phase` is kH [rad], infinite of deep water."""
    along, across = shear_moduli(kernel, h_over_dx)
    shallow = (phase / math.sinh(phase)) ** 2 if 0.0 < phase < 300.0 else float(phase == 0.0)
    return 0.5 * (along + across) + 0.5 * (along - across) * shallow


def stiff(scene: Scene) -> bool:
    """Whether the fluid's lattice holds up waves of its spacing's height."""
    return max(shear_moduli(scene.fluid.kernel, scene.fluid.h_over_dx)) > STIFF


def restless(scene: Scene) -> float:
    """Share of its pressure by which the fluid's lattice leaves its rows; 0 where it stands."""
    least = min(shear_moduli(scene.fluid.kernel, scene.fluid.h_over_dx))
    return -least if least < -RESTLESS else 0.0
