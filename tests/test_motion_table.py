"""Prescribed motions between the times of their tables."""

import numpy as np
import pytest

from shared.geometry.motion_table import MotionTable
from shared.schema.geometry import Motion


def sampled(times, x, order):
    """Derivative of that order along x, at 50 places a step, of the table `x` at `times`."""
    motion = Motion(times=list(times), translation=[(float(k), 0.0) for k in x])
    table = MotionTable(motion)
    fine = np.linspace(0.0, times[-1], 50 * len(times))
    return fine, np.array([table.at(t)[order, 0] for t in fine])


def test_what_a_table_holds_stands_still_and_what_it_starts_does_not_turn_back():
    for x in ([0, 0, 1, 1], [0, 1, 1, 0], [0, 0, 0, 0.01, 1, 2, 3, 3, 3, 1, 1]):
        fine, place = sampled(np.arange(float(len(x))), x, 0)
        lower, upper = (np.minimum(x[:-1], x[1:]), np.maximum(x[:-1], x[1:]))
        step = np.minimum(fine.astype(int), len(x) - 2)
        assert np.all(place >= lower[step] - 1e-12)
        assert np.all(place <= upper[step] + 1e-12)
    _, speed = sampled([0.0, 0.3, 0.4, 1.0, 1.7], [0.0, 0.6, 0.8, 2.0, 3.4], 1)
    np.testing.assert_allclose(speed, 2.0)


@pytest.mark.parametrize("phase", [0.0, 0.05, 0.5, 1.0])
def test_a_wall_that_swings_has_the_acceleration_of_its_swing(phase):
    """A plain monotone cubic: 125 % off at every turning point, however many points."""
    for count, error in ((20, 0.02), (40, 0.003)):
        times = np.arange(3 * count) / count
        omega = 2.0 * np.pi
        fine, a = sampled(times, np.sin(omega * times + phase), 2)
        inside = (fine > 3.0 / count) & (fine < times[-4])
        assert np.abs(a + omega**2 * np.sin(omega * fine + phase))[inside].max() < error * omega**2


def test_a_uniform_acceleration_from_rest_is_met_exactly():
    times = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(sampled(times, times**2, 2)[1], 2.0, rtol=1e-9)


def test_a_long_step_beside_short_ones_is_taken_at_its_own_speed():
    """A piston that is brought to 0.8 m/s in five points and then goes on: the quartic through them made 0.27 to 2.4
    m/s of the last step, and the force of its bore 36 % too large."""
    fine, speed = sampled([0.0, 0.1, 0.2, 0.3, 0.4, 1.2], [0.0, 0.02, 0.08, 0.16, 0.24, 0.88], 1)
    np.testing.assert_allclose(speed[fine > 0.4], 0.8)
    times = np.r_[0.0, 2.0 + np.arange(41) / 20]  # a wait, then a swing
    fine, a = sampled(times, np.where(times > 2.0, 1.0 - np.cos(2.0 * np.pi * times), 0.0), 2)
    swings = (fine > 2.0) & (fine < 3.0)
    assert np.abs(a - 4.0 * np.pi**2 * np.cos(2.0 * np.pi * fine))[swings].max() < 0.04 * 4.0 * np.pi**2
