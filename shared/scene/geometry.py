"""Checks of a scene's geometry: overlaps, bodies finer than their particles, clamps that hold nothing;
warnings.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator

import numpy as np
from scipy.spatial import cKDTree

from shared.geometry.particles import fill, wall_particles
from shared.geometry.regions import area, contains, distance_to, faces, outline, own_size
from shared.geometry.segments import lengths
from shared.geometry.wall_chains import segments_of
from shared.schema.fluid import Wall
from shared.schema.geometry import SHAPE_KINDS, Body, Domain, Shape
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS, RIGID_MODELS

OVERLAP_TOLERANCE = 0.01  # depth over dx up to which two bodies only touch
MOST_CELLS = 2e7  # particles per body that fit the memory of a large workstation
LEAST_ACROSS = 3  # particles across: fewer make the quadratic fit of the total-Lagrangian solid singular
WANTED_ACROSS = 4  # particles across below which bending is badly resolved
WANTED_ANISOTROPY = 0.03  # difference of the fitted spacings along both axes
WANTED_RATIO = 4.0  # ratio of the two sides' spacings
_WALL_DEPTH = 2.5  # wall layers looked at, over dx
_NEAR_WALL = 0.4  # distance over dx below which a fluid particle stands within a wall's ghosts
_SHORTEST = 1e-3  # length over dx below which two corners of a wall are taken for one
_FACE_REACH = 0.75  # distance over spacing within which a face's particles lie: half, and rounding


def has_shape(shape: Shape) -> bool:
    """Whether the shape could be read."""
    return any(getattr(shape, kind) is not None for kind in SHAPE_KINDS)


def across(shape: Shape, dx: float) -> int:
    """Particles across the shape where it is thickest, at spacing `dx` [m]."""
    if shape.rectangle is not None:
        return min(max(1, math.floor(length / dx + 0.5)) for length in own_size(shape))
    finer = 4  # samples per dx and axis
    sample = fill(shape, dx / finer).position
    deepest = distance_to(outline(shape), sample).max() if len(sample) else 0.0
    return round(2.0 * deepest / dx + 1.0 / finer)


def _shapes(scene: Scene) -> Iterator[tuple[str, Body, float]]:
    """Path, body and spacing [m] of every body that has a shape."""
    for side, name in ((scene.fluid, "fluid"), (scene.solid, "solid")):
        if side is None or side.dx is None:
            continue
        for i, body in enumerate(side.bodies or []):
            if has_shape(body):
                yield f"{name}.bodies[{i}]", body, side.dx


def _cells(body: Body, dx: float) -> float:
    """Number of lattice cells in the body's bounding box."""
    width, height = (float(length) for length in own_size(body))
    return (width / dx) * (height / dx)


def _bodies(scene: Scene) -> Iterator[tuple[str, Body, float]]:
    """Those of `_shapes` that are worth filling."""
    return ((path, body, dx) for path, body, dx in _shapes(scene) if _cells(body, dx) <= MOST_CELLS)


def _too_fine(scene: Scene) -> Iterator[str]:
    for path, body, dx in _shapes(scene):
        if _cells(body, dx) > MOST_CELLS:
            wrong = f"{path.split('.')[0]}.dx = {dx:g}: body {_called(path, body)} would hold {_cells(body, dx):.2g}"
            yield f"{wrong} particles; the limit is {MOST_CELLS:.0e}"
    for _, wall, dx in _walls(scene):
        count = _WALL_DEPTH * float(lengths(segments_of(wall)).sum()) / dx
        if count > MOST_CELLS:
            wrong = f"fluid.dx = {dx:g}: wall '{wall.name}' would hold {count:.2g}"
            yield f"{wrong} particles; the limit is {MOST_CELLS:.0e}"


def _walls(scene: Scene) -> Iterator[tuple[int, Wall, float]]:
    """Number, wall and ghost spacing [m] of every wall whose polyline could be read."""
    if scene.fluid is not None and scene.fluid.dx is not None:
        for i, wall in enumerate(scene.walls):
            if wall.polyline:
                yield i, wall, scene.fluid.dx


def _corners(scene: Scene) -> Iterator[str]:
    """A wall's segment needs a direction."""
    for i, wall, dx in _walls(scene):
        for k, length in enumerate(lengths(segments_of(wall))):
            if length < _SHORTEST * dx:
                other = (k + 1) % len(wall.polyline)
                yield f"walls[{i}].polyline: corners {k} and {other} are less than {_SHORTEST:g} dx apart; keep one"


def _domain(scene: Scene) -> Iterator[str]:
    """The domain has an inside, and the fluid starts there."""
    if not isinstance(scene.domain, Domain) or scene.domain.lower is None or scene.domain.upper is None:
        return
    lower, upper = np.array(scene.domain.lower), np.array(scene.domain.upper)
    if not np.all(lower < upper):
        yield f"domain: lower = {lower.tolist()} is not below and left of upper = {upper.tolist()}"
        return
    for path, body, _ in _bodies(scene):
        corners = outline(body).reshape(-1, 2)
        if path.startswith("fluid") and (np.any(corners < lower) or np.any(corners > upper)):
            yield f"{path}: {_called(path, body)} reaches out of the domain, where fluid is taken out"


def _called(path: str, body: Body) -> str:
    return f"'{body.name}'" if body.name else path


def _sizes(scene: Scene) -> Iterator[str]:
    for path, body, dx in _bodies(scene):
        if body.polygon is not None and _crosses_itself(body):
            yield f"{path}.polygon: crosses itself"
            continue
        extent = float(own_size(body).min())
        key = path.split(".")[0] + ".dx"
        model = scene.solid.model if path.startswith("solid") else None
        if area(body) == 0.0:
            yield f"{path}: {_called(path, body)} is empty: the shapes that are taken away leave nothing"
        elif extent < dx * (1.0 - 1e-9):
            yield f"{key} = {dx:g}: larger than body {_called(path, body)}, which measures {extent:g} m across"
        elif len(fill(body, dx).position) == 0:
            yield f"{key} = {dx:g}: too large, body {_called(path, body)} would hold no particle"
        elif model in PARTICLE_MODELS and across(body, dx) < LEAST_ACROSS:
            yield (
                f"{key} = {dx:g}: {across(body, dx)} particles across body {_called(path, body)}; model "
                f"{model} needs {LEAST_ACROSS} (dx at most {extent / LEAST_ACROSS:g}) for its quadratic fit"
            )


def _crosses_itself(body: Body) -> bool:
    edges = outline(body.model_copy(update={"rotate": None}))
    count = len(edges)
    for i, j in itertools.combinations(range(count), 2):
        if j - i in (1, count - 1):
            continue
        a, b = edges[i], edges[j]
        if _sides(a, b[0]) * _sides(a, b[1]) < 0 and _sides(b, a[0]) * _sides(b, a[1]) < 0:
            return True
    return False


def _sides(edge: np.ndarray, point: np.ndarray) -> float:
    along, offset = edge[1] - edge[0], point - edge[0]
    return float(np.sign(along[0] * offset[1] - along[1] * offset[0]))


def _overlaps(scene: Scene) -> Iterator[str]:
    """Cells of one body, shrunk by the tolerance, that reach into another body by more than the tolerance."""
    bodies = list(_bodies(scene))
    for (path_a, a, dx_a), (path_b, b, dx_b) in itertools.combinations(bodies, 2):
        dx = min(dx_a, dx_b)
        inside = np.concatenate([_cells_within(a, dx_a, b, dx), _cells_within(b, dx_b, a, dx)])
        if len(inside):
            x, y = inside.mean(axis=0)
            yield f"{path_b}: {_called(path_b, b)} overlaps {path_a}, {_called(path_a, a)}, near ({x:.4g}, {y:.4g})"


def _cells_within(body: Body, dx: float, other: Body, dx_least: float) -> np.ndarray:
    """Centres and corners (m, 2) of `body`'s cells deeper than the tolerance in `other`."""
    cells = fill(body, dx)
    half = 0.5 * np.array(cells.spacing)
    signs = np.array([[0, 0], [-1, -1], [1, -1], [1, 1], [-1, 1]])
    points = (cells.position[:, None] + (signs * (half - 0.5 * OVERLAP_TOLERANCE * dx_least)) @ cells.axes).reshape(
        -1, 2
    )
    points = points[contains(other, points)]
    points = points[contains(body, points)]
    return points[distance_to(outline(other), points) > OVERLAP_TOLERANCE * dx_least]


def _can_be_laid(wall: Wall, dx: float) -> bool:
    along = lengths(segments_of(wall))
    return bool(along.min() >= _SHORTEST * dx and _WALL_DEPTH * along.sum() / dx <= MOST_CELLS)


def _behind_walls(scene: Scene) -> Iterator[str]:
    """Fluid that stands within a wall's ghost layers, mostly because the polyline is walked the wrong way."""
    walls = [(i, wall) for i, wall, dx in _walls(scene) if _can_be_laid(wall, dx)]
    if not walls:
        return
    dx = scene.fluid.dx
    layers = wall_particles([wall for _, wall in walls], dx, _WALL_DEPTH * dx)
    for (i, wall), ghosts in zip(walls, layers, strict=True):
        tree = cKDTree(ghosts.position)
        for path, body, _ in _bodies(scene):
            if path.startswith("fluid"):
                position = fill(body, dx).position
                near = tree.query(position, distance_upper_bound=_NEAR_WALL * dx)[0] < np.inf
                if near.any():
                    x, y = position[near][0]
                    yield (
                        f"walls[{i}]: body {_called(path, body)} stands behind the face of wall '{wall.name}' near "
                        f"({x:.4g}, {y:.4g}); walk the polyline with the fluid on its left"
                    )


def _clamped(scene: Scene) -> Iterator[str]:
    """Every elastic body is clamped or meant to be free, and clamped faces hold particles."""
    if scene.solid is None or scene.solid.model in RIGID_MODELS:
        return
    clamps = scene.solid.clamps or []
    clamped = {clamp.body for clamp in clamps}
    # A clamp of a body that is not there is reported as such; the body it was meant for is not reported again.
    astray = clamped - {body.name for body in scene.solid.bodies or []}
    for i, body in enumerate(scene.solid.bodies or []):
        if body.name and body.name not in clamped and not body.free and not astray:
            yield (
                f"solid.bodies[{i}]: body '{body.name}' has no clamp; add {{ body = \"{body.name}\", face = … }} to "
                "solid.clamps, or free = true to let it move"
            )
    by_name = {body.name: body for _, body, _ in _bodies(scene)}
    for i, clamp in enumerate(clamps):
        if clamp.body in by_name and clamp.face is not None:
            segments = faces(by_name[clamp.body]).get(clamp.face)
            cells = fill(by_name[clamp.body], scene.solid.dx)
            reach = _FACE_REACH * max(cells.spacing)
            if segments is not None and not (distance_to(segments, cells.position) < reach).any():
                yield f'solid.clamps[{i}].face = "{clamp.face}": no particle stands along it at dx {scene.solid.dx:g}'


GEOMETRY_CHECKS: tuple[Callable[[Scene], Iterator[str]], ...] = (
    _too_fine,
    _corners,
    _sizes,
    _domain,
    _clamped,
    _overlaps,
    _behind_walls,
)
