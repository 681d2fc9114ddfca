"""What the swing of a structure leaves in a mean, and what its phase makes of a value at the end, relative.

Over a time T, a swing from rest about the answer (measures/swing.py) leaves in a mean up to 2/(ωT) of its amplitude,
3/(ωT) of a strain energy, where damped ω/ω_d times as much, and an echo what it adds. What swings
about nothing has no mean.

A value at the end feels the phase φ that a wrong frequency has gathered: of a swing 1 − A cos θ about the answer
A φ |sin θ|/(1 − A cos θ), A what damping has left of it; θ is known to `KNOWN` of itself and φ. Its fast modes are a
share of the first, and lose their phase sooner: 1.5 % under a pressure, 3 % under a force at the tip, 9 % of what
starts at a speed (Γ₂ω₁²/Γ₁ω₂², ω₁²/ω₂², Γ₂ω₁/Γ₁ω₂ of a thin cantilever), and make all of a reaction. Nearer to nothing
than that, or past 1 rad of φ, it may be anything.
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.bounds.solid import UNKNOWN, of_displacement, periods, stepped
from coupler.preflight.bounds.sudden import at_speed, fast_share, started
from coupler.preflight.finding import STEADY
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import goals_quantity, of_a_body
from coupler.preflight.measures.swing import swing
from shared.schema.probes import REACTIONS, STRESSES
from shared.schema.scene import Scene

FIRST_MODE = 1.05  # its swing over the deflection, and a frequency over the true one: up to 1.03 each
QUADRATIC = {"strain-energy": 1.5}
SQUARES = {"strain-energy": 2.0}
LOST = 1.0  # rad
NEARLY = 0.1  # of ω², where damping is nearly critical
KNOWN = 0.02  # of a frequency
SECOND = 6.27  # frequency of a cantilever's second mode over that of its first
SWING, PHASE = "start-up swing in the mean", "phase of the swing at the end"
_DISPLACEMENTS = ("displacement-x", "displacement-y")


def swing_in_a_mean(scene: Scene, n: Numbers) -> float:
    """What a swing from rest about the answer, or a creep to it, leaves in a mean."""
    first = swing(scene, n)
    if first is None or scene.goal.statistic not in STEADY:
        return 0.0
    if about_nothing(scene, n):
        return UNKNOWN
    start, end = scene.output.average_from, scene.end_time
    measured, echoed = end - start, first.echoed(start, end)
    left = first.left(start) * started(scene, n.plate, first.omega, start)
    if first.damping >= 2.0 * first.omega:  # a creep counts as far as it dies
        return left / max(first.creep * measured, 1.0) + echoed
    ends = 1.0 + first.left(measured)  # of the time: both count until damping takes the later one away
    damped = math.sqrt(max(1.0 - (first.creep / first.omega) ** 2, NEARLY))  # its frequency over the undamped
    much = FIRST_MODE * QUADRATIC.get(goals_quantity(scene), 1.0) / damped
    return left * min(much * ends / (first.omega * measured), 1.0) + echoed


def about_nothing(scene: Scene, n: Numbers) -> bool:
    """Whether the goal's body swings by its start alone, and the goal is linear in its way, or an energy that all its
    modes share."""
    quantity = goals_quantity(scene)
    shared_out = quantity == "strain-energy" and fast_share(scene, n.plate) == 1.0
    linear = quantity in (*_DISPLACEMENTS, *REACTIONS, *STRESSES)
    return (linear or shared_out) and scene.fluid is None and n.plate.deflection == 0.0 and at_speed(scene, n.plate)


def swing_at_the_end(scene: Scene, n: Numbers, error: float) -> float:
    """What a value at the end is off by the phase of a swing that damping has left, where a stiffness is by `error`."""
    plate, what = n.plate, scene.goal.statistic
    late = what == "final" or (what == "change" and of_displacement(scene))
    if plate is None or not late or not of_a_body(scene):
        return 0.0
    seen = periods(scene, n)
    if seen is None:
        return 0.0
    first = swing(scene, n)
    left = first.left(scene.end_time) * started(scene, plate, first.omega, scene.end_time)
    angle = 2.0 * math.pi * seen
    phase = angle * (0.5 * error + stepped(scene, plate))
    if phase > LOST:
        return UNKNOWN if left > 0.5 else _worst(scene, n, left, 0.0, math.pi, LOST)
    return _worst(scene, n, left, angle, angle * KNOWN + phase, phase)


def _worst(scene: Scene, n: Numbers, left: float, angle: float, around: float, phase: float) -> float:
    """The most that a `phase` makes of a value within `around` an `angle`, all in rad."""
    about = 0.0 if n.plate.deflection == 0.0 else 1.0
    theta = angle + np.linspace(-around, around, 41)
    turned = np.sin(theta) if about == 0.0 and at_speed(scene, n.plate) else np.cos(theta)
    left = left if about else 1.0  # what swings about nothing is as wrong, whatever is left of it
    share = fast_share(scene, n.plate)
    share *= 1.0 if share == 1.0 else min(SECOND * phase, 1.0)
    slope = 1.0 if n.plate.along else np.sqrt(1.0 - turned**2)  # a bar goes as a saw's tooth
    off = left * (phase * slope + share + 0.5 * phase**2)
    value = np.abs(about - left * turned)
    if (value <= off).any():
        return UNKNOWN
    return SQUARES.get(goals_quantity(scene), 1.0) * float((off / (value - off)).max())
