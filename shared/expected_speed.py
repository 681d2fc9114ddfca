"""The largest speed that a fluid is expected to reach, and its sound speed, which where it is "auto" goes by that, or
by its viscous stresses where they are larger than ρ U² (Morris et al. 1997).

Those are at most about ρ ν U/dx, where water that is pushed at the speed U leaves a wall within a spacing. They outdo
ρ U² where U dx < ν, and there the viscous step is shorter than that of sound: a sound speed for them takes no more
steps. Past cylinders, before pistons and in cavities, at Reynolds numbers of 0.01 to 1: with ten times U pressures were
lost or the run failed; with ten times √(ν U/dx) forces, flow and pressures lay within a tenth of those with twice that.
"""

from __future__ import annotations

import math

import numpy as np

from shared.elasticity import bulk_modulus
from shared.geometry.motion_table import largest_speed
from shared.geometry.regions import area, corners_of, faces, outline
from shared.geometry.segments import lengths, right_of
from shared.geometry.shakers import prescribed, shakers, sound_time
from shared.geometry.wall_speeds import lasting_faces, pushing_speed
from shared.schema.fluid import PARTICLE_FLUIDS, FluidBody
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS, Load, Solid, SolidBody

_UPRIGHT = 1e-6  # sine of a slope up to which a face is upright
MACH = 0.1  # largest expected speed, or √(stress/ρ), over the automatic sound speed: density varies by 1 %
CROSSED = 0.4  # radians of what shakes the water in which sound crosses it: squeezed, it swings by θ²/4, 4 %, more


def sound_speed(scene: Scene) -> float:
    """The scene's sound speed [m/s]; "auto": ten times the largest speed expected, or that of viscous stresses; 0 where
    nothing tells one."""
    given = scene.fluid.sound_speed
    return max(expected_speed(scene), viscous_speed(scene)) / MACH if given == "auto" else given


def viscous_speed(scene: Scene) -> float:
    """√(ν U/dx) [m/s], U the speed at which water or structures start or are driven: ρ times its square is the largest
    viscous stress. Not of falls, whose stresses their weight limits."""
    fluid, solid = scene.fluid, scene.solid
    if fluid.model not in PARTICLE_FLUIDS:
        return 0.0
    loose = solid.bodies if solid is not None and solid.model != "rigid" and solid.motion is None else []
    given = max(start_speed(scene), driven_speed(scene), *(_start(solid, body) for body in loose))
    return math.sqrt(fluid.viscosity * given / fluid.dx)


def expected_speed(scene: Scene) -> float:
    """Largest speed [m/s] of the water and of the structures in it, and what shaking is worth; 0 where nothing tells
    one."""
    return max(water_speed(scene), structure_speed(scene), shaken_speed(scene))


def water_speed(scene: Scene) -> float:
    """Largest speed [m/s] of free fall over the fluid's height from its initial speed, on to floors below it, and of
    what drives it: walls, structures, and its weight along a period."""
    points = corners_of(scene.fluid.bodies)
    height = float(np.ptp(points @ np.asarray(scene.gravity)))  # m²/s², times g
    start = start_speed(scene)
    fall = math.sqrt(2.0 * height + start**2)
    farther = math.sqrt(2.0 * (height + _drop(scene, points)) + start**2)
    fall = max(fall, min(farther, start + math.hypot(*scene.gravity) * scene.end_time))
    return max(fall, driven_speed(scene), _pulled(scene, points))


def _drop(scene: Scene, water: np.ndarray) -> float:
    """How far below water with these corners the lowest floor lies, times g [m²/s²]: a face of a wall or of a body of
    the structure that looks up."""
    bodies = scene.solid.bodies if scene.solid else []
    held = [*map(lasting_faces, scene.walls), *(outline(body)[:, ::-1] for body in bodies), np.empty((0, 2, 2))]
    faces, down = np.concatenate(held), np.asarray(scene.gravity)
    looks_up = right_of(faces[:, 1] - faces[:, 0]) @ down > _UPRIGHT * lengths(faces) * math.hypot(*down)
    deepest = float(np.max(water @ down))
    return float(np.max(faces[looks_up] @ down, initial=deepest)) - deepest


def start_speed(scene: Scene) -> float:
    """Largest speed [m/s] at which the fluid starts."""
    return max(math.hypot(*body.velocity) + _field_speed(body) for body in scene.fluid.bodies)


def _pulled(scene: Scene, water: np.ndarray) -> float:
    """Speed [m/s] that weight along a period gives water with these corners until the end, for there it falls on and
    on; no more than a layer of its width that sticks to walls reaches: g L²/(8 ν) between two, g L²/(2 ν) on one."""
    fastest, nu = 0.0, scene.fluid.viscosity
    sticky = [np.asarray(wall.polyline) for wall in scene.walls if wall.slip == "no"]
    for axis, bounds in enumerate((scene.fluid.periodic.x, scene.fluid.periodic.y)):
        if bounds is None or not scene.gravity[axis]:
            continue
        g, faces = abs(scene.gravity[axis]), (water[:, 1 - axis].min(), water[:, 1 - axis].max())
        sides = sum(any(_stands_at(wall, 1 - axis, face, scene.fluid.dx) for wall in sticky) for face in faces)
        held = {0: 0.0, 1: 2.0, 2: 8.0}[sides] * nu
        ends = g * (faces[1] - faces[0]) ** 2 / held if held > 0.0 else math.inf
        fastest = max(fastest, min(start_speed(scene) + g * scene.end_time, max(start_speed(scene), ends)))
    return fastest


def _stands_at(wall: np.ndarray, axis: int, face: float, near: float) -> bool:
    """Whether a wall (k, 2) [m] is straight and lies at a `face` [m] across an axis."""
    return not np.ptp(wall[:, axis]) and abs(float(wall[0, axis]) - face) < near


def driven_speed(scene: Scene) -> float:
    """Largest speed [m/s] at which walls push the water, and structures and clamps whose motion is prescribed."""
    water = corners_of(scene.fluid.bodies)
    speeds = [pushing_speed(wall, water) for wall in scene.walls]
    if scene.solid is not None:
        speeds += [largest_speed(motion, corners) for motion, corners in prescribed(scene.solid)]
    return max(speeds, default=0.0)


def shaken_speed(scene: Scene) -> float:
    """Speed [m/s] that the prescribed motions which turn about are worth: at an acceleration a they press on water of
    extent L as its weight does, by which it falls at √(2 a L); and sound has to cross it in time."""
    pressed = max((math.sqrt(2.0 * one.rate * one.speed * one.extent) for one in shakers(scene)), default=0.0)
    return max(pressed, MACH / CROSSED * sound_time(scene))


def structure_speed(scene: Scene) -> float:
    """Largest speed [m/s] at which bodies of the structure start, fall, or are pushed where they are not held."""
    solid = scene.solid
    if solid is None or solid.model == "rigid" or solid.motion is not None:
        return 0.0
    return max(math.hypot(_start(solid, body), _pushed(scene, body)) for body in solid.bodies)


def drifts(scene: Scene) -> bool:
    """Whether a body that neither clamps nor springs hold starts moving, falls or is pushed."""
    solid = scene.solid
    if solid is None or solid.model == "rigid" or solid.motion is not None or any(solid.spring.stiffness[:2]):
        return False
    loose = [body for body in solid.bodies if not _clamped(solid, body)]
    return any(body.velocity != (0.0, 0.0) or _pushed(scene, body) > 0.0 for body in loose)


def _start(solid: Solid, body: SolidBody) -> float:
    """Largest speed [m/s] at which a body starts: as a whole, spinning, and bending."""
    corners = outline(body).reshape(-1, 2)
    reach = 0.5 * math.hypot(*np.ptp(corners, axis=0))
    speed = math.hypot(*body.velocity) + abs(body.spin) * reach
    mode = body.velocity_mode
    if mode is None:
        return speed
    if mode.tip_speed is not None:
        return speed + abs(mode.tip_speed)
    return speed + abs(mode.tip_speed_over_c0) * math.sqrt(bulk_modulus(solid) / solid.density)


def _pushed(scene: Scene, body: SolidBody) -> float:
    """Speed [m/s] that its loads give a body until the end, over the fluid's extent at most, or on its springs; that
    of its fall where it stands above the water."""
    solid = scene.solid
    if _clamped(solid, body):
        return 0.0
    water = corners_of(scene.fluid.bodies)
    mass = solid.density * area(body)
    push = np.sum([_force(body, load, mass) for load in solid.loads if load.body == body.name], axis=0) / mass
    extent, speeds = np.ptp(water, axis=0), np.zeros(2)
    for axis, a in enumerate(np.broadcast_to(np.abs(push), 2)):
        held = solid.spring.stiffness[axis] if solid.model in RIGID_MODELS else 0.0
        swing = a * math.sqrt(mass / held) if held > 0.0 else math.inf
        speeds[axis] = min(a * scene.end_time, math.sqrt(2.0 * a * extent[axis]), swing)
    return max(math.hypot(*speeds), _fall(scene, body, water))


def _fall(scene: Scene, body: SolidBody, water: np.ndarray) -> float:
    """Speed [m/s] of the fall of a body that stands above the water, by nothing held, to the water's floor."""
    solid, down = scene.solid, np.asarray(scene.gravity)
    drop = float(np.max(water @ down) - np.max(outline(body).reshape(-1, 2) @ down))
    falls = solid.gravity and not any(solid.spring.stiffness[:2]) and drop > float(np.ptp(water @ down))
    return math.sqrt(2.0 * drop) if falls else 0.0


def _force(body: SolidBody, load: Load, mass: float) -> np.ndarray:
    """Largest force (2,) [N/m] of a load."""
    most = max(map(abs, load.table.factors)) if load.table is not None else 1.0
    if load.acceleration is not None:
        return most * mass * np.asarray(load.acceleration)
    return most * float(lengths(faces(body)[load.face]).sum()) * np.asarray(load.traction)


def _clamped(solid: Solid, body: SolidBody) -> bool:
    return any(clamp.body == body.name for clamp in solid.clamps)


def _field_speed(body: FluidBody) -> float:
    """Largest speed [m/s] of the body's velocity field."""
    return abs(body.velocity_field.speed) if body.velocity_field else 0.0
