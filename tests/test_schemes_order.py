"""Order in time on the piston against its exact solutions; what iterated schemes agree on."""

from __future__ import annotations

import numpy as np
import pytest

from tests.coupled_models import couple, piston
from tests.piston_exact import Piston

FAR_END = {
    "open": [],
    "closed": ["fluid.column.far_end=closed"],
    "absorbing": ["fluid.column.reflection=0"],
    "incompressible": ["fluid.column.compressible=false"],
}


def error(far_end: str, windows: int, end: float = 0.7, **coupling) -> float:
    """Largest error of the displacement over that at rest."""
    sets = [*FAR_END[far_end], f"end_time={end}"]
    history = couple(piston(sets, window=end / windows, tolerance=1e-8, **coupling))
    return float(np.abs(history.points - Piston().displacement(history.times, far_end)).max() / 0.01)


def order(far_end: str, windows: int, **coupling) -> float:
    """Measured between `windows` and twice as many."""
    return float(np.log2(error(far_end, windows, **coupling) / error(far_end, 2 * windows, **coupling)))


@pytest.mark.parametrize("scheme", ["serial", "parallel"])
def test_lagged_loads_are_of_first_order(scheme):
    assert order("absorbing", 350, scheme=f"{scheme}-explicit", predictor=0) == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
def test_lagged_loads_on_an_open_column_are_of_first_order():
    assert order("open", 2800, scheme="serial-explicit", predictor=0) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(("far_end", "windows"), [("open", 700), ("closed", 700), ("absorbing", 350)])
def test_extrapolated_loads_are_of_second_order(far_end, windows):
    assert order(far_end, windows, scheme="serial-explicit", predictor=1) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("far_end", list(FAR_END))
def test_iterated_loads_are_of_second_order(far_end):
    assert order(far_end, 175, scheme="serial-implicit") == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("acceleration", "scheme"), [("aitken", "serial"), ("constant", "serial"), ("iqn-ils", "parallel")]
)
def test_all_iterated_schemes_find_the_same_motion(acceleration, scheme):
    sets = ["end_time=0.1"]
    first = couple(piston(sets, window=1e-3, tolerance=1e-10, scheme="serial-implicit"))
    method = {"acceleration": acceleration, "scheme": f"{scheme}-implicit", "max_iterations": 60}
    other = couple(piston(sets, window=1e-3, tolerance=1e-10, **method))
    np.testing.assert_allclose(other.points, first.points, atol=1e-9 * np.abs(first.points).max())


def test_lagged_errors_are_those_of_the_reference():
    """The table of the piston's closed form lists 0.0104 for a window of 1 ms with trapezoidal lagged loads."""
    assert error("open", 700, scheme="serial-explicit", predictor=0) == pytest.approx(0.010399, rel=0.02)
