"""Where the faces of a fluid body lie on those of solid bodies, and whether columns of water can stand there; where
there is water beside the solids' faces, and whether there is any for water at rest to load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from shared.geometry.regions import contains, outline
from shared.geometry.segments import directions, lengths, right_of
from shared.schema.geometry import Body
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS

_TOUCHING = 1e-6  # of dx: faces this near to each other touch
_PARALLEL = 1e-9  # sine of the angle between faces that touch
DRY = -1
_BESIDE = 0.25  # of dx: a face is wet where there is water this far off it
_APART = 2.0  # of the solid's spacing: pressures farther apart push single particles in, a gel by 20 % at 4


@dataclass(frozen=True)
class Stretch:
    """A part of a fluid body's face that lies on a solid body: number `side` of the outline's segment, its `start` (2,)
    [m] and direction `along` (2,), the part's ends `low` and `high` [m] from there, and the `solid` body's number."""

    side: int
    start: np.ndarray
    along: np.ndarray
    low: float
    high: float
    solid: int


def load_spacing(scene: Scene) -> float:
    """Distance [m] between the points at which water without particles presses on faces."""
    solid, dx = scene.solid, scene.fluid.dx
    return min(dx, _APART * solid.dx) if solid is not None and solid.model in PARTICLE_MODELS else dx


def wetted_stretches(scene: Scene, body: Body) -> list[Stretch]:
    """All stretches of the fluid body `body`."""
    found = []
    for side, face in enumerate(outline(body)):
        start, along = face[0], directions(face)
        for k, solid in enumerate(scene.solid.bodies if scene.solid else []):
            pieces = _common(face, outline(solid), scene.fluid.dx)
            found += [Stretch(side, start, along, low, high, k) for low, high in pieces]
    return found


def why_no_columns(scene: Scene, body: Body) -> str:
    """Why model column cannot have the fluid body `body`, and the way out; empty if it can."""
    if body.rectangle is None:
        return f"'{body.name}' is no rectangle, which model column needs; use model wcsph or ctvf"
    sides = {stretch.side for stretch in wetted_stretches(scene, body)}
    if sides and not ({0, 2} <= sides or {1, 3} <= sides):
        return ""
    where = "touches solid bodies at two opposite faces" if sides else "touches no face of a solid body"
    return (
        f"'{body.name}' {where}: model column is water between one wetted face and a far end; let the body share one "
        "face with the structure, or use model wcsph or ctvf"
    )


def wet_links(scene: Scene) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Per segment of a solid body's outline that has water beside it: the solid's number, the nodes (n + 1, 2) [m] that
    cut the segment into links about `load_spacing` long, and for each link the number of the fluid body beside it, or
    `DRY`."""
    dx = scene.fluid.dx
    for index, solid in enumerate(scene.solid.bodies if scene.solid else []):
        for segment in outline(solid):
            start, end = segment
            count = max(1, round(lengths(segment) / load_spacing(scene)))
            nodes = start + (end - start) * np.linspace(0.0, 1.0, count + 1)[:, None]
            beside = 0.5 * (nodes[:-1] + nodes[1:]) + _BESIDE * dx * right_of(directions(segment))
            water = np.full(count, DRY)
            for k, body in enumerate(scene.fluid.bodies):
                water[contains(body, beside)] = k
            if np.any(water != DRY):
                yield index, nodes, water


def _common(face: np.ndarray, segments: np.ndarray, dx: float) -> list[tuple[float, float]]:
    """Parts of a `face` (2, 2), as intervals [m] from its start, that lie on one of `segments` (k, 2, 2)."""
    start, along = face[0], directions(face)
    across = right_of(along)
    parts = []
    for (a, b), direction in zip(segments, directions(segments), strict=True):
        if abs(direction @ across) > _PARALLEL or abs((a - start) @ across) > _TOUCHING * dx:
            continue
        low, high = sorted(((a - start) @ along, (b - start) @ along))
        low, high = max(low, 0.0), min(high, lengths(face))
        if high - low > _TOUCHING * dx:
            parts.append((low, high))
    return parts
