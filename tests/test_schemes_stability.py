"""Where each scheme stops working: derived here for the protocol as built, and measured on the column model.

A free mass m on a column; window Δt; y = z⁻¹ one window back; Q the extrapolation of order 0, 1, 2 from past windows:
y, 2y − y², 3y − 3y² + y³. The structure moves under a constant force, so with v̄ the mean velocity of a window and F̄ the
mean load

    v̄_n − v̄_{n−1} = (Δt/2m) (L_n + L_{n−1}),   L = Q F̄  (the load used).

Absorbing column, F̄ = −ρc times the mean velocity of the wall, α = ρ c Δt/m:
    serial:    the wall moves as the structure      (1 − y) + (α/2)(1 + y) Q = 0
    parallel:  its end is x_{n−1} + Δt Q v̄, its mean velocity hence y v̄ + (1 − y) Q v̄, and
               (1 − y) + (α/2)(1 + y) Q (y + (1 − y) Q) = 0
Incompressible column, F̄ = −ρL times the wall's mean acceleration, r = ρL/m, a structure's mean acceleration a = L/m:
    serial:    1 + r Q = 0                           parallel: the wall's end velocity is Q v, hence 1 + r Q² = 0
Stable while no root y lies inside the unit circle.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from coupler.acceleration import Constant
from coupler.schemes import Iteration, serial_implicit
from coupler.vectors import Measure
from fluid_solver.models import make_model as make_fluid
from shared.clock import Clock
from shared.contract import ShearwaterError
from solid_solver.models import make_model as make_solid
from tests.coupled_models import couple, join, march, piston

Y = Polynomial([0.0, 1.0])
PREDICTION = {0: Y, 1: 2 * Y - Y**2, 2: 3 * Y - 3 * Y**2 + Y**3}
WINDOW = 1e-3
FREE = ["solid.spring.stiffness=[0,0,0]"]  # and pushed by a constant force from t = 0 on


def characteristic(kind: str, scheme: str, order: int, ratio: float) -> Polynomial:
    """The polynomial in y; `ratio` is α (absorbing) or r (incompressible)."""
    Q = PREDICTION[order]
    if kind == "incompressible":
        return 1 + ratio * (Q if scheme == "serial" else Q * Q)
    wall = Polynomial([1.0]) if scheme == "serial" else Y + (1 - Y) * Q
    return (1 - Y) + 0.5 * ratio * (1 + Y) * Q * wall


def boundary(kind: str, scheme: str, order: int) -> float:
    """Largest stable ratio."""
    low, high = 0.0, 8.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        roots = characteristic(kind, scheme, order, middle).roots()
        stable = np.all(np.abs(roots) >= 1.0 - 1e-12)
        low, high = (middle, high) if stable else (low, middle)
    return low


def growth(kind: str, scheme: str, order: int, ratio: float) -> float:
    """Growth a window of the piston's change of velocity, measured on the models."""
    if kind == "absorbing":
        density = 1000.0 * 50.0 * WINDOW / (0.1 * ratio)
        water = ["fluid.column.reflection=0"]
    else:
        density = 1000.0 * 1.0 / (0.1 * ratio)
        water = ["fluid.column.compressible=false"]
    scene = piston(
        [*FREE, *water, f"solid.density={density!r}", "end_time=0.2"],
        scheme=f"{scheme}-explicit",
        predictor=order,
        window=WINDOW,
    )
    places = couple(scene).points
    swings = np.abs(np.diff(places, 3))
    return float((swings[-30:].max() / swings[90:120].max()) ** (1.0 / 80.0))


LIMITS = {
    ("absorbing", "serial"): (2.0, 1.155, 0.709),
    ("absorbing", "parallel"): (0.6667, 0.2523, 0.0777),
    ("incompressible", "serial"): (1.0, 1.0 / 3.0, 1.0 / 7.0),
    ("incompressible", "parallel"): (1.0, 0.1547, 0.0316),
}
"""Serial: as published. Parallel: load and motion are both extrapolated, which second order in time needs."""


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(("kind", "scheme"), list(LIMITS))
def test_limits_of_the_protocol_as_built(kind, scheme, order):
    assert boundary(kind, scheme, order) == pytest.approx(LIMITS[kind, scheme][order], rel=2e-3)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("scheme", ["serial", "parallel"])
@pytest.mark.parametrize("kind", ["absorbing", "incompressible"])
def test_the_models_become_unstable_where_the_polynomial_says(kind, scheme, order):
    """The columns are exact in time, as if of endlessly many sub-steps: within 3 % of the boundary either way."""
    limit = boundary(kind, scheme, order)
    assert growth(kind, scheme, order, 0.97 * limit) < 1.0 < growth(kind, scheme, order, 1.03 * limit)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_growth_past_the_boundary_is_that_of_the_largest_root(order):
    ratio = 1.05 * boundary("absorbing", "serial", order)
    roots = characteristic("absorbing", "serial", order, ratio).roots()
    assert growth("absorbing", "serial", order, ratio) == pytest.approx(1.0 / np.abs(roots).min(), rel=2e-3)


class Recorded(Constant):
    """Constant relaxation that keeps the sizes of the residuals."""

    def __init__(self, omega):
        super().__init__(omega)
        self.sizes = []

    def next(self, x, found, weight):
        self.sizes.append(np.linalg.norm((found - x)[weight > 0.0]))
        return super().next(x, found, weight)


def residuals(sets, omega: float, most: int, window: float = WINDOW) -> list[float]:
    """Sizes of the residuals of the iterations of one window from a start at 1 m/s."""
    scene = piston([*FREE, *sets], window=window)
    clock = Clock.fitting(scene.end_time, window)
    c = join(make_fluid(scene, True, 1), make_solid(scene, True, 1), clock, 0)
    method = Recorded(omega)
    how = Iteration(method, Measure(0.0, 0.0, "force"), most, True)
    march(c, lambda c, w: serial_implicit(c, w, how), clock, 1)
    return method.sizes


@pytest.mark.parametrize(("r", "converges"), [(0.9, True), (1.1, False)])
def test_plain_iteration_flips_at_equal_masses(r, converges):
    found = residuals(["fluid.column.compressible=false", f"solid.density={10000.0 / r!r}"], 1.0, 40)
    assert (found[-1] < found[0]) == converges
    assert found[-1] / found[-2] == pytest.approx(r, rel=1e-6)


@pytest.mark.parametrize("water", ["fluid.column.compressible=false", "fluid.column.reflection=0"])
@pytest.mark.parametrize("density", [1000.0, 8000.0])
def test_relaxation_flips_at_two_over_one_plus_measured_g(water, density):
    sets = [water, f"solid.density={density!r}"]
    first, second, third = residuals(sets, 1.0, 4, 4e-3)[:3]
    g = third / second
    assert second / first == pytest.approx(g, rel=1e-6)
    limit = 2.0 / (1.0 + g)
    below, above = (residuals(sets, factor * limit, 30, 4e-3) for factor in (0.98, 1.02))
    assert below[-1] < below[0]
    assert above[-1] > above[0]


def test_lag_pumps_a_lossless_closed_column_and_iterating_stops_it():
    """α 0.3, r 15, five acoustic periods: the lagged load pumps the swing up."""
    start = ["solid.loads=[]", "solid.bodies.piston.velocity=[1.0,0.0]"]
    sets = [*FREE, *start, "fluid.column.far_end=closed", f"solid.density={10000.0 / 15.0!r}", "end_time=0.2"]
    window = 0.3 * 10000.0 / 15.0 * 0.1 / (1000.0 * 50.0)

    def swing(**coupling):
        try:
            return np.abs(np.diff(couple(piston(sets, window=window, **coupling)).points)[-100:]).max() / window
        except ShearwaterError:
            return np.inf

    lagged, iterated = swing(scheme="serial-explicit"), swing(scheme="serial-implicit")
    assert iterated <= 1.0
    assert lagged > 2.0 * iterated
