"""The largest speed that a fluid is expected to reach, by which fluid.sound_speed = "auto" goes."""

from __future__ import annotations

import math

import numpy as np

from shared.geometry import outline
from shared.motion_table import largest_speed
from shared.schema import Scene
from shared.schema_fluid import FluidBody, Wall

NO_SPEED = (
    'fluid.sound_speed = "auto": needs an expected speed, but the scene has no gravity, no initial velocity of the '
    "fluid and nothing whose motion is prescribed; give fluid.sound_speed in m/s, ten times the "
    "largest speed you expect"
)
"""What is wrong where the expected speed is 0."""


def expected_speed(scene: Scene) -> float:
    """Largest speed [m/s] of free fall over the fluid's height from its initial speed, and of what drives it; 0 where
    nothing tells one."""
    g = math.hypot(*scene.gravity)
    points = np.concatenate([outline(body).reshape(-1, 2) for body in scene.fluid.bodies])
    height = np.ptp(points @ np.asarray(scene.gravity)) / g if g > 0.0 else 0.0
    return max(math.sqrt(2.0 * g * height + start_speed(scene) ** 2), driven_speed(scene))


def start_speed(scene: Scene) -> float:
    """Largest speed [m/s] at which the fluid starts."""
    return max(math.hypot(*body.velocity) + _field_speed(body) for body in scene.fluid.bodies)


def driven_speed(scene: Scene) -> float:
    """Largest speed [m/s] of walls, and of structures and clamps whose motion is prescribed."""
    speeds = [_wall_speed(wall) for wall in scene.walls]
    if scene.solid is not None:
        motions = [scene.solid.motion, *(clamp.motion for clamp in scene.solid.clamps)]
        corners = np.concatenate([outline(body).reshape(-1, 2) for body in scene.solid.bodies])
        speeds += [largest_speed(motion, corners) for motion in motions if motion is not None]
    return max(speeds, default=0.0)


def _field_speed(body: FluidBody) -> float:
    """Largest speed [m/s] of the body's velocity field."""
    return abs(body.velocity_field.speed) if body.velocity_field else 0.0


def _wall_speed(wall: Wall) -> float:
    """Largest speed [m/s] of a wall."""
    return largest_speed(wall.motion, wall.polyline) if wall.motion else abs(wall.surface_speed)
