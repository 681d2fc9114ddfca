"""The water's part of pre-flight: what a fluid is like before it is computed, from the scene alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight.measures.gravity import across_and_up, upward
from coupler.preflight.measures.shapes import area, least_extent
from shared.expected_speed import drifts, driven_speed, expected_speed, sound_speed, start_speed
from shared.fluid_step import COURANT, fluid_step
from shared.geometry.regions import contains, corners_of, distance_to, outline
from shared.geometry.segments import lengths
from shared.geometry.thin_walls import points_along
from shared.geometry.wall_chains import segments_of
from shared.geometry.wall_speeds import lasting_faces
from shared.kernels import kernel_named
from shared.schema.scene import Scene

_BACKED = 0.75  # of dx: a wall or body this close behind the water's face holds it
LEVEL = 0.01  # of dx: a surface that slopes less is level
_COLUMNS = 100  # of a body, in which it is looked what covers it
_MOMENTS = 50  # at which it is looked whether something is in the way of water that falls
UPWARD = 0.7  # cosine against gravity beyond which a face of the water is its free surface


@dataclass(frozen=True)
class Water:
    """The fluid. `held`: on all sides but its surface something stands behind it, so that it does not fall; `slope`
    [m]: how far a body's surface is from level, from its highest place to its lowest; `rests`: it is held and level,
    starts at rest, and nothing drives it or drifts in it; `boxed`: at rest, and something stands behind its
    surface too; `waves`: it is held, has a surface and weight, and does not rest; `pulled`: its weight drives it along
    a period; `free`: it falls as a whole, and nothing is in its way until the end."""

    model: str
    density: float
    sound_speed: float
    speed: float  # largest expected, m/s
    height: float  # against gravity, without it least along an axis, m
    width: float  # least extent of a body, whichever way it is turned, m
    dx: float
    h: float
    support: float
    artificial: float  # viscosity α h c0/8 [m²/s] that alpha makes (Monaghan)
    particles: float
    step: float
    courant: float
    held: bool
    slope: float
    rests: bool
    boxed: bool
    waves: bool
    pulled: bool
    free: bool
    bottomless: float  # share of its lower faces with nothing below

    def dragged_layer(self, omega: float) -> float:
        """Depth √(2 ν/ω) [m] of the layer that artificial viscosity drags along with what swings at `omega` [rad/s]."""
        return math.sqrt(2.0 * self.artificial / omega)


def measure_water(scene: Scene) -> Water:
    """The water of a scene with a fluid."""
    fluid = scene.fluid
    g = math.hypot(*scene.gravity)
    corners = corners_of(fluid.bodies)
    height = float(np.ptp(corners @ np.asarray(scene.gravity))) / g if g else float(np.ptp(corners, axis=0).min())
    start, speed = start_speed(scene), expected_speed(scene)
    sound = sound_speed(scene)
    h = fluid.h_over_dx * fluid.dx
    support = kernel_named(fluid.kernel).support * h
    courant = COURANT.get(fluid.model, 1.0) if fluid.courant == "auto" else fluid.courant
    pulled = bool(np.any(np.asarray(scene.gravity)[_periods(scene)]))
    open_sides, open_top, slope = unbacked(scene)
    level = slope <= LEVEL * fluid.dx
    still = level and start == 0.0 and driven_speed(scene) == 0.0 and not drifts(scene) and not pulled
    if fluid.model in COURANT and not g:
        open_sides = open_sides or open_top  # what presses on it drives it away
    elif fluid.model not in COURANT:
        open_top = open_top and fluid.column.far_end == "open"
    if fluid.model in COURANT:
        step = fluid_step(courant, h, sound + start, fluid.viscosity, g)
    else:  # nothing moves in `still`; a wave in `column` must not come back within the step that sends it
        sounds = fluid.model == "column" and fluid.column.compressible and sound > 0.0
        echo = 2.0 * height / sound if sounds else scene.end_time
        step = min(scene.end_time, echo)
    return Water(
        model=fluid.model,
        density=fluid.density,
        sound_speed=sound,
        speed=speed,
        height=height,
        width=min(least_extent(body) for body in fluid.bodies),
        dx=fluid.dx,
        h=h,
        support=support,
        artificial=fluid.alpha * h * sound / 8.0,
        particles=_fluid_particles(scene, support),
        step=step,
        courant=courant,
        held=not open_sides,
        slope=slope,
        rests=still and not open_sides,
        boxed=still and not open_sides and not open_top,
        waves=not still and not open_sides and open_top and g > 0.0,
        pulled=pulled,
        free=open_sides and open_top and _falls_free(scene),
        bottomless=bottomless(scene),
    )


def _fluid_particles(scene: Scene, support: float) -> float:
    """Fluid, wall and structure particles that a fluid of particles steps."""
    dx = scene.fluid.dx
    layers = math.ceil(support / dx)
    count = sum(area(body) for body in scene.fluid.bodies) / dx**2
    count += sum(float(lengths(segments_of(wall)).sum()) for wall in scene.walls) / dx * layers
    for body in scene.solid.bodies if scene.solid else []:
        edge = float(lengths(outline(body)).sum())
        count += min(area(body) / dx**2, edge / dx * layers)
    return count


def unbacked(scene: Scene) -> tuple[bool, bool, float]:
    """Whether sides or bottom of the water, and whether its surface, have nothing behind them; and by how much [m] the
    surface of a body that has one is off level."""
    up, dx = upward(scene), scene.fluid.dx
    samples = [edge_samples([body], dx) for body in scene.fluid.bodies]
    middle, outward = (np.concatenate(part) for part in zip(*samples, strict=True))
    near = np.full(len(middle), np.inf)
    for segments in _faces_behind(scene):
        near = np.minimum(near, distance_to(segments, middle))
    for other in scene.fluid.bodies:  # water behind water holds it too
        inside = distance_to(outline(other), middle + outward * dx) > 0.5 * dx
        near[inside & contains(other, middle + outward * dx)] = 0.0
    for axis, bounds in enumerate((scene.fluid.periodic.x, scene.fluid.periodic.y)):
        for bound in bounds or ():
            near[np.abs(middle[:, axis] - bound) < _BACKED * dx] = 0.0
    free = near > _BACKED * dx
    if not up.any():  # without weight nothing falls, and any face may be free
        return False, bool(free.any()), 0.0
    looks_up = outward @ up > UPWARD
    height = np.where(free & looks_up, middle @ up, np.nan)
    tops = (top[np.isfinite(top)] for top in np.split(height, np.cumsum([len(points) for points, _ in samples])[:-1]))
    slope = max((float(np.ptp(top)) for top in tops if len(top)), default=0.0)
    return bool(np.any(free & ~looks_up)), bool(np.any(free & looks_up)), slope


def _periods(scene: Scene) -> np.ndarray:
    """Which of both directions is periodic."""
    return np.array([bounds is not None for bounds in (scene.fluid.periodic.x, scene.fluid.periodic.y)])


def _falls_free(scene: Scene) -> bool:
    """Whether the water, falling as a whole, meets neither wall nor structure until the end."""
    velocities = {body.velocity for body in scene.fluid.bodies}
    if len(velocities) > 1 or any(body.velocity_field for body in scene.fluid.bodies) or _periods(scene).any():
        return False
    reach = kernel_named(scene.fluid.kernel).support * scene.fluid.h_over_dx * scene.fluid.dx
    middle, velocity = edge_samples(scene.fluid.bodies, scene.fluid.dx)[0], np.asarray(scene.fluid.bodies[0].velocity)
    for time in np.linspace(0.0, scene.end_time, _MOMENTS):
        way = velocity * time + 0.5 * np.asarray(scene.gravity) * time**2
        if any(distance_to(segments, middle + way).min() < reach for segments in _faces_behind(scene)):
            return False
    return True


def bottomless(scene: Scene) -> float:
    """Share of the water's lower faces with neither wall nor structure nor water anywhere below them."""
    g = np.asarray(scene.gravity, dtype=float)
    if not g.any() or g[_periods(scene)].any():
        return 0.0
    up = upward(scene)
    frame = across_and_up(up)
    dx = scene.fluid.dx
    middle, outward = edge_samples(scene.fluid.bodies, dx)
    low = middle[outward @ up < -UPWARD] @ frame
    faces = np.concatenate([*_faces_behind(scene), *map(outline, scene.fluid.bodies)]) @ frame
    start, end = faces[:, 0], faces[:, 1]
    left, right = np.minimum(start[:, 0], end[:, 0]), np.maximum(start[:, 0], end[:, 0])
    across = np.where(end[:, 0] == start[:, 0], np.inf, end[:, 0] - start[:, 0])
    share = np.clip((low[:, None, 0] - start[:, 0]) / across, 0.0, 1.0)
    height = start[:, 1] + share * (end[:, 1] - start[:, 1])
    above = (low[:, None, 0] > left - 0.5 * dx) & (low[:, None, 0] < right + 0.5 * dx)
    own = len(faces) - sum(len(outline(body)) for body in scene.fluid.bodies)  # water's faces come last
    reach = np.where(np.arange(len(faces)) < own, _BACKED * dx, -_BACKED * dx)  # its own is no face below itself
    return float(np.mean(~np.any(above & (height < low[:, None, 1] + reach), axis=1))) if len(low) else 0.0


def covered(scene: Scene) -> float:
    """Depth [m] below the level of its body, integrated over the water that faces keep from rising to it, over the
    area of all water: settled water that can not stand lower is more by as much, times g/c0²."""
    frame, depths = across_and_up(upward(scene)), 0.0
    for body in scene.fluid.bodies:
        ends = outline(body) @ frame
        (left, _), (right, level) = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
        wide = (right - left) / _COLUMNS
        for x in left + wide * (np.arange(_COLUMNS) + 0.5):
            (x0, z0), (x1, z1) = np.moveaxis(ends[(ends[:, :, 0] < x).sum(axis=1) == 1], 0, -1)
            z = np.sort(z0 + (x - x0) / (x1 - x0) * (z1 - z0))
            low, high = level - z[::2], level - z[1::2]  # depths
            depths += 0.5 * wide * float(np.sum((low**2 - high**2)[high > LEVEL * scene.fluid.dx]))
    return float(depths / sum(area(body) for body in scene.fluid.bodies))


def edge_samples(bodies, dx: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) every dx or less along the outlines, and the outward normals there."""
    points, inward = points_along(np.concatenate([outline(body) for body in bodies]), dx)
    return points, -inward


def _faces_behind(scene: Scene) -> list[np.ndarray]:
    """Segments (k, 2, 2) of the walls, where they may hold water, and of the solid's bodies."""
    walls = [lasting_faces(wall) for wall in scene.walls]
    return walls + [outline(body) for body in (scene.solid.bodies if scene.solid else [])]
