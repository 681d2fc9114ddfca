"""What a load that is switched on at once, or a start at a speed, adds to the error of a goal, relative.

A body that is pushed along its length, or flies along it into its clamp, swings in fronts, whose kinks are worn round
over a length σ: 0.4 σ/L of the peak of a displacement, twice that of an energy's, half of it of its time, or all where
it flies. σ = √(α h L/4) by the particles' viscosity over the way to the far end and back, 2.5 spacings or steps c Δt at
the least (a bar 40 and 80 particles long). Behind a front that jumps, stresses and reactions overshoot by as much as
26 %. What bends shows its fast modes in its reactions: 3 % of a peak, 1.5 % of a beam's, and 1 % of stresses
(cantilevers and clamped plates under a sudden pressure). A force at the tip that comes at once bears them so strongly
that peaks of reactions have no bound (13 % off at 6 across), nor stresses besides where a body starts at a speed (17 %,
of a beam 6 and 21 %). They move the time of a peak too: it feels 0.7 of what errs between two clamps, 1.5 of a start at
a speed.

A ramp over r that ends before the mean begins starts a swing of 1/((ω r/π)² − 1) of that of a load at once, at most.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from coupler.preflight.measures.held import FACES_OF_AXIS, lengthwise
from coupler.preflight.measures.plate import Plate, goals_quantity, plates_body
from shared.scene.sides import probe_rows
from shared.schema.probes import REACTIONS, STRESSES
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS, Load

PEAKS = ("min", "max")
ROUNDED, LEAST_SMEARED = 0.4, 2.5
OF_REACTION, OF_BEAMS_REACTION, OF_STRESS = 0.03, 0.015, 0.01
OF_ENERGY = 2.0
PEAKS_TIME, STARTED_PEAKS_TIME = {1: 0.5, 2: 0.7}, 1.5  # by clamped ends
QUICK = 0.05  # of a period: what grows by half of its load in less comes at once


def jumps(scene: Scene, plate: Plate) -> bool:
    """Whether the goal is a peak behind a front that jumps."""
    if not _peak_at_once(scene, plate, PEAKS):
        return False
    if plate.along or _flies(scene, plate):
        return goals_quantity(scene) in (*REACTIONS, *STRESSES)
    ends = FACES_OF_AXIS[lengthwise(plates_body(scene, plate))[0]]
    tip = any(load.face in ends and _at_once(load, plate) for load in _loads(scene, plate))
    return tip and goals_quantity(scene) in REACTIONS


def times_feel(scene: Scene, plate: Plate) -> float:
    """Share of an error of a stiffness that a time feels: half, but of a peak of what comes at once."""
    if plate.along or not _peak_at_once(scene, plate, ("t_min", "t_max")):
        return 0.5
    return STARTED_PEAKS_TIME if _flies(scene, plate) else PEAKS_TIME.get(plate.clamps, 0.5)


def started(scene: Scene, plate: Plate, omega: float, until: float) -> float:
    """Share of its swing at `omega` [rad/s] that what moves a plate has started `until` [s], of that of loads that
    come at once."""
    body, loads = plates_body(scene, plate), _loads(scene, plate)
    moved = any(body.velocity) or body.spin or body.velocity_mode is not None or any(body.prestrain)
    carried = any(clamp.motion is not None for clamp in scene.solid.clamps if clamp.body == plate.name)
    grow = all(load.table is None and 0.0 < load.ramp <= until for load in loads)
    weighs = scene.solid.gravity and any(scene.gravity)
    if scene.fluid is not None or moved or carried or weighs or not loads or not grow:
        return 1.0
    slow = (omega * min(load.ramp for load in loads) / math.pi) ** 2
    return 1.0 / max(slow - 1.0, 1.0)


def sudden_error(scene: Scene, plate: Plate) -> float:
    """Of a peak; 0 of other statistics, and of loads that grow."""
    what = scene.goal.statistic
    if not _peak_at_once(scene, plate, (*PEAKS, "t_min", "t_max") if plate.along else PEAKS):
        return 0.0
    if not plate.along:
        reaction = OF_BEAMS_REACTION if plate.model == "beam" else OF_REACTION
        return {**dict.fromkeys(REACTIONS, reaction), **dict.fromkeys(STRESSES, OF_STRESS)}.get(
            goals_quantity(scene), 0.0
        )
    if not plate.clamps:
        return 0.0
    solid, crossed = scene.solid, plate.length * plate.frequency * (4.0 if plate.clamps == 1 else 2.0)
    if plate.model == "beam":
        step = min(plate.step, scene.end_time / probe_rows(scene))
        smeared = LEAST_SMEARED * max(solid.dx, crossed * step)
    else:
        worn = math.sqrt(0.25 * solid.alpha * solid.h_over_dx * solid.dx * plate.length)
        smeared = max(worn, LEAST_SMEARED * solid.dx)
    much = min(ROUNDED * smeared / plate.length, 1.0)
    if what not in PEAKS:
        return much * (1.0 if _flies(scene, plate) else 0.5)
    return much * (OF_ENERGY if goals_quantity(scene) == "strain-energy" else 1.0)


def _loads(scene: Scene, plate: Plate) -> list[Load]:
    return [load for load in scene.solid.loads if load.body == plate.name]


def _flies(scene: Scene, plate: Plate) -> bool:
    """Whether a body that clamps hold starts at a speed."""
    body = plates_body(scene, plate)
    held = any(clamp.body == plate.name for clamp in scene.solid.clamps)
    return held and (any(body.velocity) or body.spin != 0.0)


def _at_once(load: Load, plate: Plate) -> bool:
    quick = QUICK / plate.frequency
    if load.table is None:
        return load.ramp < quick
    times, factors = np.array(load.table.times), np.array(load.table.factors)
    grown = np.abs(np.interp(times + quick, times, factors) - factors).max()
    return factors[0] != 0.0 or grown > 0.5 * np.abs(factors).max()


def _peak_at_once(scene: Scene, plate: Plate, peaks: Sequence[str]) -> bool:
    if plate.model in RIGID_MODELS or scene.goal.statistic not in peaks:
        return False
    at_once = any(_at_once(load, plate) for load in _loads(scene, plate)) or _flies(scene, plate)
    return at_once or (scene.solid.gravity and any(scene.gravity))
