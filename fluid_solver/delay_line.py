"""The memory of waves under way: a function of time and its integral at past times, for a row of columns at once."""

from __future__ import annotations

import numpy as np

from fluid_solver.hermite import hermite

_FIRST_ROOM = 64  # times kept before the memory is made larger
_EARLY = 1e-9  # of the last step: a time this little before the first still counts as the first


class DelayLine:
    """Values f and integrals F of `count` functions, zero before the first time kept; cubic between times.

    Exact at the times given; between them of fourth order in F and third in f (Hermite's cubic through F and f).
    """

    def __init__(self, count: int):
        self._times = np.zeros(_FIRST_ROOM)
        self._rows = np.zeros((_FIRST_ROOM, 2, count))
        self._begin = self._end = 0

    def append(self, time: float, integral: np.ndarray, value: np.ndarray) -> None:
        """F and f (count,) at a `time` later than all others."""
        if self._end == len(self._times):
            self._make_room()
        self._times[self._end] = time
        self._rows[self._end] = integral, value
        self._end += 1

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """F and f (count,) at `time`, which is not before what was forgotten."""
        times = self._times[self._begin : self._end]
        k = int(np.searchsorted(times, time, side="right"))
        rows = self._rows[self._begin : self._end]
        if k == len(times):
            return rows[-1, 0].copy(), rows[-1, 1].copy()
        if k == 0:
            early = times[0] - time > _EARLY * np.ptp(times[:2])
            return (np.zeros_like(rows[0, 0]),) * 2 if early else (rows[0, 0].copy(), rows[0, 1].copy())
        step = times[k] - times[k - 1]
        return hermite((time - times[k - 1]) / step, step, *rows[k - 1], *rows[k])

    def value(self, time: np.ndarray, column: np.ndarray) -> np.ndarray:
        """f (m,) of the functions `column` (m,) at the times (m,), as `at` has it."""
        times, rows = self._times[self._begin : self._end], self._rows[self._begin : self._end]
        if len(times) == 1:
            return np.where(time < times[0], 0.0, rows[0, 1, column])
        early = times[0] - time > _EARLY * (times[1] - times[0])
        time = np.clip(time, times[0], times[-1])
        k = np.clip(np.searchsorted(times, time, side="right"), 1, len(times) - 1)
        step = times[k] - times[k - 1]
        before, after = (rows[i, :, column].T for i in (k - 1, k))
        return np.where(early, 0.0, hermite((time - times[k - 1]) / step, step, *before, *after)[1])

    def forget(self, time: float) -> None:
        """Nothing before `time` will be asked for any more."""
        while self._end - self._begin > 2 and self._times[self._begin + 1] < time:
            self._begin += 1

    def state(self) -> np.ndarray:
        """All that is kept, as one array (times, 1 + 2 count)."""
        kept = slice(self._begin, self._end)
        return np.column_stack([self._times[kept], self._rows[kept].reshape(self._end - self._begin, -1)])

    def restore(self, state: np.ndarray) -> None:
        """Back to a `state`, bit for bit."""
        count = len(state)
        while len(self._times) < count + 1:
            self._begin = self._end = 0
            self._make_room(2)
        self._begin, self._end = 0, count
        self._times[:count] = state[:, 0]
        self._rows[:count] = state[:, 1:].reshape(count, 2, -1)

    def _make_room(self, factor: int = 1) -> None:
        """Move what is kept to the front, of a larger memory if half of it is in use."""
        kept = self._end - self._begin
        if 2 * kept > len(self._times):
            factor = 2
        times, rows = self._times[self._begin : self._end], self._rows[self._begin : self._end]
        if factor > 1:
            self._times = np.concatenate([times, np.zeros(factor * len(self._times) - kept)])
            self._rows = np.concatenate([rows, np.zeros((len(self._times) - kept, *rows.shape[1:]))])
        else:
            self._times[:kept], self._rows[:kept] = times.copy(), rows.copy()
        self._begin, self._end = 0, kept
