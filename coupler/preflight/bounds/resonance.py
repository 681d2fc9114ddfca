"""What the time tables and ramps of loads, and clamps that move, make of an error of a stiffness, in a peak.

The plate's first mode as an oscillator, ẍ + η ẋ + ω² x = ω² f(t), f the sum of its loads by their sizes, and ρ t ω² of
the way y(t) of its clamps across it: near resonance a frequency that is wrong by half the error of the stiffness, or by
less, makes another peak. A cantilever driven at nine tenths of its frequency, damped by a tenth of the critical: 1.9
times the error of its deflection at rest; shaken so at its clamp with a fifteenth: 2 times, undamped for 13 periods 3.
A ramp of one and a half periods leaves a swing of a thirtieth, which 1.4 % of a frequency makes a half larger.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import cont2discrete, lfilter

from coupler.preflight.bounds.sudden import PEAKS
from coupler.preflight.measures.held import normal_of
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import goals_quantity, plates_body
from coupler.preflight.measures.swing import swing
from shared.geometry.motion_table import MotionTable
from shared.geometry.regions import own_box, turn
from shared.schema.scene import Scene
from shared.schema.solid import Load

RESONANCE = "swing with a time table or a ramp"
_PER_PERIOD = 40.0  # steps of the oscillator
_MOST = 1e6  # steps; past them, hours of any model
_WRONG = np.array([1.0, 0.5, 0.25])  # of the error: a resonance may lie between


def resonance(scene: Scene, n: Numbers, error: float) -> float:
    """What the peak of a plate under loads, or on clamps, with tables feels of an `error` of its stiffness, besides."""
    first = swing(scene, n)
    if first is None or scene.goal.statistic not in PEAKS:
        return 0.0
    loads = [load for load in scene.solid.loads if load.body == n.plate.name]
    moved = [clamp.motion for clamp in scene.solid.clamps if clamp.body == n.plate.name and clamp.motion is not None]
    driven = bool(moved) or any(load.table is not None or load.ramp > 0.0 for load in loads)
    steps = scene.end_time * first.omega * _PER_PERIOD / (2.0 * np.pi) if driven else 0.0
    if not 1.0 < steps <= _MOST or not np.isfinite(error):
        return 0.0
    time = np.linspace(0.0, scene.end_time, int(steps) + 2)
    push = np.zeros(len(time))
    for load in loads:
        size = np.hypot(*load.traction) if load.traction else np.hypot(*load.acceleration) * _weight(n)
        push += size * _grown(load, time)
    for motion in moved:
        push += _weight(n) * first.omega**2 * _way(scene, n, MotionTable(motion), time) / len(moved)
    right, *wrong = (
        float(np.max(np.abs(_response(first.omega * share, first.damping, push, time[1]))))
        for share in (1.0, *(1.0 - 0.5 * error * _WRONG), *(1.0 + 0.5 * error * _WRONG))
    )
    squares = 2.0 if goals_quantity(scene) == "strain-energy" else 1.0
    return squares * max(abs(peak / right - 1.0) for peak in wrong) if right > 0.0 else 0.0


def _grown(load: Load, time: np.ndarray) -> np.ndarray:
    """Factor of a load at each time: by its table, or along the half cosine of its ramp."""
    if load.table is not None:
        return np.interp(time, load.table.times, load.table.factors)
    return 0.5 - 0.5 * np.cos(np.pi * np.minimum(time / load.ramp, 1.0)) if load.ramp > 0.0 else np.ones(len(time))


def _way(scene: Scene, n: Numbers, motion: MotionTable, time: np.ndarray) -> np.ndarray:
    """How far a clamp carries the middle of the plate across it [m]."""
    body = plates_body(scene, n.plate)
    across = normal_of(body)
    x, y = turn(np.mean(own_box(body), axis=0), body.rotate) - motion.about
    return motion.displacements(time) @ np.array([*across, across @ (-y, x)])


def _weight(n: Numbers) -> float:
    return n.plate.density * n.plate.thickness


def _response(omega: float, damping: float, push: np.ndarray, dt: float) -> np.ndarray:
    """The oscillator from rest, exact for a push that is linear between its times."""
    numerator, denominator, _ = cont2discrete(([omega**2], [1.0, damping, omega**2]), dt, method="foh")
    return lfilter(numerator[0], denominator, push)
