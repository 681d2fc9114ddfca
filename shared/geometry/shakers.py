"""What prescribed motions do to the water that walls, structures and clamps are moved in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from shared.geometry.motion_table import MotionTable
from shared.geometry.regions import corners_of
from shared.geometry.wall_speeds import pushing_speed
from shared.schema.geometry import Motion
from shared.schema.scene import Scene
from shared.schema.solid import Solid

_SAMPLES = 1001  # times at which a motion is looked at
_ROUNDING = 1e-9  # of the speed: a change within a step of the table that rounded numbers make


@dataclass(frozen=True)
class Shaker:
    """One motion until the `end` [s], seen at the farthest of the `points` (n, 2) [m] that it moves; `extent` [m] of
    the water that it squeezes: up to its surface, else a closed box's own, and round a structure the least."""

    motion: Motion
    points: np.ndarray
    extent: float
    structure: bool
    end: float

    @cached_property
    def way(self) -> float:
        """Largest displacement [m]."""
        return self._sizes(0).max()

    @cached_property
    def span(self) -> float:
        """Largest distance [m] between two of its places."""
        x, y, turned = np.ptp(self._rates(0), axis=0)
        return math.hypot(x, y) + turned

    @cached_property
    def speed(self) -> float:
        """Largest speed [m/s]."""
        return self._sizes(1).max()

    @cached_property
    def acceleration(self) -> float:
        """Largest acceleration [m/s²], but for what turns towards the centre."""
        return self._sizes(2).max()

    @cached_property
    def rate(self) -> float:
        """How fast it turns about [rad/s]: the root mean square of its accelerations over that of its speeds, ω of a
        sine."""
        speed, faster = self._sizes(1), self._sizes(2)
        return float(np.sqrt(np.sum(faster**2) / np.sum(speed**2))) if speed.any() else 0.0

    def jolt(self, sound: float) -> float:
        """What jumps of its speed and acceleration, at its start and where it ends before the run, set ringing in water
        of a `sound` speed [m/s] a quarter wave deep, over its largest acceleration."""
        ends = (0, -1) if self.motion.times[-1] < self.end else (0,)
        rings = 0.5 * math.pi * sound / self.extent
        push = max(self._sizes(2)[k] + rings * self._sizes(1)[k] for k in ends)
        if self.acceleration * min(np.diff(self.motion.times)) > _ROUNDING * self.speed:
            return push / self.acceleration
        return math.inf if push > 0.0 else 0.0

    def _sizes(self, order: int) -> np.ndarray:
        """Sizes of displacement, or of its rates by `order`, at the samples."""
        x, y, turned = self._rates(order).T
        return np.hypot(x, y) + np.abs(turned)

    def _rates(self, order: int) -> np.ndarray:
        """The same along x, along y and along the way round of the farthest point, (samples, 3)."""
        table, times = MotionTable(self.motion), np.linspace(0.0, min(self.motion.times[-1], self.end), _SAMPLES)
        reach = float(np.hypot(*(self.points - table.about).T).max())
        return table.displacements(times, order) * (1.0, 1.0, reach)


def prescribed(solid: Solid) -> list[tuple[Motion, np.ndarray]]:
    """The prescribed motions of a structure and of its clamps, with the corners (n, 2) [m] of the bodies that each
    moves."""
    moved = [(clamp.motion, [body for body in solid.bodies if body.name == clamp.body]) for clamp in solid.clamps]
    return [(one, corners_of(bodies)) for one, bodies in [(solid.motion, solid.bodies), *moved] if one is not None]


def shakers(scene: Scene) -> list[Shaker]:
    """All of a scene with a fluid: walls that push, structures, clamps."""
    water = corners_of(scene.fluid.bodies)
    extent, g = np.ptp(water, axis=0), math.hypot(*scene.gravity)
    height = float(np.ptp(water @ np.asarray(scene.gravity))) / g if g else math.inf
    pushes = [wall for wall in scene.walls if wall.motion is not None and pushing_speed(wall, water) > 0.0]
    moved = [(wall.motion, np.asarray(wall.polyline), min(height, float(extent.max())), False) for wall in pushes]
    if scene.solid is not None:
        least = min(height, float(extent.min()))
        moved += [(motion, corners, least, True) for motion, corners in prescribed(scene.solid)]
    return [Shaker(*one, scene.end_time) for one in moved]


def as_one(scene: Scene, motion: Motion) -> bool:
    """Whether the motion moves all that the water meets, so that it goes along and only its weight changes."""
    moved = [wall.motion for wall in scene.walls] + ([scene.solid.motion] if scene.solid is not None else [])
    return bool(scene.walls) and not any(motion.rotation or []) and all(one == motion for one in moved)


def sound_time(scene: Scene) -> float:
    """ω L [m/s], the largest: over the sound speed the radians of what shakes the water in which sound crosses it."""
    return max((one.rate * one.extent for one in shakers(scene)), default=0.0)
