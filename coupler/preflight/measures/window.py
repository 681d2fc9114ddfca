"""The coupling that a run would choose, scheme and window, from the scene alone."""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.swing import carries_sound
from coupler.stability.theory import acoustic, echo_gain, growth
from coupler.window import Plan, make_plan, mass_ratio
from shared.contract import Description
from shared.fluid_step import COURANT
from shared.scene.sides import probe_rows
from shared.schema.scene import Scene

WINDOWS_PER_PERIOD = 20.0  # of the plate's swing, where the fluid has no steps of its own
GROWTH_WARN = 100.0
"""Times that lag makes a swing on a column grow until the end, past which no error is bound. A peak of the piston is
0.1 % off at 10, 0.6 % at 120, 22 % at 1e4 (order 0, serial)."""
_ROUND = 1e-9  # past 1, below which nothing grows
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


def window_alpha(n: Numbers, window: float) -> float:
    """α = ρ_f c0 Δt/(ρ_s t) of a `window` [s]: how far sound lets a lagged load run ahead; t of the thinnest body."""
    return n.water.density * n.water.sound_speed * window / (n.plate.density * n.plate.thinnest)


def lag_growth(scene: Scene, n: Numbers) -> float:
    """Logarithm of how many times as large lagged exchange makes the worst swing of a structure on columns until the
    run's end, from a pulse that grows each time that it comes back. 0 for other fluids, and where windows are iterated;
    infinite where it grows without an echo."""
    plan = expected_plan(scene, n)
    if plan is None or n.water.model != "column" or not carries_sound(scene) or n.plate.model == "rigid":
        return 0.0
    if plan.scheme.endswith("implicit"):
        return 0.0
    order, sound, column = scene.coupling.predictor, n.water.sound_speed, scene.fluid.column
    alpha = window_alpha(n, plan.window)
    if growth(acoustic(alpha, order, scheme=plan.scheme)) > 1.0 + _ROUND:
        return math.inf
    gain = column.reflection * echo_gain(alpha, order, plan.scheme)
    return 0.5 * scene.end_time * sound / n.joint.depth * math.log(gain) if gain > 1.0 else 0.0
