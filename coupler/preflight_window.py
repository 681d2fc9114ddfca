"""The coupling window that a run would choose, from the scene alone."""

from __future__ import annotations

import numpy as np

from coupler.preflight_numbers import Numbers
from coupler.window import window_length
from shared.contract import Description
from shared.schema import RIGID_MODELS, Scene

_NOWHERE = np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=np.int64)


def expected_window(scene: Scene, n: Numbers) -> float | None:
    """The window [s] by the rule that the run itself uses, on expected numbers; None for one side alone."""
    if n.joint is None:
        return None
    w, p = n.water, n.plate
    fluid = {"density": w.density, "sound_speed": w.sound_speed, "support": w.support, "h": w.h}
    solid = {"density": p.density, "thickness": p.thickness, "wave_speed": p.wave_speed}
    sides = (
        Description("fluid", "fluid", w.model, w.step, w.dx, *_NOWHERE, fluid),
        Description("solid", "structure", p.model, p.step, scene.solid.dx, *_NOWHERE, solid),
    )
    if p.model in RIGID_MODELS and p.density <= 0.0:
        return None
    return min(window_length(scene.coupling, *sides), scene.end_time)
