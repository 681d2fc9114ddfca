"""Predicted cost of a run in core-seconds: steps × (time per step + time per particle), on a machine like the one the
table was measured on, times how much slower this one is, which a short calibration tells.

The table: one core of an AVX-512 machine shared with others, processor time of the runs of the charts in cases/results/
(0.5 k to 25 k fluid and 0.1 k to 6.7 k solid particles).
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np

from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.window import expected_plan, expected_window
from shared.scene.sides import probe_rows
from shared.schema.scene import Scene

STEP_S = {"ctvf": 4e-5, "wcsph": 4e-5, "still": 1e-4, "column": 1e-4}
"""Per fluid step, whatever its size."""
PARTICLE_S = {"ctvf": 2.8e-7, "wcsph": 2.2e-7, "still": 0.0, "column": 0.0}
"""Per fluid particle and step, Wendland C2 at h = 1.3 dx."""
PAIR_SHARE = 0.6  # of that goes to pairs, in proportion to a particle's neighbours
SOLID_STEP_S = {"total-lagrangian": 1.6e-5, "ctvf": 5e-5, "beam": 3e-5, "rigid": 2e-5, "spring": 5e-5}
SOLID_PARTICLE_S = {"total-lagrangian": 8e-8, "ctvf": 2.4e-7, "beam": 2.5e-7, "rigid": 0.0, "spring": 0.0}
"""Per step of the structure, whatever its size; per particle, or node of a beam, and step."""
LINEAR_SHARE = 0.8  # of the quadratic gradient's cost per particle, model ctvf of the solid
WINDOW_S = 2.1e-3
"""Per coupling window and iteration: messages, bookkeeping (dam_break_plate, 0.5 ms on either side, 1.1 in the
coupler)."""
ALONE_SHARE = 0.15  # of it, that a row of probes costs a side alone
BEAM_WINDOW_S = 2e-4
"""Besides, a window of the beam: it starts every window from its sections anew (dam_break_plate)."""
ITERATIONS = {"serial-implicit": 2.5, "parallel-implicit": 4.0}
"""Of a window. Measured with iqn-ils on windows of a fluid step: serial 1.3 to 2.0 (two_reservoirs,
cantilever_in_water, light_gate, a drop on a gel), 2.6 to 3.0 (a flap in a splash, a reed in waves, a rubber gate);
parallel 4.0 (two gates in oil)."""
START_S = 1.5
"""Per process, before its first step: loading libraries and compiled code."""
_NEIGHBOURS_RADIUS = 2.6  # support over dx of the table's fluid
_DEVELOPED = 1.0 / 10.0  # mean speed of a flow over c0 beyond that at t = 0
_CALIBRATION_S = 0.15
_REFERENCE_LOOPS_PER_S = 2.36e5  # of the calibration on the table's machine
_LOOP_POINTS = 1000  # stays in the first cache


@dataclass(frozen=True)
class Cost:
    """Predicted: `core_s` of processor time of both sides and the coupler, of which `start_s` is spent before the first
    step; steps with those of all iterations."""

    core_s: float
    start_s: float
    fluid_steps: float
    solid_steps: float
    windows: float


def predicted_cost(scene: Scene, n: Numbers, slower: float = 1.0) -> Cost:
    """Cost of the scene on a machine `slower` times slower than the table's."""
    window = expected_window(scene, n)
    rows = max(probe_rows(scene), scene.output.frames)
    windows = rows if window is None else max(1.0, scene.end_time / window)
    length = scene.end_time / windows
    fluid_steps = solid_steps = work = 0.0
    if n.water is not None:
        fluid_steps = windows * math.ceil(length / _developed_step(n) * (1.0 - 1e-9))
        work += fluid_steps * (STEP_S[n.water.model] + PARTICLE_S[n.water.model] * _weighted(n))
    if n.plate is not None:
        solid_steps = windows * math.ceil(length / n.plate.step * (1.0 - 1e-9))
        model = n.plate.model
        each = SOLID_PARTICLE_S[model]
        if model == "ctvf" and scene.solid.gradient != "quadratic":
            each *= LINEAR_SHARE
        work += solid_steps * (SOLID_STEP_S[model] + each * n.plate.particles)
    sides = (n.water is not None) + (n.plate is not None)
    work += windows * WINDOW_S * (1.0 if sides == 2 else ALONE_SHARE)
    if sides == 2 and n.plate.model == "beam":
        work += windows * BEAM_WINDOW_S
    often = ITERATIONS.get(expected_plan(scene, n).scheme, 1.0) if sides == 2 else 1.0
    start = slower * sides * START_S
    return Cost(slower * often * work + start, start, often * fluid_steps, often * solid_steps, windows)


def _developed_step(n: Numbers) -> float:
    return n.water.step if n.water.rests else n.water.step / (1.0 + _DEVELOPED)


def _weighted(n: Numbers) -> float:
    """Particles, weighted by what their number of neighbours costs."""
    pairs = (n.water.support / n.water.dx / _NEIGHBOURS_RADIUS) ** 2
    return n.water.particles * (1.0 - PAIR_SHARE + PAIR_SHARE * pairs)


def calibrate() -> float:
    """How many times slower than the table's machine this one is now, by a short loop of floating-point work."""
    x = np.linspace(0.1, 1.0, _LOOP_POINTS)
    loops, begun = 0, time.process_time()
    while time.process_time() - begun < _CALIBRATION_S:
        for _ in range(100):
            y = x * x + 1.0
            np.multiply(y, y, out=y)
            np.sqrt(y, out=y)
            np.divide(x, y, out=y)
        loops += 100
    return _REFERENCE_LOOPS_PER_S / (loops / (time.process_time() - begun))
