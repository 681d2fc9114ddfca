"""Prescribed rigid motion by a time table: translation, and rotation about a point.

Between the table's times a cubic, with the rates of quartics through five of its points. It rises and falls only where
the table does, so that what the table holds stands still; but where a table shows its turning points, by a curvature of
one sign over two more steps on either side, the cubic turns as smoothly. Walls push water by their acceleration, and
rates made zero there, as of a plain monotone cubic, leave accelerations 125 % off however fine the table. Of a sine
with 20 and 40 points a period they are now 1.8 and 0.25 % of the largest off. Where steps are uneven, a quartic swings
between far points: there rates are those of parabolas through three.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from shared.schema.geometry import Motion

_SAMPLES = 1001  # times at which a motion's speed is looked at
_POINTS, _FEWER = 5, 3  # of the table through which a rate is taken; where its steps are uneven
_UNEVEN = 2.5  # longest over shortest step between the points from which fewer are taken
_STEEPEST = 3.0  # rate over the lesser slope of both sides up to which a cubic rises only where its points do
_ALIKE = 2.0  # factor within which curvatures of neighbours are those of one smooth turn
_SLACK = 1.5  # rate over that of the parabolas up to which a turning point is taken as it comes


class MotionTable:
    """A scene's `Motion` as a function of time; held after its last time."""

    def __init__(self, motion: Motion):
        count = len(motion.times)
        shift = np.zeros((count, 2)) if motion.translation is None else np.asarray(motion.translation, dtype=float)
        angle = np.zeros(count) if motion.rotation is None else np.radians(motion.rotation)
        self.about = np.asarray(motion.about, dtype=float)
        self._end = motion.times[-1]
        times, places = np.asarray(motion.times, dtype=float), np.c_[shift, angle]
        self._curve = CubicHermiteSpline(times, places, _rates(times, places))

    def at(self, time: float) -> np.ndarray:
        """Displacement x, y [m] and angle [rad], their rates and their second rates, by row (3, 3), at `time` [s]."""
        orders = range(3) if time <= self._end else range(1)
        result = np.zeros((3, 3))
        for order in orders:
            result[order] = self._curve(min(time, self._end), order)
        return result

    def displacements(self, times: np.ndarray, order: int = 0) -> np.ndarray:
        """Displacement x, y [m] and angle [rad], (k, 3), at `times` (k,) [s] up to the last; of order 1 their rates."""
        return self._curve(np.minimum(times, self._end), order)


def _rates(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Rates (n, m) of the `values` (n, m) at the `times` (n,) [s] (see the module's text; after Huynh 1993)."""
    steps = np.diff(times)[:, None]
    slope = np.diff(values, axis=0) / steps
    curvature = np.zeros((len(times) + 2, values.shape[1]))  # of the parabolas, halved; none past the ends
    curvature[2:-2] = np.diff(slope, axis=0) / (times[2:] - times[:-2])[:, None]
    around = [curvature[k : k + len(steps)] for k in range(4)]
    reach = np.minimum(steps, np.minimum(np.r_[steps[:1], steps[:-1]], np.r_[steps[1:], steps[-1:]]))
    bend = reach * _least(0.5 * (around[1] + around[2]), *(_ALIKE * near for near in around))
    turn = _least(np.r_[slope[:1] - bend[:1], slope + bend], np.r_[slope - bend, slope[-1:] + bend[-1:]])
    monotone = _least(np.r_[slope[:1], slope], np.r_[slope, slope[-1:]])
    most = np.maximum(_STEEPEST * np.abs(monotone), _SLACK * np.abs(turn))
    return _least(_smooth(times, values), np.sign(turn) * most)


def _least(*values: np.ndarray) -> np.ndarray:
    """The one least in size where all have one sign, else 0."""
    sign, size = np.sign(values), np.abs(values)
    return np.where(np.all(sign == sign[0], axis=0), sign[0] * size.min(axis=0), 0.0)


def _smooth(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Rates (n, m) at each time of the quartic through the five points around it, or but for one side's last; of the
    parabola through three where their steps are uneven."""
    found = _through(times, values, _around(times, _FEWER))
    for shift in (1, -1, 0):
        around = _around(times, _POINTS, shift)
        steps = np.diff(times[around], axis=1)
        even = steps.max(axis=1) < _UNEVEN * steps.min(axis=1)
        found = np.where(even[:, None], _through(times, values, around), found)
    return found


def _around(times: np.ndarray, most: int, shift: int = 0) -> np.ndarray:
    """Indices of the points around each time, or around the one `shift` later: `most`, or what fewer there are."""
    first = np.clip(np.arange(len(times)) - most // 2 + shift, 0, max(len(times) - most, 0))
    return first[:, None] + np.arange(min(most, len(times)))


def _through(times: np.ndarray, values: np.ndarray, around: np.ndarray) -> np.ndarray:
    """Rates (n, m) at each time of the polynomial through the points `around` (n, k) it, itself among them: a mean of
    the slopes to the others, by Lagrange."""
    own = np.arange(len(times))[:, None]
    others = around[around != own].reshape(len(times), -1)
    away = times[others] - times[own]
    apart = away[:, None] - away[:, :, None]
    same = np.eye(away.shape[1], dtype=bool)
    share = np.prod(np.where(same, 1.0, away[:, None] / np.where(same, 1.0, apart)), axis=2)
    return np.einsum("ij,ijk->ik", share / away, values[others] - values[own])


def largest_speed(motion: Motion, corners: np.ndarray, order: int = 1) -> float:
    """A bound of the speed [m/s] of the points `corners` (n, 2) [m]: translation, and rotation at the farthest; of
    order 2 of the second rates [m/s²], but for what turns towards the centre."""
    table = MotionTable(motion)
    reach = float(np.hypot(*(np.asarray(corners, dtype=float) - table.about).T).max())
    rates = table.displacements(np.linspace(0.0, motion.times[-1], _SAMPLES), order)
    return float(np.max(np.hypot(rates[:, 0], rates[:, 1]) + reach * np.abs(rates[:, 2])))
