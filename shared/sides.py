"""What of a scene belongs to one side of a run."""

from __future__ import annotations

from shared.schema import Scene

PROBE_ROWS = 1000
"""Rows of probes.csv over a run where output.probe_interval is "auto"."""


def probe_rows(scene: Scene) -> int:
    """Number of probe rows after the first."""
    interval = scene.output.probe_interval
    return PROBE_ROWS if interval == "auto" else max(1, round(scene.end_time / interval))


def own_probes(scene: Scene, side: str) -> Scene:
    """The scene with the probes of one side, and what refers to them, alone."""
    solid = {b.name for b in scene.solid.bodies} if scene.solid else set()

    def is_solid(p):
        return p.body in solid and p.quantity not in ("force-x", "force-y")

    kept = [p for p in scene.probes if is_solid(p) == (side == "solid")]
    names = {p.name for p in kept}
    goal = scene.goal if scene.goal and scene.goal.probe in names else None
    references = [r for r in scene.references if r.probe in names]
    return scene.model_copy(update={"probes": kept, "references": references, "goal": goal})
