"""The coupling that a run would choose, scheme and window, from the scene alone."""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.numbers import Numbers
from coupler.preflight.swing import carries_sound
from coupler.window import Plan, make_plan, mass_ratio
from shared.contract import Description
from shared.fluid_step import COURANT
from shared.schema import Scene
from shared.sides import probe_rows

WINDOWS_PER_PERIOD = 20.0
_NOWHERE = np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=np.int64)


def expected_plan(scene: Scene, n: Numbers) -> Plan | None:
    """Scheme and window by the rule that the run itself uses, on expected numbers; None for one side alone."""
    if n.joint is None:
        return None
    w, p = n.water, n.plate
    fluid = {"density": w.density, "support": w.support, "h": w.h}
    if carries_sound(scene):
        fluid["sound_speed"] = w.sound_speed
    solid = {"density": p.density, "thickness": p.thinnest, "wave_speed": p.wave_speed}
    sides = (
        Description("fluid", "fluid", w.model, min(w.step, scene.end_time), w.dx, *_NOWHERE, fluid),
        Description("solid", "structure", p.model, p.step, scene.solid.dx, *_NOWHERE, solid),
    )
    return make_plan(scene.coupling, *sides, mass_ratio(scene, sides[1]), longest_window(scene, n))


def longest_window(scene: Scene, n: Numbers) -> float:
    """The longest automatic window [s]: a fluid without steps of its own takes windows that resolve the plate's swing
    and the rows of probes."""
    if n.joint is None or n.water.model in COURANT:
        return math.inf
    swing = math.inf if n.plate.frequency is None else 1.0 / (WINDOWS_PER_PERIOD * n.plate.frequency)
    return min(swing, scene.end_time / probe_rows(scene))


def expected_window(scene: Scene, n: Numbers) -> float | None:
    """The window [s] of that plan."""
    plan = expected_plan(scene, n)
    return None if plan is None else min(plan.window, scene.end_time)
