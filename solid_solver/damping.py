"""The damping −η v of solid.damping in a time step."""

from __future__ import annotations

import math


def damped_kick(damping: float, tau: float) -> tuple[float, float]:
    """Factors (e, τφ) of v ← e v + τφ a: the exact effect of a constant a and of −η v over `tau` [s]."""
    if damping == 0.0:
        return 1.0, tau
    return math.exp(-damping * tau), -math.expm1(-damping * tau) / damping
