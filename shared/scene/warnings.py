"""Warnings about a scene that runs but may not mean what its writer thinks. One rule, one function."""

from __future__ import annotations

from collections.abc import Iterator

from shared.expected_speed import viscous_speed, water_speed
from shared.geometry.particles import fill
from shared.geometry.thin_walls import THINNEST, thin_walls
from shared.geometry.wall_chains import crowds
from shared.scene.geometry import WANTED_ACROSS, WANTED_ANISOTROPY, WANTED_RATIO, across
from shared.scene.models import MODEL_WARNINGS
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS

_SAFE_MACH = 0.2  # expected speed over sound speed above which water is visibly compressed


def scene_warnings(scene: Scene) -> list[str]:
    """One sentence per doubt about a checked scene, each starting with the path."""
    rules = (
        _anisotropy,
        _thin,
        _spacing_ratio,
        _walls,
        _crowds,
        _thin_walls,
        _dissipation,
        _sound_speed,
        _intervals,
        *MODEL_WARNINGS,
    )
    return [warning for rule in rules for warning in rule(scene)]


def _anisotropy(scene: Scene) -> Iterator[str]:
    for side, name in ((scene.fluid, "fluid"), (scene.solid, "solid")):
        for i, body in enumerate(side.bodies if side else []):
            x, y = fill(body, side.dx).spacing
            difference = abs(x - y) / min(x, y)
            if difference > WANTED_ANISOTROPY:
                yield (
                    f"{name}.bodies[{i}]: '{body.name}' is filled at {x:.4g} by {y:.4g} m, {100 * difference:.1f} % "
                    "apart; a dx that divides both sides avoids it"
                )


def _thin(scene: Scene) -> Iterator[str]:
    made_of_particles = scene.solid is not None and scene.solid.model in PARTICLE_MODELS
    for i, body in enumerate(scene.solid.bodies if made_of_particles else []):
        count = across(body, scene.solid.dx)
        if count < WANTED_ACROSS:
            yield f"solid.bodies[{i}]: {count} particles across '{body.name}'; bending wants {WANTED_ACROSS} or more"


def _spacing_ratio(scene: Scene) -> Iterator[str]:
    if scene.fluid and scene.solid:
        ratio = max(scene.fluid.dx / scene.solid.dx, scene.solid.dx / scene.fluid.dx)
        if ratio > WANTED_RATIO:
            yield (
                f"fluid.dx = {scene.fluid.dx:g} and solid.dx = {scene.solid.dx:g} differ {ratio:.3g} times; "
                f"up to {WANTED_RATIO:g} times is tried and tested"
            )


def _walls(scene: Scene) -> Iterator[str]:
    for i, wall in enumerate(scene.walls):
        if scene.fluid is None:
            yield f"walls[{i}]: '{wall.name}' has no effect without a fluid"
        elif wall.slip == "no" and scene.fluid.viscosity == 0.0:
            yield f'walls[{i}].slip = "no": has no effect with fluid.viscosity = 0'


def _crowds(scene: Scene) -> Iterator[str]:
    for group in crowds(scene.walls, scene.fluid.dx) if scene.fluid else []:
        names = ", ".join(f"'{scene.walls[k].name}'" for k in group)
        yield (
            f"walls[{group[0]}]: {names} meet in one point, where the ghost layers of each end, as no two of them are "
            "told to be one face; write those that are as one polyline, and let the third stand on it"
        )


def _thin_walls(scene: Scene) -> Iterator[str]:
    for what, _, wet in thin_walls(scene):
        if not wet:
            yield (
                f"{what}, less than {THINNEST:g} fluid.dx: where water comes to both sides, the waters will see each "
                "other through it"
            )


def _dissipation(scene: Scene) -> Iterator[str]:
    if scene.fluid and scene.fluid.model == "wcsph" and scene.fluid.alpha == scene.fluid.viscosity == 0.0:
        yield "fluid.alpha = 0: model wcsph without any viscosity rings and scatters; 0.02 to 0.1 is usual"


def _sound_speed(scene: Scene) -> Iterator[str]:
    if scene.fluid and isinstance(scene.fluid.sound_speed, float):
        speed = water_speed(scene)
        if speed > _SAFE_MACH * scene.fluid.sound_speed:
            yield (
                f"fluid.sound_speed = {scene.fluid.sound_speed:g}: water is expected to reach {speed:.3g} m/s; ten "
                "times that keeps density within 1 %"
            )
        stress = viscous_speed(scene)
        if stress > max(speed, _SAFE_MACH * scene.fluid.sound_speed):
            yield (
                f"fluid.sound_speed = {scene.fluid.sound_speed:g}: where something stands in the way of a flow this "
                f"viscous, its stresses press like water at √(ν U/dx) = {stress:.3g} m/s; ten times that keeps density "
                "within 1 %"
            )


def _intervals(scene: Scene) -> Iterator[str]:
    for i, reference in enumerate(scene.references):
        if reference.between is not None and reference.between[1] > scene.end_time * (1.0 + 1e-9):
            yield f"references[{i}].between = {list(reference.between)}: ends after end_time = {scene.end_time:g}"
