"""What tests ask of pre-flight about a scene."""

from __future__ import annotations

from coupler.preflight.bounds.error import error_bound
from coupler.preflight.finding import Finding
from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.rules.findings import findings
from shared.schema.scene import Scene


def bound_of(scene: Scene) -> float | None:
    """Bound of the relative error of a scene's goal."""
    return error_bound(scene, scene_numbers(scene))


def said_of(scene: Scene) -> dict[str, Finding]:
    """What the rules say of a scene, by rule."""
    return {found.rule: found for found in findings(scene, scene_numbers(scene))}


def verdicts_of(scene: Scene) -> dict[str, str]:
    """The rules' verdicts on a scene, by rule."""
    return {rule: found.verdict for rule, found in said_of(scene).items()}
