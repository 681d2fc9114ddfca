"""What a load that is switched on at once adds to the error of a peak, relative.

A body that is pushed along its length swings in fronts, whose kinks are worn round over a length σ: 0.4 σ/L of the
peak of a displacement, half of it of its time. σ = √(α h L/4) by the particles' viscosity over the way to the far end
and back, 2.5 spacings or steps c Δt at the least (a bar 40 and 80 particles long). Behind a front that jumps, stresses
and reactions overshoot by as much as 26 %. What bends shows its fast modes in its reactions alone: 3 % of a peak, 1.5 %
of a beam's, and 1 % of stresses (cantilevers and clamped plates under a sudden pressure).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from coupler.preflight.measures.plate import Plate, goals_quantity
from shared.scene.sides import probe_rows
from shared.schema.probes import REACTIONS, STRESSES
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS

PEAKS = ("min", "max")
ROUNDED, LEAST_SMEARED = 0.4, 2.5
OF_REACTION, OF_BEAMS_REACTION, OF_STRESS = 0.03, 0.015, 0.01


def jumps(scene: Scene, plate: Plate) -> bool:
    """Whether the goal is a peak behind a front that jumps."""
    return plate.along and _peak_at_once(scene, plate, PEAKS) and goals_quantity(scene) in (*REACTIONS, *STRESSES)


def sudden_error(scene: Scene, plate: Plate) -> float:
    """Of a peak; 0 of other statistics, and of loads that grow."""
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
    return min(ROUNDED * smeared / plate.length, 1.0) * (1.0 if scene.goal.statistic in PEAKS else 0.5)


def _peak_at_once(scene: Scene, plate: Plate, peaks: Sequence[str]) -> bool:
    if plate.model in RIGID_MODELS or scene.goal.statistic not in peaks:
        return False
    loads = [load for load in scene.solid.loads if load.body == plate.name]
    at_once = any(load.table.factors[0] != 0.0 if load.table else load.ramp == 0.0 for load in loads)
    return at_once or (scene.solid.gravity and any(scene.gravity))
