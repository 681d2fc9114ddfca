"""How a fixed-point problem x = H(x) is solved from evaluations x̃ = H(x): on plain vectors, one class per method.

r = x̃ − x is the residual. Each class offers

    begin()                          a new window begins
    next(x, found, weight) → x       the next point to try; `weight` (n,) makes unlike entries comparable: norms and
                                     fits are of weight · r; entries of weight 0 are carried along
    forget()                         the window ends without an answer: what it told of H is not to be used again
    state(), restore(state)          what is remembered from window to window, as named arrays

Aitken: Irons & Tuck, Int. J. Numer. Methods Engrg. 1 (1969) 275. IQN-ILS: Degroote, Bathe & Vierendeels, Comput.
Struct. 87 (2009) 793, with the QR filter of Haelterman et al., Comput. Struct. 171 (2016) 9.
"""

from __future__ import annotations

from collections import deque
from typing import Protocol

import numpy as np

from shared.run.checkpoint import State, inside
from shared.schema.coupling import Coupling

FILTER = 1e-3
"""A difference that the newer ones explain up to this fraction of its length says nothing new, and is left out."""
_LARGEST_FACTOR = 2.0  # of Aitken's relaxation, to either side


class Acceleration(Protocol):
    """See the module's text."""

    def begin(self) -> None: ...

    def next(self, x: np.ndarray, found: np.ndarray, weight: np.ndarray) -> np.ndarray: ...

    def forget(self) -> None: ...

    def state(self) -> State: ...

    def restore(self, state: State) -> None: ...


class Constant:
    """x + ω r."""

    def __init__(self, omega: float):
        self._omega = omega

    def begin(self) -> None:
        """Nothing is remembered."""

    def next(self, x: np.ndarray, found: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """The next point to try."""
        return x + self._omega * (found - x)

    def forget(self) -> None:
        """Nothing is remembered."""

    def state(self) -> State:
        """Nothing."""
        return {}

    def restore(self, state: State) -> None:
        """Nothing."""


class Aitken:
    """x + ω_k r_k with ω_k = −ω_{k−1} r_{k−1}·(r_k − r_{k−1})/|r_k − r_{k−1}|²; a window begins with the last ω."""

    def __init__(self, omega: float):
        self._first = self._omega = omega
        self._last: np.ndarray | None = None

    def begin(self) -> None:
        """Differences of another window do not count."""
        self._last = None

    def next(self, x: np.ndarray, found: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """The next point to try."""
        residual = found - x
        if self._last is not None:
            # Both residuals by today's weight, which differs from call to call.
            before, change = weight * self._last, weight * (residual - self._last)
            square = change @ change
            if square > 0.0:
                omega = -self._omega * (before @ change) / square
                self._omega = float(np.clip(omega, -_LARGEST_FACTOR, _LARGEST_FACTOR)) or self._omega
        self._last = residual
        return x + self._omega * (found - x)

    def forget(self) -> None:
        """Back to the first ω."""
        self._omega = self._first

    def state(self) -> State:
        """The last ω."""
        return {"omega": np.array(self._omega)}

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        self._omega = float(state["omega"])


class IqnIls:
    """x̃ + Σ c_i Δx̃_i with the c_i that make |r + Σ c_i Δr_i| least; relaxation by ω while there are no differences.

    Differences of `reuse` past windows go on being used, newest first; not those of a window that found no answer.
    There H is not smooth, and differences across a jump say nothing of its slope: used on, they sent the next windows
    17 times too far, until the structure turned inside out.
    """

    def __init__(self, omega: float, reuse: int):
        self._omega = omega
        self._columns: deque[list[tuple[np.ndarray, np.ndarray]]] = deque(maxlen=reuse + 1)  # windows, newest first
        self._columns.appendleft([])
        self._last: tuple[np.ndarray, np.ndarray] | None = None

    def begin(self) -> None:
        """The differences of the window before are kept as long as `reuse` says."""
        if self._columns[0] or self._columns.maxlen == 1:
            self._columns.appendleft([])
        self._last = None

    def next(self, x: np.ndarray, found: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """The next point to try."""
        residual = found - x
        if self._last is not None:
            self._columns[0].insert(0, (residual - self._last[0], found - self._last[1]))
        self._last = residual, found
        chosen, basis, upper = self._independent(weight)
        if not chosen:
            return x + self._omega * residual
        counted = weight > 0.0
        c = np.linalg.solve(upper, -(basis @ (weight * residual)[counted]))
        return found + c @ np.array([column for _, column in chosen])

    def forget(self) -> None:
        """The window's own differences go."""
        self._columns[0].clear()

    def state(self) -> State:
        """The differences that are kept: per window (newest first) and pair (newest first) Δr and Δx̃."""
        return {
            f"{window}/{pair}": np.array(columns)
            for window, pairs in enumerate(self._columns)
            for pair, columns in enumerate(pairs)
        } | {"windows": np.array(len(self._columns))}

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        self._columns.clear()
        for window in range(int(state["windows"])):
            pairs = inside(str(window), state)
            self._columns.append([tuple(pairs[str(pair)]) for pair in range(len(pairs))])

    def _independent(self, weight: np.ndarray):
        """Differences, newest first, that the newer ones do not explain; orthonormal rows and R of their Δr, of the
        entries that count."""
        counted = weight > 0.0
        scale = weight[counted]
        pairs = [pair for window in self._columns for pair in window]
        most = min(len(pairs), len(scale))
        chosen, basis, upper = [], np.empty((most, len(scale))), np.zeros((most, most))
        for pair in pairs:
            k = len(chosen)
            if k == most:
                break
            column = scale * pair[0][counted]
            size = np.linalg.norm(column)
            for _ in range(2):  # twice is enough
                parts = basis[:k] @ column
                column -= parts @ basis[:k]
                upper[:k, k] += parts
            left = np.linalg.norm(column)
            if left > FILTER * size:
                chosen.append(pair)
                basis[k] = column / left
                upper[k, k] = left
            else:
                upper[:k, k] = 0.0
        count = len(chosen)
        return chosen, basis[:count], upper[:count, :count]


def make_acceleration(coupling: Coupling) -> Acceleration:
    """The method that the scene asks for."""
    if coupling.acceleration == "constant":
        return Constant(coupling.relaxation)
    if coupling.acceleration == "aitken":
        return Aitken(coupling.relaxation)
    return IqnIls(coupling.relaxation, coupling.reuse)
