"""Where theory puts the boundaries of exchange between a free structure and a column of water.

Δt the window, m = ρ_s t the structure's mass per area, α = ρ_f c Δt/m, r = ρ_f H/m, A = c Δt/H = α/r; y = z⁻¹ one
window back; Q the extrapolation of order 0, 1, 2 from past windows: y, 2y − y², 3y − 3y² + y³; R = −d the pulse that
comes back from the column's open far end after k = 2/A windows. With v̄ the structure's mean velocity in a window and F̄
the mean load, found by the fluid for the wall's mean velocity w v̄,

    v̄ (1 − y) = (Δt/2m) (1 + y) Q F̄                     the structure moves under constant loads, those of the past
    F̄ = −ρ c (1 + R y^k)/(1 − R y^k) w v̄                 acoustic column
    w = 1 (serial);  w = y + (1 − y) Q (parallel: the wall's end is predicted from past mean velocities)

    2 (1 − y)(1 − R y^k) + α (1 + y)(1 + R y^k) Q w = 0.

Incompressible, with a structure's mean acceleration F̄/m: 1 + r Q = 0 (serial), 1 + r Q² = 0 (parallel). Unstable while
a root lies inside the unit circle. Iterated, a window's load answers its own error with −g times it, g = r
incompressible, α/2 while no pulse has come back: relaxation by ω converges for 0 < ω < 2/(1 + g).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial

from coupler.stability.lattice import largest_courant
from shared.kernels import kernel_named
from shared.schema.scene import Scene

Y = Polynomial([0.0, 1.0])
PREDICTION = {0: Y, 1: 2 * Y - Y**2, 2: 3 * Y - 3 * Y**2 + Y**3}
_ROUND = 1e-9  # past 1, below which a root counts as on the unit circle
_SCAN = 400  # values looked at before the boundary is bisected
_BISECTIONS = 50
_WHOLE = 1e-6  # how far 2/A may be off a whole number
_ANGLES = 1000  # swings from the slowest to one of two windows
_MOST_WINDOWS = 200  # of a pulse's way, as many roots as are looked for


def lagged_wall(scheme: str, order: int) -> Polynomial:
    """w: the mean velocity of the fluid's wall over that of the structure."""
    return Polynomial([1.0]) if scheme.startswith("serial") else Y + (1 - Y) * PREDICTION[order]


def acoustic(alpha: float, order: int, reflection: float = 0.0, k: int = 1, scheme: str = "serial") -> Polynomial:
    """The polynomial in y of a structure on an acoustic column; `reflection`: d."""
    echo = Polynomial([1.0] + [0.0] * (k - 1) + [reflection])  # 1 − R y^k
    load = PREDICTION[order] * lagged_wall(scheme, order)
    return 2 * (1 - Y) * echo + alpha * (1 + Y) * (2 - echo) * load


def incompressible(r: float, order: int, scheme: str = "serial") -> Polynomial:
    """The polynomial in y of a structure on an incompressible column."""
    Q = PREDICTION[order]
    return 1 + r * (Q if scheme.startswith("serial") else Q * Q)


def echo_gain(alpha: float, order: int, scheme: str = "serial") -> float:
    """How many times as large a pulse leaves the structure as it came, at most, whatever its frequency: 1 without lag.

    From the acoustic equation, R y^k = (2 (1 − y) + α (1 + y) Q w)/(2 (1 − y) − α (1 + y) Q w) on the unit circle.
    """
    y = np.exp(1j * np.linspace(0.0, np.pi, _ANGLES + 1)[1:])
    inertia, load = 2 * (1 - y), alpha * (1 + y) * PREDICTION[order](y) * lagged_wall(scheme, order)(y)
    return float(np.max(np.abs((inertia - load) / (inertia + load))))


def growth(polynomial: Polynomial) -> float:
    """Largest growth per window of what the polynomial in y allows."""
    return float(1.0 / np.min(np.abs(polynomial.roots())))


def largest_stable(polynomial: Callable[[float], Polynomial], most: float) -> float:
    """The number at which solutions begin to grow, coming from zero; `most` if they never do."""
    values = np.linspace(0.0, most, _SCAN + 1)[1:]
    growing = next((v for v in values if growth(polynomial(v)) > 1.0 + _ROUND), None)
    if growing is None:
        return most
    low, high = growing - most / _SCAN, growing
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if growth(polynomial(middle)) > 1.0 + _ROUND else (middle, high)
    return low


# ---- theories of a map, by name: from a cell's scene and its x, the boundary in y ------------------------------------


def lagged_column(scene: Scene, x: float) -> float | None:
    """Largest stable r at x = A, on the acoustic column; None where a pulse does not come back after whole windows, or
    after so many that there are too many roots to find."""
    coupling, reflection = scene.coupling, scene.fluid.column.reflection
    k = round(2.0 / x) if reflection else 1
    if reflection and (abs(k * x - 2.0) > _WHOLE or k > _MOST_WINDOWS):
        return None
    order, scheme = coupling.predictor, coupling.scheme
    return largest_stable(lambda alpha: acoustic(alpha, order, reflection, k, scheme), 4.0) / x


def lagged_silent(scene: Scene, x: float) -> float:
    """The same where no pulse has come back while the run lasts."""
    order, scheme = scene.coupling.predictor, scene.coupling.scheme
    return largest_stable(lambda alpha: acoustic(alpha, order, scheme=scheme), 4.0) / x


def lagged_incompressible(scene: Scene, x: float) -> float:
    """Largest stable r of incompressible water, whatever x."""
    order, scheme = scene.coupling.predictor, scene.coupling.scheme
    return largest_stable(lambda r: incompressible(r, order, scheme), 4.0)


def relaxation(scene: Scene, x: float) -> float:
    """Largest ω that converges at x = |g|."""
    return 2.0 / (1.0 + x)


def lattice_waves(scene: Scene, x: float) -> float:
    """Largest Courant number of sound on a lattice of particles."""
    fluid = scene.fluid
    return largest_courant(kernel_named(fluid.kernel), fluid.h_over_dx, fluid.alpha, fluid.model == "ctvf")


THEORIES: dict[str, Callable[[Scene, float], float | None]] = {
    "lagged-column": lagged_column,
    "lagged-silent": lagged_silent,
    "lagged-incompressible": lagged_incompressible,
    "relaxation": relaxation,
    "lattice-waves": lattice_waves,
}
