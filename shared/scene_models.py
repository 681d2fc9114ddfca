"""What the structure models that are not made of particles need of a scene, and what of it they do not use."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from shared.geometry import own_box
from shared.scene_geometry import across, has_shape
from shared.schema import Scene, Shape

LEAST_SLENDER = 3.0  # length over thickness below which a body is no beam
WANTED_SLENDER = 5.0  # below it, shear and the clamps' neighbourhood rule, which a beam only sketches
LEAST_ROWS = 2  # rows of interface points across a beam that let a fluid's ghosts follow its rotation

_AXIS = {"left": 0, "right": 0, "bottom": 1, "top": 1}


def slenderness(shape: Shape) -> tuple[float, int]:
    """Length over thickness of a rectangle, and the axis of its length (0 or 1)."""
    lower, upper = own_box(shape)
    width, height = upper - lower
    return float(max(width, height) / min(width, height)), int(height > width)


def _beams(scene: Scene) -> Iterator[str]:
    """Bodies of model beam are slender rectangles, held at their ends, with points enough for a fluid."""
    solid = scene.solid
    if solid is None or solid.model != "beam":
        return
    for i, body in enumerate(solid.bodies or []):
        if not has_shape(body):
            continue
        path = f"solid.bodies[{i}]"
        if body.rectangle is None:
            yield f"{path}: model beam needs a rectangle; use model total-lagrangian for other shapes"
            continue
        ratio, axis = slenderness(body)
        if ratio < LEAST_SLENDER:
            yield (
                f"{path}.rectangle: {ratio:.3g} times as long as thick; model beam needs {LEAST_SLENDER:g} or more, "
                "model total-lagrangian takes any shape"
            )
        if scene.fluid is not None and solid.dx is not None and across(body, solid.dx) < LEAST_ROWS:
            yield (
                f"solid.dx = {solid.dx:g}: one row of points across '{body.name}' cannot tell a fluid how it turns; "
                "make it at most half the thickness"
            )
        for k, clamp in enumerate(solid.clamps or []):
            if clamp.body == body.name and _AXIS.get(clamp.face, axis) != axis:
                ends = " or ".join(name for name, of in _AXIS.items() if of == axis)
                yield f'solid.clamps[{k}].face = "{clamp.face}": model beam is held at its ends, {ends}'


def _motion(scene: Scene) -> Iterator[str]:
    solid = scene.solid
    if solid is not None and solid.motion is not None and solid.model not in ("rigid", None):
        yield f"solid.motion: prescribed motion is for model rigid, not for model {solid.model}"


def _unused(scene: Scene) -> Iterator[str]:
    solid = scene.solid
    if solid is None:
        return
    held_by_spring = any(solid.spring.stiffness) or any(solid.spring.damping)
    if held_by_spring and solid.model != "spring":
        yield f"solid.spring: has no effect with model {solid.model}"
    if solid.clamps and (solid.model == "spring" or solid.motion is not None):
        mover = "spring" if solid.motion is None else "motion"
        yield f"solid.clamps: have no effect with model {solid.model}, which solid.{mover} moves"
    if solid.model == "rigid":
        if solid.loads:
            yield "solid.loads: have no effect with model rigid"
        if any(body.velocity != (0.0, 0.0) for body in solid.bodies):
            yield "solid.bodies: initial velocities have no effect with model rigid; use solid.motion"
    elif solid.model == "beam":
        for i, body in enumerate(solid.bodies):
            ratio, _ = slenderness(body)
            if ratio < WANTED_SLENDER:
                wrong = f"solid.bodies[{i}]: '{body.name}' is {ratio:.3g} times as long as thick"
                yield f"{wrong}; model beam wants {WANTED_SLENDER:g}"


MODEL_CHECKS: tuple[Callable[[Scene], Iterator[str]], ...] = (_beams, _motion)
MODEL_WARNINGS: tuple[Callable[[Scene], Iterator[str]], ...] = (_unused,)
