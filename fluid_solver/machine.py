"""What the machine could do at best: the roof that a benchmark's figures stand under."""

from __future__ import annotations

import time

import numpy as np

from shared.jit import njit

_LANES = 64  # independent sums: enough to fill the pipelines of eight wide registers
_ROUNDS = 4_000_000
_COPIED = 32_000_000  # float64; far more than any cache holds


@njit
def _multiply_add(rounds, a, b):
    x = np.linspace(0.0, 1.0, _LANES)
    for _ in range(rounds):
        for lane in range(_LANES):
            x[lane] = x[lane] * a + b
    return x.sum()


def multiply_add_rate() -> float:
    """Floating-point operations per second of one core that multiplies and adds float64 in whole vectors."""
    _multiply_add(10, 0.999, 0.1)
    return 2.0 * _LANES * _ROUNDS / best_of(3, lambda: _multiply_add(_ROUNDS, 0.999, 0.1))


def copy_rate() -> float:
    """Bytes per second, read and written, of one core that copies a large array."""
    source, target = np.ones(_COPIED), np.zeros(_COPIED)
    return 2.0 * source.nbytes / best_of(3, lambda: np.copyto(target, source))


def best_of(times: int, work) -> float:
    """Shortest of several wall times of `work()` [s]."""
    found = []
    for _ in range(times):
        begun = time.perf_counter()
        work()
        found.append(time.perf_counter() - begun)
    return min(found)
