"""Prediction of the mean load of the next window from those of past windows."""

from __future__ import annotations

from collections import deque

from shared.contract import Loads

_WEIGHTS = {0: (1.0,), 1: (2.0, -1.0), 2: (3.0, -3.0, 1.0)}
"""Extrapolation of equally spaced window means, the newest first, exact for polynomials of the order."""


class Predictor:
    """Extrapolates with polynomials of `order` 0, 1 or 2, of lower order while the past is short."""

    def __init__(self, order: int, first: Loads):
        self._past: deque[Loads] = deque([first], maxlen=order + 1)

    def predict(self) -> Loads:
        """The load expected in the next window."""
        weights = _WEIGHTS[len(self._past) - 1]
        pairs = list(zip(weights, self._past, strict=True))
        return Loads(sum(w * p.pressure for w, p in pairs), sum(w * p.force for w, p in pairs))

    def add(self, found: Loads) -> None:
        """Remember the load found in a window."""
        self._past.appendleft(found)
