"""A slender rectangle as a beam: its own frame, elements, section, clamps and loads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from shared.contract import BadInput
from shared.elasticity import plane_modulus
from shared.geometry.regions import SIDES
from shared.schema.geometry import Motion
from shared.schema.scene import Scene
from shared.schema.solid import Load, Solid
from shared.solid_step import first_frequency
from solid_solver.filled import FilledBody
from solid_solver.loads import Schedule, schedule

SHEAR_FACTOR = 5.0 / 6.0
"""κs of a rectangle (Cowper 1966, ν = 0): with it the shear share of A and B agrees with the closed form."""


@dataclass(frozen=True)
class Beam:
    """A body as a beam. `axes` (2, 2): rows along the axis and along the section's normal, a quarter turn on; `origin`
    (2,) [m]: its first node; `h` [m]: element length; `free` (n + 1,): nodes not clamped; `motions`: what moves the
    clamps of the first and the last node, None if they stand still; `mass` (n + 1, 3): lumped
    mass [kg/m] twice and rotary inertia [kg m] per node; `stiffness`: EA, GA*, EI per metre of depth; `element` (m,)
    and `offset` (m,) [m]: of its points."""

    body: FilledBody
    axes: np.ndarray
    length: float
    thickness: float
    h: float
    free: np.ndarray
    motions: tuple[Motion | None, Motion | None]
    mass: np.ndarray
    stiffness: tuple[float, float, float]
    element: np.ndarray
    offset: np.ndarray
    origin: np.ndarray

    def place(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Element (m,), fraction ξ of it (m,) and offset (m,) [m] of reference `points` (m, 2) [m]."""
        along, offset = ((points - self.origin) @ self.axes.T).T
        element = np.clip((along / self.h).astype(np.int64), 0, len(self.free) - 2)
        return element, along / self.h - element, offset


def make_beam(scene: Scene, body: FilledBody) -> Beam:
    """The beam in place of a body. Raises BadInput for a shape, or a clamp, that is none of a beam's."""
    solid, rectangle = scene.solid, body.shape.rectangle
    if rectangle is None:
        raise BadInput(
            f"Body '{body.shape.name}' is no rectangle, so model beam cannot stand for it; use total-lagrangian."
        )
    size = np.array([rectangle[2] - rectangle[0], rectangle[3] - rectangle[1]])
    axis = int(size[1] > size[0])
    length, thickness = float(size[axis]), float(size[1 - axis])
    count = max(1, math.floor(length / solid.dx + 0.5))
    h = length / count
    axes = np.array([body.axes[axis], [-body.axes[axis][1], body.axes[axis][0]]])
    origin = body.position.mean(axis=0) - 0.5 * length * axes[0]
    free, motions = np.ones(count + 1, dtype=np.bool_), [None, None]
    for clamp in (c for c in solid.clamps if c.body == body.shape.name):
        normal, sense = SIDES[clamp.face]
        if normal != axis:
            raise BadInput(
                f"Face '{clamp.face}' of body '{body.shape.name}' is a long one: model beam can be held at its ends "
                "only; clamp a short face, or use total-lagrangian."
            )
        free[0 if sense < 0.0 else -1] = False
        motions[0 if sense < 0.0 else 1] = clamp.motion
    share = np.full(count + 1, h)
    share[[0, -1]] *= 0.5
    mass = solid.density * np.outer(share, [thickness, thickness, thickness**3 / 12.0])
    along, offset = axes @ (body.position - origin).T
    element = (along / h).astype(np.int64)
    section = _section(solid, thickness, h)
    return Beam(body, axes, length, thickness, h, free, tuple(motions), mass, section, element, offset, origin)


def _section(solid: Solid, thickness: float, h: float) -> tuple[float, float, float]:
    """EA, GA*, EI of a metre of depth in plane strain."""
    plane = plane_modulus(solid)
    bending = plane * thickness**3 / 12.0
    shear = SHEAR_FACTOR * thickness * solid.youngs_modulus / (2.0 * (1.0 + solid.poisson_ratio))
    return plane * thickness, 1.0 / (1.0 / shear + h * h / (12.0 * bending)), bending


def frequency(beam: Beam, density: float) -> float:
    """First bending frequency [1/s] of the thin beam."""
    return first_frequency(int(np.sum(~beam.free)), beam.length, beam.stiffness[2], density * beam.thickness)


def no_load(beam: Beam) -> tuple[np.ndarray, np.ndarray]:
    """A load of zero: forces at the nodes (n + 1, 2) [N/m], and G and B of the elements (n, 4) [N]."""
    return np.zeros((len(beam.free), 2)), np.zeros((len(beam.free) - 1, 4))


def _spread(beam: Beam, force: np.ndarray, offset: float) -> tuple[np.ndarray, np.ndarray]:
    """The load of a `force` (2,) [N/m] in the beam's frame on every element, spread evenly along it at `offset` [m]."""
    node, couple = no_load(beam)
    node[:-1] += 0.5 * force
    node[1:] += 0.5 * force
    couple[:, :2] = offset * force
    couple[:, 2:] = beam.h / 12.0 * force
    return node, couple


def _one_load(beam: Beam, load: Load, density: float) -> tuple[np.ndarray, np.ndarray]:
    if load.acceleration is not None:
        return body_force(beam, np.array(load.acceleration), density)
    traction = beam.axes @ np.array(load.traction)
    normal, sense = SIDES[load.face]
    if abs(beam.axes[0] @ beam.body.axes[normal]) < 0.5:
        outward = sense * float(beam.axes[1] @ beam.body.axes[normal])
        return _spread(beam, traction * beam.h, 0.5 * beam.thickness * outward)
    node, couple = no_load(beam)
    node[0 if sense < 0.0 else -1] += traction * beam.thickness
    return node, couple


def body_force(beam: Beam, acceleration: np.ndarray, density: float) -> tuple[np.ndarray, np.ndarray]:
    """The load of a uniform `acceleration` (2,) [m/s²]."""
    return _spread(beam, beam.axes @ acceleration * density * beam.thickness * beam.h, 0.0)


def beam_loads(scene: Scene, beam: Beam):
    """Steady load, the schedules (g,) of others, and those loads: (g, n + 1, 2) and (g, n, 4)."""
    solid = scene.solid
    by_schedule = {Schedule(): no_load(beam)}
    if solid.gravity:
        by_schedule[Schedule()] = body_force(beam, np.asarray(scene.gravity), solid.density)
    for load in (one for one in solid.loads if one.body == beam.body.shape.name):
        when, new = schedule(load), _one_load(beam, load, solid.density)
        by_schedule[when] = tuple(a + b for a, b in zip(by_schedule.get(when, no_load(beam)), new, strict=True))
    steady = by_schedule.pop(Schedule())
    schedules = tuple(sorted(by_schedule))
    node = np.array([by_schedule[s][0] for s in schedules]).reshape(-1, *steady[0].shape)
    couple = np.array([by_schedule[s][1] for s in schedules]).reshape(-1, *steady[1].shape)
    return steady, schedules, (node, couple)
