"""Checks between the tables of a scene: names that are meant to meet, and what a run needs. One rule, one
function.

Every check yields sentences that start with the path. It passes over what is None or has no shape: those
mistakes in the vocabulary are reported elsewhere.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from shared.geometry.regions import area, contains, distance_to, faces, outline
from shared.run.curves import read_curve
from shared.scene.fields import suggest
from shared.scene.geometry import GEOMETRY_CHECKS, has_shape
from shared.scene.models import MODEL_CHECKS
from shared.scene.water import WATER_CHECKS
from shared.schema.probes import FORCES, QUANTITIES
from shared.schema.scene import Scene

_ON_BODY = 1e-6  # distance over the body's size within which a point counts as on the body
_MATERIAL = [name for name, what in QUANTITIES.items() if what.point and what.of == ("solid",)]


def check_scene(scene: Scene, readable: bool = True) -> list[str]:
    """All mistakes found between the tables of `scene`, and where there are none and all of it was `readable`, those
    that only a whole scene can show."""
    checks = (_sides, _unique_names, _times, _clamps_and_loads, _probes, _references, *GEOMETRY_CHECKS, *MODEL_CHECKS)
    mistakes = [mistake for check in checks for mistake in check(scene)]
    if mistakes or not readable:
        return mistakes
    return [mistake for check in WATER_CHECKS for mistake in check(scene)]


def _sides(scene: Scene) -> Iterator[str]:
    if scene.fluid is None and scene.solid is None:
        yield "fluid, solid: both missing; a scene needs one side at least"


def _named(scene: Scene) -> Iterator[tuple[str, str, str]]:
    """Path, name and kind of everything that a probe can look at."""
    sides = ((scene.fluid, "fluid"), (scene.solid, "solid"))
    for side, kind in sides:
        for i, body in enumerate(side.bodies or [] if side else []):
            if body.name:
                yield f"{kind}.bodies[{i}]", body.name, kind
    for i, wall in enumerate(scene.walls):
        if wall.name:
            yield f"walls[{i}]", wall.name, "wall"


def _unique_names(scene: Scene) -> Iterator[str]:
    bodies = [(path, name) for path, name, _ in _named(scene)]
    probes = [(f"probes[{i}]", probe.name) for i, probe in enumerate(scene.probes) if probe.name]
    for group in (bodies, probes):
        count = Counter(name for _, name in group)
        seen: dict[str, str] = {}
        for path, name in group:
            first = seen.setdefault(name, path)
            if count[name] > 1 and first != path:
                yield f'{path}.name = "{name}": already the name of {first}'


def _times(scene: Scene) -> Iterator[str]:
    if scene.end_time is None:
        return
    window = scene.coupling.window if scene.coupling else None
    if isinstance(window, float) and window > scene.end_time:
        yield f"coupling.window = {window:g}: longer than end_time = {scene.end_time:g} [s]"
    output = scene.output
    if output and output.average_from is not None and output.average_from >= scene.end_time:
        yield (
            f"output.average_from = {output.average_from:g}: not before end_time = {scene.end_time:g} [s], "
            "so nothing would be averaged"
        )


def _clamps_and_loads(scene: Scene) -> Iterator[str]:
    if scene.solid is None:
        return
    bodies = {body.name: body for body in scene.solid.bodies or []}
    for key in ("clamps", "loads"):
        for i, entry in enumerate(getattr(scene.solid, key) or []):
            path = f"solid.{key}[{i}]"
            if entry.body is None:
                continue
            if entry.body not in bodies:
                yield f'{path}.body = "{entry.body}": no such body of the solid{suggest(entry.body, bodies)}'
            elif entry.face is not None and has_shape(bodies[entry.body]) and area(bodies[entry.body]) > 0.0:
                named = faces(bodies[entry.body])
                if entry.face not in named:
                    wrong = f"{path}.face = \"{entry.face}\": body '{entry.body}' has no such face"
                    yield wrong + suggest(entry.face, named)
    yield from _held_twice(scene)


def _held_twice(scene: Scene) -> Iterator[str]:
    """Clamps on a part of a body's outline that another holds: its fixed points would stand there twice."""
    bodies = {body.name: body for body in scene.solid.bodies or [] if has_shape(body)}
    held: dict[tuple, int] = {}
    for i, clamp in enumerate(scene.solid.clamps or []):
        named = faces(bodies[clamp.body]) if clamp.body in bodies and area(bodies[clamp.body]) > 0.0 else {}
        parts = [(clamp.body, *part.flat) for part in named.get(clamp.face, ())]
        first = next((held[part] for part in parts if part in held), None)
        if first is not None:
            yield (
                f"solid.clamps[{i}].face = \"{clamp.face}\": this face of body '{clamp.body}' is held by "
                f"solid.clamps[{first}] already; leave one of them out"
            )
        held |= dict.fromkeys(parts, i)


def _probes(scene: Scene) -> Iterator[str]:
    kinds = {name: kind for _, name, kind in _named(scene)}
    for i, probe in enumerate(scene.probes):
        path, quantity = f"probes[{i}]", probe.quantity
        if quantity is None:
            continue
        _, wanted, needs_body, needs_point = QUANTITIES[quantity]
        what = " or ".join(wanted) + (" body" if wanted[-1:] != ("wall",) else "")
        if needs_body and probe.body is None:
            yield f"{path}.body: missing; {quantity} is of a {what}"
        elif probe.body is not None and not wanted:
            yield f'{path}.body = "{probe.body}": {quantity} is not of a body; leave it out'
        elif probe.body is not None and probe.body not in kinds:
            options = [name for name, kind in kinds.items() if kind in wanted]
            yield f'{path}.body = "{probe.body}": no such body{suggest(probe.body, options)}'
        elif probe.body is not None and kinds[probe.body] not in wanted:
            yield f'{path}.body = "{probe.body}": a {kinds[probe.body]}, but {quantity} is of a {what}'
        if needs_point and probe.point is None:
            yield f"{path}.point: missing; {quantity} is at a point [x, y]"
        if not needs_point and probe.point is not None:
            yield f"{path}.point = {list(probe.point)}: {quantity} is not at a point; leave it out"
        yield from _probe_sides(scene, path, quantity)
        yield from _probe_point(scene, path, probe)


def _probe_sides(scene: Scene, path: str, quantity: str) -> Iterator[str]:
    if scene.fluid is None and (quantity in FORCES or "solid" not in QUANTITIES[quantity].of):
        yield f'{path}.quantity = "{quantity}": the scene has no fluid'


def _probe_point(scene: Scene, path: str, probe) -> Iterator[str]:
    """A material point lies in its body, faces included."""
    if probe.quantity not in _MATERIAL or probe.point is None or scene.solid is None:
        return
    for body in scene.solid.bodies or []:
        if body.name == probe.body and has_shape(body):
            point = np.array([probe.point])
            edges = outline(body)
            if len(edges) == 0:
                continue
            away = distance_to(edges, point)[0]
            if away > _ON_BODY * np.ptp(edges.reshape(-1, 2), axis=0).max() and not contains(body, point)[0]:
                yield f"{path}.point = {list(probe.point)}: {away:.3g} m outside body '{body.name}'"


def _references(scene: Scene) -> Iterator[str]:
    names = [probe.name for probe in scene.probes if probe.name]
    for i, reference in enumerate(scene.references):
        if reference.probe is not None and reference.probe not in names:
            wrong = f'references[{i}].probe = "{reference.probe}": no such probe'
            yield wrong + suggest(reference.probe, names)
        if reference.curve is not None:
            try:
                read_curve(reference.curve)
            except (OSError, ValueError) as error:
                yield f'references[{i}].curve = "{reference.curve}": {error}'
    if scene.goal is not None and scene.goal.probe is not None and scene.goal.probe not in names:
        yield f'goal.probe = "{scene.goal.probe}": no such probe{suggest(scene.goal.probe, names)}'
