"""Statistics of time histories: of probes and of the curves that they are compared with.

A history is a pair of arrays, times (n,) [s] in increasing order and values (n,). Between its points it is linear;
rows whose value is not finite say that there was nothing to measure and are left out.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import least_squares

Interval = tuple[float, float]

_OF_POINTS = ("slope", "period", "decay", "wave-period", "wave-decay")  # not of ends that are interpolated
_LEAST_FOR_A_WAVE = 8  # points
_TIME_ROUNDING = 1e-9  # of an interval's length, within which a history that ends there covers it


def statistic(name: str, time: np.ndarray, value: np.ndarray, between: Interval | None = None) -> float | None:
    """One of mean, min, max, final, t_min, t_max, slope, period, change, decay, wave-period, wave-decay.

    Over `between` [s] (default: all of it). mean is time-weighted (trapezoidal rule), slope that of the least-squares
    line through the points, t_min and t_max the first times of the extremes, period as in `_period`, decay as in
    `_decay`, the waves' as in `_wave`. None if the history does not cover the interval, or has no value in it.
    """
    time, value = finite(time, value)
    if len(time) == 0:
        return None
    if between is not None:
        if not covers(time, between):
            return None
        time, value = _cut(time, value, between, with_ends=name not in _OF_POINTS)
    return _STATISTICS[name](time, value)


def covers(time: np.ndarray, between: Interval) -> bool:
    """Whether a history at `time` (n,) [s] reaches over the interval, to rounding."""
    slack = _TIME_ROUNDING * max(abs(between[0]), abs(between[1]))
    return len(time) > 0 and time[0] <= between[0] + slack and between[1] <= time[-1] + slack


def relative_error(computed: float, value: float) -> float:
    """(computed − value)/|value|; where the reference value is 0 the absolute error, `computed` itself."""
    return (computed - value) / abs(value) if value else computed


def finite(time: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rows of a history that have a value."""
    time, value = np.asarray(time, dtype=float), np.asarray(value, dtype=float)
    good = np.isfinite(value)
    return time[good], value[good]


def _cut(time: np.ndarray, value: np.ndarray, between: Interval, with_ends: bool):
    """The part of a history in the interval; with its ends interpolated, or of its own points alone.

    A line is fitted to what was measured: interpolated ends would count twice where points are few.
    """
    lower, upper = between
    inside = (time > lower) & (time < upper)
    if not with_ends and np.count_nonzero(inside) > 1:
        inside |= (time == lower) | (time == upper)
        return time[inside], value[inside]
    ends = np.interp([lower, upper], time, value)
    times = np.concatenate([[lower], time[inside], [upper]])
    return times, np.concatenate([ends[:1], value[inside], ends[1:]])


def _mean(time: np.ndarray, value: np.ndarray) -> float:
    length = time[-1] - time[0]
    return float(np.trapezoid(value, time) / length) if length > 0.0 else float(value[-1])


def _slope(time: np.ndarray, value: np.ndarray) -> float | None:
    offset = time - time.mean()
    spread = float(offset @ offset)
    return float(offset @ (value - value.mean())) / spread if spread > 0.0 and math.isfinite(spread) else None


def _period(time: np.ndarray, value: np.ndarray) -> float | None:
    """Mean time between crossings of the middle between the extremes, the first way that it is crossed; None if it is
    not crossed twice."""
    above = value > 0.5 * (value.max() + value.min())
    crossed = np.flatnonzero(above[1:] != above[:-1])
    if len(crossed) < 3:
        return None
    middle = 0.5 * (value.max() + value.min())
    share = (middle - value[crossed]) / (value[crossed + 1] - value[crossed])
    times = (time[crossed] + share * (time[crossed + 1] - time[crossed]))[::2]
    return float((times[-1] - times[0]) / (len(times) - 1))


def _change(time: np.ndarray, value: np.ndarray) -> float:
    """Last value less the first, over the largest size."""
    size = float(np.max(np.abs(value)))
    return float(value[-1] - value[0]) / size if size > 0.0 else 0.0


def _decay(time: np.ndarray, value: np.ndarray) -> float | None:
    """Rate [1/s] of an exponential decay: minus the slope of the logarithm's line; None unless all is of one sign."""
    if not (np.all(value > 0.0) or np.all(value < 0.0)):
        return None
    slope = _slope(time, np.log(np.abs(value)))
    return None if slope is None else -slope


def _wave(time: np.ndarray, value: np.ndarray) -> tuple[float, float] | None:
    """Period [s] and decay rate γ [1/s] of the best fit d + e^(−γt) (a + b cos ωt + c sin ωt); None for a flat history.

    a to d are linear and solved for inside; the search starts at the strongest of the Fourier frequencies.
    """
    if len(time) < _LEAST_FOR_A_WAVE or np.ptp(value) == 0.0:
        return None
    t = time - time[0]
    even = np.linspace(0.0, t[-1], 4 * len(t))
    line = np.polyfit(even, np.interp(even, t, value), 1)
    spectrum = np.abs(np.fft.rfft(np.interp(even, t, value) - np.polyval(line, even), 8 * len(even)))
    strongest = max(1, int(spectrum.argmax()))
    omega = 2.0 * math.pi * strongest / (8 * len(even) * (even[1] - even[0]))

    def misfit(guess):
        fading = np.exp(-guess[1] * t)
        shape = np.c_[np.ones_like(t), fading, fading * np.cos(guess[0] * t), fading * np.sin(guess[0] * t)]
        return shape @ np.linalg.lstsq(shape, value, rcond=None)[0] - value

    found = least_squares(misfit, [omega, 1.0 / t[-1]], x_scale=[omega, 1.0 / t[-1]]).x
    return 2.0 * math.pi / abs(found[0]), float(found[1])


_STATISTICS = {
    "mean": _mean,
    "min": lambda time, value: float(value.min()),
    "max": lambda time, value: float(value.max()),
    "final": lambda time, value: float(value[-1]),
    "t_min": lambda time, value: float(time[value.argmin()]),
    "t_max": lambda time, value: float(time[value.argmax()]),
    "slope": _slope,
    "period": _period,
    "change": _change,
    "decay": _decay,
    "wave-period": lambda time, value: (_wave(time, value) or (None, None))[0],
    "wave-decay": lambda time, value: (_wave(time, value) or (None, None))[1],
}
