"""The coupling window's length, from the stability of the lagged exchange."""

from __future__ import annotations

from shared.contract import Description
from shared.schema import Coupling

_LARGEST_ALPHA = 0.08
"""Largest α = ρ_f c Δt/(ρ_s t) of an automatic window. On an absorbing column the serial protocol holds up to 2, 1.155
and 0.709 for predictor order 0, 1, 2; a column that reflects sound is pumped by the lag long before: measured on 60 mm
of water on a plate a fifth of its weight, α 0.14 grows and 0.07 decays, whatever the order."""
_MOST_STEPS = 4
"""Fluid steps in an automatic window: enough to make the exchange cheap beside the steps, few enough to be accurate."""
_SPEED_UP = 1.0 / 7.0
"""Speed over c0 that the flow is expected to reach (c0 is ten times the largest estimated, splashes are faster): the
window holds whole steps at this speed, so that no window is cut into one step more."""


def alpha_rate(fluid: Description, structure: Description) -> float:
    """α per second of window: ρ_f c/(ρ_s t) [1/s], t the thickness of the thinnest body."""
    f, s = fluid.numbers, structure.numbers
    return f["density"] * f["sound_speed"] / (s["density"] * s["thickness"])


def window_length(coupling: Coupling, fluid: Description, structure: Description) -> float:
    """The window [s]: as the scene says, or `auto`: up to four fluid steps while α stays below 0.08."""
    if coupling.window != "auto":
        return coupling.window
    step = fluid.stable_step / (1.0 + _SPEED_UP)
    longest = _LARGEST_ALPHA / alpha_rate(fluid, structure)
    return step * min(int(longest / step), _MOST_STEPS) if longest > step else longest
