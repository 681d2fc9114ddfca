"""Prediction of the next window's exchange from those of past windows."""

from __future__ import annotations

from collections import deque

import numpy as np

from shared.clock import Window
from shared.contract import Exchange, Kinematics, exchange_fields
from shared.run.checkpoint import State, inside

_WEIGHTS = {0: (1.0,), 1: (2.0, -1.0), 2: (3.0, -3.0, 1.0)}
"""Extrapolation of equally spaced values, the newest first, exact for polynomials of the order."""


class Predictor:
    """Extrapolates loads or motions with polynomials of `order` 0, 1 or 2, of lower order while the past is short."""

    def __init__(self, order: int, first: Exchange):
        self._past: deque[dict[str, np.ndarray]] = deque([exchange_fields(first)], maxlen=order + 1)
        self._kind = type(first)

    def predict(self, window: Window) -> Exchange:
        """The exchange expected in `window`, the next one. A motion ends where its mean velocity leads from the true
        place at the window's start."""
        weights = _WEIGHTS[len(self._past) - 1]
        expected = {
            name: sum(w * past[name] for w, past in zip(weights, self._past, strict=True)) for name in self._past[0]
        }
        if self._kind is Kinematics:
            expected["position"] = self._past[0]["position"] + window.length * expected["velocity_mean"]
        return self._kind(**expected)

    def add(self, found: Exchange) -> None:
        """Remember what a window brought."""
        self._past.appendleft(exchange_fields(found))

    def state(self) -> State:
        """The past that is remembered."""
        return {f"{k}/{name}": array for k, past in enumerate(self._past) for name, array in past.items()}

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        count = len(state) // len(self._past[0])
        self._past.clear()
        self._past.extend(inside(str(k), state) for k in range(count))


def carried_on(start: Kinematics, target: Kinematics, window: Window) -> Kinematics:
    """The motion over `window` of points that stand where `start` left them and are to end as `target` does: its mean
    velocity and acceleration are those of the way there, so that a predicted wall never jumps."""
    return Kinematics(
        target.position,
        target.velocity,
        target.acceleration,
        (target.position - start.position) / window.length,
        (target.velocity - start.velocity) / window.length,
    )
