"""Statistics of a probe against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from shared.run.statistics import relative_error, statistic


def test_mean_is_weighted_by_time_not_by_rows():
    """A thousand rows of the start-up shock must not outweigh the long rest."""
    time = np.concatenate([np.linspace(0.0, 0.01, 1001), [0.0100001, 1.0]])
    value = np.where(time <= 0.01, 1.0, 0.0)
    assert statistic("mean", time, value) == pytest.approx(0.01, abs=1e-4)
    assert statistic("mean", time, value, (0.005, 0.01)) == pytest.approx(1.0)


MOMENTS = st.integers(0, 10**6).map(lambda n: n * 1e-6)  # s: no two nearer than a run's rows could be


@given(
    slope=st.floats(-10, 10),
    offset=st.floats(-10, 10),
    times=st.lists(MOMENTS, min_size=2, max_size=30, unique=True).map(sorted),
    ends=st.tuples(MOMENTS, MOMENTS).map(sorted),
)
def test_a_straight_line_has_its_own_slope_and_mean(slope, offset, times, ends):
    time = np.array([-0.5, *times, 1.5])
    value = offset + slope * time
    lower, upper = ends
    assert statistic("mean", time, value, (lower, upper)) == pytest.approx(
        offset + slope * (lower + upper) / 2.0, abs=1e-9
    )
    if upper - lower > 1e-3:
        assert statistic("slope", time, value, (lower, upper)) == pytest.approx(slope, abs=1e-6)
    assert statistic("final", time, value, (lower, upper)) == pytest.approx(offset + slope * upper, abs=1e-9)


def test_slope_of_few_measured_points_is_that_of_their_line():
    """Martin & Moyce's front (a = 2.25 in) over 1.5 < T < 4: three points inside, two just outside."""
    time = np.array([0.832, 1.219, 1.997, 2.547, 3.345, 4.034, 4.418])
    front = np.array([1.217, 1.474, 2.292, 2.995, 4.134, 4.944, 5.881])
    expected = np.polyfit(time[2:5], front[2:5], 1)[0]
    assert statistic("slope", time, front, (1.5, 4.0)) == pytest.approx(expected, rel=1e-12)
    assert statistic("slope", time, front, (2.0, 2.5)) == pytest.approx((2.995 - 2.292) / (2.547 - 1.997))


def test_intervals_that_are_not_covered_have_no_statistic():
    time, value = np.array([0.0, 0.5, 1.0]), np.array([1.0, 2.0, 3.0])
    assert statistic("max", time, value, (0.2, 1.0)) == 3.0
    assert statistic("max", time, value, (0.2, 1.0 + 1e-12)) == 3.0
    assert statistic("max", time, value, (0.2, 1.01)) is None
    assert statistic("max", time, value, (-0.1, 1.0)) is None
    assert statistic("mean", np.array([]), np.array([])) is None
    # A dry sensor has no value until the water comes.
    wet = np.array([math.nan, 2.0, 3.0])
    assert statistic("min", time, wet) == 2.0
    assert statistic("mean", time, wet, (0.0, 1.0)) is None


def test_relative_error():
    assert relative_error(1.1, 1.0) == pytest.approx(0.1)
    assert relative_error(-1.1, -1.0) == pytest.approx(-0.1)  # too far down is negative
    assert relative_error(0.3, 0.0) == 0.3
