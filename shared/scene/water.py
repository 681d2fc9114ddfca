"""What the models of the fluid need of a scene; looked at where the scene has no other mistake."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from shared.expected_speed import expected_speed
from shared.geometry.thin_walls import THINNEST, thin_walls
from shared.geometry.wetted_faces import wet_links, why_no_columns
from shared.schema.scene import Scene

_NO_SPEED = (
    'fluid.sound_speed = "auto": needs an expected speed, but the scene has no gravity, no initial velocity, nothing '
    "whose motion is prescribed and no load on a body that is free to move; give fluid.sound_speed in m/s, ten times "
    "the largest speed you expect"
)


def _sound_speed(scene: Scene) -> Iterator[str]:
    """Something tells the automatic sound speed, where the model has sound."""
    fluid = scene.fluid
    if fluid is None or fluid.sound_speed != "auto" or any(scene.gravity):
        return
    silent = fluid.model == "still" or (fluid.model == "column" and not fluid.column.compressible)
    if not silent and expected_speed(scene) == 0.0:
        yield _NO_SPEED


def _columns(scene: Scene) -> Iterator[str]:
    """Columns stand in rectangles, between the structure and a far end."""
    if scene.fluid is None or scene.fluid.model != "column":
        return
    for i, body in enumerate(scene.fluid.bodies):
        if wrong := why_no_columns(scene, body):
            yield f"fluid.bodies[{i}]: {wrong}"


def _still(scene: Scene) -> Iterator[str]:
    """Water at rest has a face of the structure to load."""
    if scene.fluid is None or scene.fluid.model != "still":
        return
    if next(wet_links(scene), None) is None:
        yield (
            'fluid.model = "still": is the load of water on a structure\'s faces, but no fluid body touches a face of '
            "a solid body; let them share a face, or use model wcsph or ctvf"
        )


def _thin_walls(scene: Scene) -> Iterator[str]:
    """No wall that holds two waters apart is thinner than its ghosts can tell."""
    for what, thickness, wet in thin_walls(scene):
        if wet:
            yield (
                f"{what} with water on both sides, less than {THINNEST:g} fluid.dx: the waters see each other through "
                f"it. Make the wall thicker, or fluid.dx at most {thickness / THINNEST:.3g} m (half of it is better)"
            )


WATER_CHECKS: tuple[Callable[[Scene], Iterator[str]], ...] = (_sound_speed, _columns, _still, _thin_walls)
