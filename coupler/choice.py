"""Which scheme takes the next window: the scene's, or under `auto` the cheapest that the measured response allows.

Measured is the response |g| of the load to itself: a window is taken twice or more by plain iteration, and
|g| = |F₂ − F₁|/|F₁ − F₀|, with F₀ the load used, F₁ the load found, F₂ the load found when F₁ is used. Measured windows
are few and chosen by number. Nothing timed chooses anything, so that a run repeats to the byte.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from coupler.acceleration import Constant, make_acceleration
from coupler.schemes import (
    Coupled,
    Iteration,
    Outcome,
    parallel_explicit,
    parallel_implicit,
    serial_explicit,
    serial_implicit,
)
from coupler.vectors import Measure
from coupler.window import Plan
from shared.clock import Window
from shared.run.checkpoint import State, inside, under
from shared.schema.coupling import Coupling

log = logging.getLogger("shearwater")


class Taker(Protocol):
    """Takes a window; what it remembers from window to window can be kept and given back, as named arrays."""

    def __call__(self, c: Coupled, window: Window) -> Outcome: ...

    def heed(self, window: Window, warning: str) -> bool: ...

    def state(self) -> State: ...

    def restore(self, state: State) -> None: ...


_LARGEST_RESPONSE = 0.4
"""Measured |g| past which lagged exchange is left. On an absorbing column it bears 1, 0.58 and 0.35 by order of the
prediction; flow and noise alone read up to 0.13 where water strikes a plate (dam_break_plate)."""
_MEASURE_EVERY = 512  # windows; before, at the powers of two
_QUIET = 1e-3  # change of the load over the load: below it there is no response to be measured
_SWINGS = 6  # windows in a row in which the lagged load overshoots, each by more than the one before
_SWINGING = 0.02  # change of the load over the load that counts as an overshoot
_OPPOSED = -0.5  # cosine between the changes of two windows below which one undoes the other

_ASTRAY = 0.5  # change of the load over the load at which the load used says nothing of the load found
_PATIENCE = 32
"""Windows in a row whose loads go astray before lagged exchange is left: points of the interface ripple against each
other. Measured: 5 to 8 where water strikes a plate, 40 and more where it ripples and goes on to blow up."""


def make_taker(plan: Plan, coupling: Coupling) -> Taker:
    """What takes windows under `plan`."""
    if coupling.scheme == "auto":
        return Auto(plan, coupling)
    measure = Measure.of(coupling)
    if coupling.scheme.endswith("explicit"):
        return Fixed(serial_explicit if coupling.scheme.startswith("serial") else parallel_explicit, measure)
    how = Iteration(make_acceleration(coupling), measure, coupling.max_iterations, coupling.on_cap == "accept")
    return Fixed(serial_implicit if coupling.scheme.startswith("serial") else parallel_implicit, how)


class Fixed:
    """The scene's own scheme, every window."""

    def __init__(self, scheme: Callable[..., Outcome], how: Measure | Iteration):
        self._scheme, self._how = scheme, how

    def __call__(self, c: Coupled, window: Window) -> Outcome:
        """Take one window."""
        return self._scheme(c, window, self._how)

    def heed(self, window: Window, warning: str) -> bool:
        """What the ledger says of `window`: the scheme stays, and the ledger stops the run at its limit."""
        return False

    def state(self) -> State:
        """What the acceleration remembers."""
        return self._how.acceleration.state() if isinstance(self._how, Iteration) else {}

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        if isinstance(self._how, Iteration):
            self._how.acceleration.restore(state)


class Plain(Constant):
    """The load found is the next load; `size`: of the last difference."""

    def __init__(self):
        super().__init__(1.0)
        self.size = 0.0

    def next(self, x: np.ndarray, found: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """The next load."""
        self.size = float(np.linalg.norm((found - x)[weight > 0.0]))
        return super().next(x, found, weight)


class Auto:
    """Serial exchange: explicit, then implicit, never back. `plan.reasons` grows."""

    def __init__(self, plan: Plan, coupling: Coupling):
        self._plan = plan
        self._measure = Measure.of(coupling)
        self._explicit, self._left = plan.scheme == "serial-explicit", False
        # A splash that no iteration resolves must not end the run: such windows are counted, and the ledger watches.
        self._implicit = Iteration(make_acceleration(coupling), self._measure, coupling.max_iterations, True)
        self._plain = Plain()
        self._twice = Iteration(self._plain, Measure(0.0, 0.0, coupling.loads), 2, True)
        self._last: np.ndarray | None = None
        self._swings = 0
        self._astray = 0

    def __call__(self, c: Coupled, window: Window) -> Outcome:
        """Take one window."""
        if not self._explicit:
            return serial_implicit(c, window, self._implicit)
        if is_measured(window.index):
            outcome = serial_implicit(c, window, self._twice)
            left = np.linalg.norm(self._measure.leading(outcome.mapped) - self._measure.leading(outcome.used))
            response = left / (self._plain.size or np.inf)
            if len(outcome.changes) > 1 and outcome.changes[0] > _QUIET and response > _LARGEST_RESPONSE:
                self._step_up(window, f"measured response of the load to itself {response:.2g}")
            return replace(outcome, converged=True)  # taken twice to measure, not to agree
        outcome = serial_explicit(c, window, self._measure)
        self._watch(window, outcome)
        return outcome

    def heed(self, window: Window, warning: str) -> bool:
        """Leave lagged exchange when the ledger warns of it after `window`; whether it was left in this window."""
        if warning and self._explicit:
            self._step_up(window, warning)
        left, self._left = self._left, False
        return left

    def state(self) -> State:
        """Where it stands between the schemes, and what it watches."""
        state = {"explicit": np.array(self._explicit), "swings": np.array(self._swings)}
        state["astray"] = np.array(self._astray)
        last = {} if self._last is None else {"last": self._last}
        return state | last | under("acceleration", self._implicit.acceleration.state())

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        self._explicit, self._swings = bool(state["explicit"]), int(state["swings"])
        self._astray = int(state["astray"])
        self._last = state.get("last")
        self._implicit.acceleration.restore(inside("acceleration", state))

    def _watch(self, window: Window, outcome: Outcome) -> None:
        """Lagged loads that overshoot to and fro, ever further, are about to blow up; so are those that stay astray."""
        self._astray = self._astray + 1 if outcome.changes[0] > _ASTRAY else 0
        if self._astray == _PATIENCE:
            self._step_up(
                window, f"{_PATIENCE} windows in a row the lagged load was off by more than {_ASTRAY:g} of it"
            )
            return
        change = (outcome.mapped.force - outcome.used.force).ravel()
        before, self._last = self._last, change
        if before is None or outcome.changes[0] < _SWINGING:
            self._swings = 0
            return
        size, last = np.linalg.norm(change), np.linalg.norm(before)
        opposed = change @ before < _OPPOSED * size * last
        self._swings = self._swings + 1 if opposed and size > last else 0
        if self._swings == _SWINGS:
            self._step_up(window, f"the lagged load overshot {_SWINGS} windows in a row, each time by more")

    def _step_up(self, window: Window, why: str) -> None:
        self._explicit, self._left = False, True
        reason = f"window {window.index}, t = {window.t0:.4g} s: serial-explicit to serial-implicit: {why}"
        log.info("auto: %s", reason)
        self._plan.reasons.append(reason)


def is_measured(index: int) -> bool:
    """Whether window `index` measures the response: 1, 2, 4, 8, …, then every 512th."""
    return index % _MEASURE_EVERY == 0 if index >= _MEASURE_EVERY else index > 0 and index & (index - 1) == 0
