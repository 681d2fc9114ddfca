"""Statistics of time histories: of probes and of the curves that they are compared with.

A history is a pair of arrays, times (n,) [s] in increasing order and values (n,). Between its points it is linear;
rows whose value is not finite say that there was nothing to measure and are left out.
"""

from __future__ import annotations

import math

import numpy as np

Interval = tuple[float, float]

_TIME_ROUNDING = 1e-9  # of an interval's length, within which a history that ends there covers it


def statistic(name: str, time: np.ndarray, value: np.ndarray, between: Interval | None = None) -> float | None:
    """One of mean, min, max, final, t_min, t_max, slope, period, change over `between` [s] (default: all of it).

    mean is time-weighted (trapezoidal rule), slope that of the least-squares line through the points, t_min and t_max
    the first times of the extremes, period as in `_period`. None if the history does not cover the interval, or has no
    value in it.
    """
    time, value = finite(time, value)
    if len(time) == 0:
        return None
    if between is not None:
        if not covers(time, between):
            return None
        time, value = _cut(time, value, between, with_ends=name not in ("slope", "period"))
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
}
