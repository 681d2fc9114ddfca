"""All time arithmetic: whole windows, whole sub-steps. Nobody else adds time steps.

Times are computed as index times length, never accumulated, so that they are the same on every participant and
after a restart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Window:
    """One coupling window: its number from 0, its ends in seconds, and the iteration within it."""

    index: int
    t0: float
    t1: float
    iteration: int = 0

    @property
    def length(self) -> float:
        """Length in seconds."""
        return self.t1 - self.t0

    def again(self, iteration: int) -> Window:
        """The same window at another iteration."""
        return replace(self, iteration=iteration)

    def substeps(self, stable_step: float) -> int:
        """Smallest number of equal sub-steps that are no longer than `stable_step` [s]."""
        return max(1, math.ceil(self.length / stable_step * (1.0 - 1e-12)))


@dataclass(frozen=True)
class Clock:
    """A run of `count` equal windows over `end` seconds."""

    end: float
    count: int

    @classmethod
    def fitting(cls, end: float, window: float) -> Clock:
        """The fewest equal windows, none longer than `window` [s], that fill `end` [s]."""
        return cls(end, max(1, math.ceil(end / window * (1.0 - 1e-12))))

    @property
    def window_length(self) -> float:
        """Length of a window in seconds."""
        return self.end / self.count

    def time(self, index: int) -> float:
        """Time at the start of window `index` in seconds."""
        return self.end * (index / self.count)

    def window(self, index: int, iteration: int = 0) -> Window:
        """Window number `index`."""
        return Window(index, self.time(index), self.time(index + 1), iteration)

    def crosses(self, index: int, events: int) -> bool:
        """Whether one of `events` equally spaced times (the last at `end`) falls in window `index`."""
        return (index + 1) * events // self.count > index * events // self.count
