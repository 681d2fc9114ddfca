"""The coupling window's length, from the stability of the lagged exchange."""

from __future__ import annotations

from shared.contract import Description
from shared.schema import Coupling

_LARGEST_ALPHA = 0.3
"""α = ρ_f c Δt/(ρ_s t) at which a window is called safe for every predictor order: the serial protocol's limits on an
absorbing column are 2, 1.155 and 0.709; reflections lower them."""
_MOST_STEPS = 4
"""Fluid steps in an automatic window: enough to make the exchange cheap beside the steps, few enough to be accurate."""
_MARGIN = 0.98  # the fluid's stable step shrinks a little as the flow speeds up


def alpha_rate(fluid: Description, structure: Description) -> float:
    """α per second of window: ρ_f c/(ρ_s t) [1/s], t the thickness of the thinnest body."""
    f, s = fluid.numbers, structure.numbers
    return f["density"] * f["sound_speed"] / (s["density"] * s["thickness"])


def window_length(coupling: Coupling, fluid: Description, structure: Description) -> float:
    """The window [s]: as the scene says, or `auto`: up to four fluid steps, as many as keep α below 0.3, at least one."""
    if coupling.window != "auto":
        return coupling.window
    step = _MARGIN * fluid.stable_step
    steps = int(_LARGEST_ALPHA / (alpha_rate(fluid, structure) * step))
    return step * min(max(steps, 1), _MOST_STEPS)
