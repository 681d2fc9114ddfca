"""Where theory puts the boundary of lagged exchange between a free piston and an acoustic column.

Per window of length 1, speeds over one another, loads over ρ c: with a_n the piston's speed gained in window n, Δx_n
what it moves, F̄_n the mean load, α = ρ c Δt/m = A r, R = −d the pulse that comes back from an open far end after
k = 2/A windows, w the predictor's weights,

    Δx_{n+1} − Δx_n = (a_n + a_{n+1})/2      the structure moves under constant loads
    a_n = −α Σ_j w_j F̄_{n−1−j}               the loads of past windows, carried on
    F̄_n = Δx_n + 2R G_{n−k}                  the fluid on the true motion; G_n = Δx_n + R G_{n−k} leaves the face

so that solutions z^n obey  2z (z − 1)(1 − R z^−k) + α (1 + z)(1 + R z^−k) W(z) = 0,  W = Σ_j w_j z^−j. For R = 0 the
largest stable α is 2, 2/√3 and 0.709 for predictor order 0, 1, 2.
"""

from __future__ import annotations

import numpy as np

WEIGHTS = {0: (1.0,), 1: (2.0, -1.0), 2: (3.0, -3.0, 1.0)}
_ROUND = 1e-9  # past 1, below which a root counts as on the unit circle
_SCAN = 400  # values of α looked at before the boundary is bisected


def growth(alpha: float, order: int, reflection: float, k: int) -> float:
    """Largest |z| besides the root z = 1 of a piston that has come to rest elsewhere."""
    delay = np.zeros(k + 1)  # 1 in powers z^k … z^0
    delay[0] = 1.0
    echo = np.zeros(k + 1)
    echo[-1] = -reflection  # R z^−k, times z^k
    weights = np.array(WEIGHTS[order])
    inertia = np.polymul([2.0, -2.0, 0.0], delay - echo)
    load = alpha * np.polymul(np.polymul([1.0, 1.0], delay + echo), weights)
    polynomial = np.polyadd(np.polymul(inertia, [1.0, *np.zeros(order)]), load)
    return float(np.max(np.abs(np.roots(polynomial))))


def largest_stable_alpha(order: int, reflection: float, k: int, most: float = 4.0) -> float:
    """The α at which solutions begin to grow, coming from zero."""
    values = np.linspace(0.0, most, _SCAN + 1)[1:]
    growing = next((v for v in values if growth(v, order, reflection, k) > 1.0 + _ROUND), None)
    if growing is None:
        return most
    low, high = growing - most / _SCAN, growing
    for _ in range(50):
        middle = 0.5 * (low + high)
        if growth(middle, order, reflection, k) > 1.0 + _ROUND:
            high = middle
        else:
            low = middle
    return low


def lagged_column(A: float, order: int, reflection: float) -> float | None:
    """Largest stable r = α/A at the window A = c Δt/H; None where a pulse does not come back after whole windows."""
    k = round(2.0 / A)
    if abs(k * A - 2.0) > 1e-6:
        return None
    return largest_stable_alpha(order, reflection, k) / A
