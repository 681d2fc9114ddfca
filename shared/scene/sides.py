"""What of a scene belongs to one side of a run."""

from __future__ import annotations

from shared.schema.probes import FORCES, Probe
from shared.schema.scene import Scene

PROBE_ROWS = 1000
"""Rows of probes.csv over a run where output.probe_interval is "auto"."""


def probe_rows(scene: Scene) -> int:
    """Number of probe rows after the first."""
    interval = scene.output.probe_interval
    return PROBE_ROWS if interval == "auto" else max(1, round(scene.end_time / interval))


def is_solids(scene: Scene, probe: Probe) -> bool:
    """Whether a probe is of what a body of the solid does, and not of the water's push on it."""
    bodies = scene.solid.bodies if scene.solid else []
    return probe.quantity not in FORCES and probe.body in {body.name for body in bodies}


def own_probes(scene: Scene, side: str) -> Scene:
    """The scene with the probes of one side, and what refers to them, alone."""
    kept = [p for p in scene.probes if is_solids(scene, p) == (side == "solid")]
    names = {p.name for p in kept}
    goal = scene.goal if scene.goal and scene.goal.probe in names else None
    references = [r for r in scene.references if r.probe in names]
    return scene.model_copy(update={"probes": kept, "references": references, "goal": goal})
