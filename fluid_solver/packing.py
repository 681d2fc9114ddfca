"""Fluid laid on a lattice that a face cuts, slanted or off its rows, packed until its particles fill their supports
evenly (Colagrossi, Bouscasse, Antuono, Marrone 2012).

As it was laid, some of it stands a quarter of a spacing off the face and some three quarters. Where particles are not
evenly spread, the pressure force is not that of the pressure alone, and water at rest is stirred for good: over a ridge
its mean pressure was a fifth too high (wcsph; packed 3 % low), and with h = 2 dx some of it went into the wall.
Positions alone move, by −∇C, C = Σ V W over fluid and ghosts, and beyond a free surface over the points of the fluid's
own lattice there, which are packed with it; a lattice that fits its faces stays. Beside a block half a spacing off,
the pressure of water at rest lifted it 3.5 % too little (packed 0.1 %; h = 1.3 dx).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from fluid_solver.ghosts import Ghosts
from shared.geometry.particles import surroundings
from shared.geometry.regions import distance_to
from shared.geometry.segments import directions, lengths, right_of
from shared.kernels import Kernel, evaluate, kernel_named
from shared.schema.fluid import Fluid
from shared.schema.geometry import Body

REACH = 2.0  # supports: how far from such a face fluid is packed
FITS = 0.1  # of dx: how far from half a spacing off a face a lattice may be that fits it
CLEAR = 0.4  # of dx: nearest to a face
_APART = 0.75  # of dx: nearer to fluid or ghosts, a point of the lattice beyond a free surface is left out
_SURFACE = 0.85  # C below which a particle is at a free surface
_SWEEPS, _LISTED = 200, 5  # at most; of so many each, neighbours are searched once
_PART, _LONGEST = 0.12, 0.1  # of h² ∇C, and of dx: a sweep's way
_EVEN = 0.01  # |h ∇C| of all, below which they are


def cutting(faces: np.ndarray, position: np.ndarray, dx: float) -> np.ndarray:
    """Those of the `faces` (k, 2, 2) that lie along neither axis, or within a spacing of the fluid at `position`
    (n, 2) [m] but not half a spacing off it."""
    along = np.abs(faces[:, 1] - faces[:, 0])
    cut = along.min(axis=1) > 1e-9 * along.max(axis=1)
    for k in np.flatnonzero(~cut):
        face, axis = faces[k], directions(faces[k])
        s, d = (position - face[0]) @ axis, (position - face[0]) @ -right_of(axis)
        beside = d[(s > 0.0) & (s < lengths(face)) & (d > -0.5 * dx) & (d < dx)]
        cut[k] = len(beside) > 0 and abs(beside.min() - 0.5 * dx) > FITS * dx
    return faces[cut]


def pack(fluid: Fluid, position: np.ndarray, volume: np.ndarray, faces: np.ndarray, ghosts: Ghosts) -> np.ndarray:
    """`position` (n, 2) [m] of particles of `volume` (n,) [m²], which fill the bodies of the `fluid`, packed near the
    cutting ones of `faces`: (k, 2, 2) [m] with the fluid on the left of start → end."""
    kernel, h, dx = kernel_named(fluid.kernel), fluid.h_over_dx * fluid.dx, fluid.dx
    position, cut, support = position.copy(), cutting(faces, position, dx), kernel.support * h
    if len(cut) == 0 or len(position) == 0:
        return position
    reach = (REACH + 2.0) * support
    near = np.flatnonzero(distance_to(cut, position) < reach)
    still = distance_to(cut, ghosts.position) < reach
    water, walls = position[near], ghosts.position[still]
    air, emptied = _beyond_surfaces(fluid.bodies, np.concatenate([water, walls]), cut, reach, dx)
    points = np.concatenate([water, air, walls])
    volumes = np.concatenate([volume[near], emptied, ghosts.volume[still]])
    far = distance_to(cut, points[: len(near) + len(air)])
    free = _near_surface(points, volumes, far < (REACH + 1.0) * support, kernel, h)
    moves = np.flatnonzero((far < REACH * support) & ~free)
    margin = 2.0 * _LISTED * _LONGEST * dx
    for sweep in range(_SWEEPS if len(moves) else 0):
        if sweep % _LISTED == 0:
            pairs = cKDTree(points).query_pairs(support + margin, output_type="ndarray")
        gradient = _gradient(points, volumes, pairs, kernel, h)[moves]
        size = np.hypot(*gradient.T)
        if h * size.max() < _EVEN:
            break
        way = np.minimum(_PART * h**2, _LONGEST * dx / np.maximum(size, 1e-300))
        points[moves] = off_faces(points[moves] - way[:, None] * gradient, faces, CLEAR * dx)
    position[near] = points[: len(near)]
    return position


def _beyond_surfaces(bodies: Sequence[Body], taken: np.ndarray, cut: np.ndarray, reach: float, dx: float):
    """Points (k, 2) of the lattices of `bodies` beyond their free surfaces, and their volumes (k,) [m²]: nearer than
    `reach` [m] to the faces `cut`, and clear of the `taken` points (n, 2)."""
    position, volume = np.empty((0, 2)), np.empty(0)
    for body in bodies:
        lattice = surroundings(body, dx, reach)
        alone = distance_to(cut, lattice.position) < reach
        others = cKDTree(np.concatenate([taken, position]))
        alone[alone] = others.query(lattice.position[alone])[0] > _APART * dx
        position = np.concatenate([position, lattice.position[alone]])
        volume = np.concatenate([volume, lattice.volume[alone]])
    return position, volume


def _near_surface(points, volumes, asked: np.ndarray, kernel: Kernel, h: float) -> np.ndarray:
    """Which of the fluid, that comes first in `points`, has a particle of a free surface within the support, or is one;
    those not `asked` (n,) are none."""
    pairs = cKDTree(points).query_pairs(kernel.support * h, output_type="ndarray")
    w, _ = evaluate(kernel, np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T), h)
    filled = evaluate(kernel, np.zeros(1), h)[0] * volumes
    for a, b in (pairs.T, pairs.T[::-1]):
        filled += np.bincount(a, w * volumes[b], len(points))
    surface = np.zeros(len(points), dtype=bool)
    surface[: len(asked)] = asked & (filled[: len(asked)] < _SURFACE)
    beside = surface.copy()
    for a, b in (pairs.T, pairs.T[::-1]):
        beside[a[surface[b]]] = True
    return beside[: len(asked)]


def _gradient(points: np.ndarray, volumes: np.ndarray, pairs: np.ndarray, kernel: Kernel, h: float) -> np.ndarray:
    """∇C [1/m] at all points."""
    a, b = pairs.T
    arm = points[a] - points[b]
    _, f = evaluate(kernel, np.hypot(*arm.T), h)
    found = np.empty_like(points)
    for axis in range(2):
        pull = f * arm[:, axis]
        found[:, axis] = np.bincount(a, pull * volumes[b], len(points)) - np.bincount(b, pull * volumes[a], len(points))
    return found


def off_faces(position: np.ndarray, faces: np.ndarray, clearance: float) -> np.ndarray:
    """`position` (n, 2) with the points nearer than `clearance` [m] to a face moved to that distance before it.

    Faces along the lattice stand half a spacing off; a slanted face cuts the lattice anywhere.
    """
    position = position.copy()
    for face in faces:
        start, along, normal = face[0], directions(face), -right_of(directions(face))
        s, d = (position - start) @ along, (position - start) @ normal
        near = (np.abs(d) < clearance) & (s > 0.0) & (s < lengths(face))
        position[near] += (clearance - d[near])[:, None] * normal
    return position
