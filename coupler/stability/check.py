"""What can be wrong with a map beyond its vocabulary, found before any of its runs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.rules.findings import findings
from coupler.stability.map import Method, StabilityMap
from coupler.stability.runs import cell_scene
from coupler.stability.theory import THEORIES
from shared.contract import BadInput
from shared.scene.fields import suggest
from shared.schema.scene import Scene

_SHOWN = 10  # mistakes


def check_map(stability: StabilityMap) -> None:
    """Look at the scenes at the ends of every search. Raises BadInput with every mistake, each once."""
    mistakes: dict[str, None] = {}
    rules: set[str] = set()
    ends = dict.fromkeys([*stability.y.range, *(end(stability.y.values) for end in (min, max) if stability.y.values)])
    for method, x, y in itertools.product(stability.methods, stability.x.values, ends):
        try:
            scene = cell_scene(stability, method, x, y)
        except BadInput as error:
            where = f"{stability.x.name} = {x:g}, {stability.y.name} = {y:g}"
            mistakes[f"methods {method.name!r}, {where}: {error}"] = None
            continue
        if y == stability.y.range[0]:
            mistakes |= dict.fromkeys(_of_scene(stability, method, x, scene))
        if stability.rule is not None and stability.rule not in rules:
            rules |= {finding.rule for finding in findings(scene, scene_numbers(scene))}
    if stability.rule is not None and stability.rule not in rules and rules:
        mistakes[f"rule = {stability.rule!r}: not one of pre-flight's here{suggest(stability.rule, rules)}"] = None
    if mistakes:
        shown = [f"  {mistake}" for mistake in mistakes][:_SHOWN]
        more = [f"  and {len(mistakes) - _SHOWN} more"] if len(mistakes) > _SHOWN else []
        raise BadInput(f"the map {stability.title!r} cannot be made\n" + "\n".join(shown + more))


def _of_scene(stability: StabilityMap, method: Method, x: float, scene: Scene) -> Iterator[str]:
    """Mistakes of a method at one x."""
    criterion = stability.criterion
    probes = [probe.name for probe in scene.probes]
    if criterion.probe is not None and criterion.probe not in probes:
        yield f"criterion.probe = {criterion.probe!r}: the scene has no such probe{suggest(criterion.probe, probes)}"
    if criterion.measure == "iterations" and (scene.fluid is None or scene.solid is None):
        there = "fluid" if scene.solid is None else "solid"
        yield f"criterion.measure = 'iterations': {stability.case} has a {there} alone, and nothing to iterate"
    name = stability.theory_of(method)
    try:
        name is None or THEORIES[name](scene, x)
    except AttributeError:
        yield f"theory = {name!r}: not one of {stability.case}, which lacks the model that it is of; leave it away"
