"""The updated-Lagrangian solid at the start: storage, fixed particles, and the state (see updated_fields.py)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from shared.elasticity import lame
from shared.kernels import Kernel, kernel_named
from shared.schema.scene import Scene
from solid_solver import updated_linear, updated_quadratic
from solid_solver.blocks import FAR, Storage
from solid_solver.bodies import LatticeBody, lattice_bodies
from solid_solver.clamps import FACE_POINT_WEIGHT, fixed_particles
from solid_solver.held import HeldPoints
from solid_solver.initial import prestrain, start_velocity, stretched
from solid_solver.updated_fields import ACTS, IRHO, MOVES, RHO, SXX, SZZ, M, U, V, X, Y

ORDERS = {"printed": 0, "linear": 1, "quadratic": 2}
"""Polynomials whose gradient is exact, by `solid.gradient`."""


@dataclass(frozen=True)
class Start:
    """`order` of the gradient; `S`: state; `spacing` (slots,): distance that a particle keeps from others [m];
    `h` [m]; `curvature`: rows from OWN on that hold the stress of the strain's variation."""

    bodies: list[LatticeBody]
    storage: Storage
    held: HeldPoints
    kernel: Kernel
    order: int
    h: float
    S: np.ndarray
    spacing: np.ndarray
    curvature: int


def start(scene: Scene) -> Start:
    """Bodies at rest in their places, then stretched and set off as the scene says.

    Fixed particles take part in the stress under the printed gradient, where columns of them continue the body, and
    under the linear one, where they stand on the face; with the quadratic one they enter the fits only.
    """
    solid = scene.solid
    bodies, kernel, order = lattice_bodies(scene), kernel_named(solid.kernel), ORDERS[solid.gradient]
    beyond = 0.0 if order else kernel.support * solid.h_over_dx
    share = FACE_POINT_WEIGHT if order == 2 else 1.0
    clamps = [[c for c in solid.clamps if c.body == b.shape.name] for b in bodies]
    parts = [[(c, *fixed_particles(b, c, beyond, share)) for c in own] for b, own in zip(bodies, clamps, strict=True)]
    points = [np.concatenate([np.zeros((0, 2)), *(p for _, p, _ in own)]) for own in parts]
    storage = Storage(bodies, points)
    held = HeldPoints([(c, p) for own in parts for c, p, _ in own])
    closest = np.repeat([b.spacing.min() for b in bodies], [len(p) for p in points])
    if not beyond:
        closest *= 0.5  # the outermost particles stand half a spacing from the face
    least = np.concatenate([np.full(len(b.position), b.spacing.min()) for b in bodies])
    S = np.zeros(((updated_quadratic if order == 2 else updated_linear).ROWS, storage.slots))
    areas = np.concatenate([np.full(len(b.position), b.cell) for b in bodies])
    held_areas = np.concatenate([np.zeros(0), *(area for own in parts for _, _, area in own)])
    S[M] = solid.density * storage.plane(areas, held_areas)
    S[MOVES] = storage.plane(np.ones(len(areas)), 0.0)
    S[ACTS] = storage.plane(np.ones(len(areas)), 0.0 if order == 2 else 1.0)
    S[RHO], S[IRHO] = solid.density, 1.0 / solid.density
    positions, points = np.concatenate([b.position for b in bodies]), np.concatenate(points)
    for i in range(2):
        S[X + i] = storage.plane(positions[:, i], points[:, i], FAR * solid.dx)
    for body in bodies:
        _set_off(scene, body, S, storage.free[body.own])
    h = solid.h_over_dx * max(math.sqrt(b.cell) for b in bodies)
    spacing = storage.plane(least, closest, solid.dx)
    return Start(bodies, storage, held, kernel, order, h, S, spacing, 6 if order == 2 else 2)


def _set_off(scene: Scene, body: LatticeBody, S: np.ndarray, slot: np.ndarray) -> None:
    """Stretch, stress and velocity of a body whose particles stand in `slot` (n,)."""
    solid, mu = scene.solid, lame(scene.solid)[1]
    centre, strain = body.position.mean(axis=0), prestrain(body.shape)
    S[U : V + 1, slot] = start_velocity(solid, body.shape, body.position, centre).T
    S[X : Y + 1, slot] = stretched(body.shape, body.position, centre).T
    trace = float(np.trace(strain))
    third = trace / 3.0
    deviator = [strain[0, 0] - third, strain[0, 1], strain[1, 1] - third, -third]
    S[SXX : SZZ + 1, slot] = 2.0 * mu * np.array(deviator)[:, None]
    S[RHO, slot] = solid.density * (1.0 - trace)
    S[IRHO, slot] = 1.0 / S[RHO, slot]
