"""What a chart's errors are measured against: the study's truth, or its finest run; and what others found."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from coupler.chart.variants import Variant
from shared.contract import BadInput
from shared.run.probes import goal_interval, goal_references, goal_value, read_probes, reference_curve
from shared.run.statistics import relative_error, statistic
from shared.schema.probes import Reference
from shared.schema.scene import Scene


def charted_value(variant: Variant, result: dict[str, Any], run_dir: Path) -> float | None:
    """The goal's statistic of the goal's probe in a finished run. Raises BadInput where its probes cannot be read."""
    if result["status"] != "finished":
        return None
    scene = variant.scene
    path = run_dir / "probes.csv"
    time, histories = read_probes(path)
    if scene.goal.probe not in histories or len(time) == 0:
        raise BadInput(f"{path} holds no history of {scene.goal.probe}: remove its run, and run it again")
    return goal_value(scene, time, histories[scene.goal.probe])


def known_truth(scene: Scene) -> float | None:
    """The value of the reference that the study names; None where its finest run is to be the truth. Raises
    BadInput."""
    if scene.study.truth is None:
        return None
    known = {r.name: _known(r) for r in goal_references(scene)}
    if known.get(scene.study.truth) is None:
        there = ", ".join(repr(name) for name, value in known.items() if value is not None) or "none"
        raise BadInput(
            f"study.truth = {scene.study.truth!r}: no reference with a value for the {scene.goal.statistic} of "
            f"{scene.goal.probe} has this name; there is {there}"
        )
    return known[scene.study.truth]


def find_truth(scene: Scene, variants, values) -> tuple[str, float, Variant | None]:
    """Name and value of the truth, and the variant that it was taken from, if it is one; one of `values` is known."""
    known = known_truth(scene)
    if known is not None:
        return scene.study.truth, known, None
    finest = min((v.dx, k) for k, (v, value) in enumerate(zip(variants, values, strict=True)) if value is not None)[1]
    return f"finest run, {variants[finest].series} {variants[finest].label}", values[finest], variants[finest]


def spread(scene: Scene, truth: float, name: str) -> dict[str, float]:
    """Relative deviations from the truth of what others found over the same interval."""
    others = {r.name: _known(r) for r in goal_references(scene) if r.name != name and r.between == goal_interval(scene)}
    return {name: relative_error(value, truth) for name, value in others.items() if value is not None}


def _known(reference: Reference) -> float | None:
    """A reference's value; of a curve, its statistic over the interval that the reference names."""
    if reference.curve is None:
        return reference.value
    if reference.between is None:
        return None
    return statistic(reference.statistic, *reference_curve(reference), reference.between)
