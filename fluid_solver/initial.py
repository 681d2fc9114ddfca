"""The fluid at t = 0: bodies as packed and settled particles, and the state array that they begin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fluid_solver.fields import FLUID, FREE_SLIP, FRICTION, PR2, RHO, ROWS, VOL, M, P, U, V, X, Y
from fluid_solver.flows import initial_flow
from fluid_solver.ghosts import Ghosts
from fluid_solver.packing import off_faces, pack
from fluid_solver.period import period_of
from fluid_solver.settled import settle
from shared.contract import BadInput
from shared.geometry.particles import fill
from shared.geometry.regions import outline
from shared.geometry.wall_chains import segments_of
from shared.schema.scene import Scene

CLEAR = 0.25  # of dx: fluid laid nearer to a face is moved off it; on the face it would start at the wrong pressure


@dataclass(frozen=True)
class FluidParticles:
    """Fluid at t = 0: position [m], velocity [m/s] (n, 2), pressure [Pa], density [kg/m³], mass [kg/m], index of the
    body (n,)."""

    position: np.ndarray
    velocity: np.ndarray
    pressure: np.ndarray
    density: np.ndarray
    mass: np.ndarray
    body: np.ndarray


def fluid_particles(scene: Scene, c0: float, ghosts: Ghosts) -> FluidParticles:
    """All fluid bodies at t = 0, among the `ghosts`; `c0`: sound speed [m/s]."""
    fluid, faces = scene.fluid, boundary_faces(scene)
    lattices = [fill(body, fluid.dx) for body in fluid.bodies]
    for body, lattice in zip(fluid.bodies, lattices, strict=True):
        if len(lattice.position) == 0:
            raise BadInput(f"fluid body {body.name!r} holds no particle at fluid.dx = {fluid.dx:g} m: make dx smaller.")
    position = np.concatenate([shaken(lattice.position, fluid.shake * fluid.dx) for lattice in lattices])
    volume = np.concatenate([lattice.volume for lattice in lattices])
    position = off_faces(position, faces, CLEAR * fluid.dx)
    if fluid.shake == 0.0:
        position = pack(fluid, position, volume, faces, ghosts)
    gravity = np.where(np.diff(period_of(scene))[:, 0] > 0.0, 0.0, scene.gravity)
    parts, ends = [], np.cumsum([len(lattice.position) for lattice in lattices])
    for index, (body, here) in enumerate(zip(fluid.bodies, np.split(position, ends[:-1]), strict=True)):
        pressure, share = np.zeros(len(here)), np.ones(len(here))
        if fluid.initial_pressure == "hydrostatic":
            here, pressure, share = settle(body, here, gravity, c0, fluid.density, faces, fluid.dx)
        velocity, dynamic = initial_flow(body, here, fluid.density)
        pressure = pressure + dynamic
        density = fluid.density + pressure / c0**2
        parts.append((here, velocity, pressure, density, share, np.full(len(here), index)))
    position, velocity, pressure, density, share, owner = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    return FluidParticles(position, velocity, pressure, density, fluid.density * volume * share, owner)


def initial_state(water: FluidParticles, ghosts: Ghosts) -> tuple[np.ndarray, np.ndarray]:
    """State array and kinds of the fluid, then the ghosts."""
    n = len(water.position)
    S = np.zeros((ROWS, n + len(ghosts.position)))
    kind = np.concatenate([np.full(n, FLUID, dtype=np.int8), ghosts.kind])
    S[[X, Y]] = np.concatenate([water.position, ghosts.position]).T
    S[[U, V], :n] = water.velocity.T
    S[P, :n], S[RHO, :n], S[M, :n] = water.pressure, water.density, water.mass
    S[VOL, :n] = water.mass / water.density
    S[PR2, :n] = water.pressure / water.density**2
    S[VOL, n:] = ghosts.volume
    S[FRICTION] = kind != FREE_SLIP
    return S, kind


def shaken(position: np.ndarray, size: float) -> np.ndarray:
    """`position` (n, 2) with every coordinate moved by up to `size` [m], at random but always the same."""
    return position + np.random.default_rng(0).uniform(-size, size, position.shape) if size > 0.0 else position


def boundary_faces(scene: Scene) -> np.ndarray:
    """Faces of all walls and solid bodies as segments (k, 2, 2) [m] with the fluid on the left of start → end."""
    walls = [segments_of(wall) for wall in scene.walls]
    bodies = [outline(body)[:, ::-1] for body in (scene.solid.bodies if scene.solid else [])]
    return np.concatenate([*walls, *bodies, np.empty((0, 2, 2))])
