"""What is observed of the fluid: the probes of the scene."""

from __future__ import annotations

import numpy as np

from fluid_solver.cells import COLUMNS, neighbour
from fluid_solver.fields import FLUID, RHO, STRUCTURE, M, U, V, X, Y
from fluid_solver.sampling import sample, surface_at
from fluid_solver.wall_forces import WallForces
from shared.jit import njit
from shared.kernels import Kernel
from shared.scene.sides import is_solids
from shared.schema.probes import FORCES, Probe
from shared.schema.scene import Scene

CONNECTED = 6  # fluid neighbours within the support that make a particle part of the bulk, not of the spray
INSIDE = 0.5  # of dx: fluid nearer than this to a ghost's centre is inside a wall
_SAMPLED = ("pressure", "velocity-x", "velocity-y")  # as `sample` returns them


class Observer:
    """Evaluates the scene's fluid probes.

    `ghosts`: owner and kind of every ghost; `first`: id of the first; `body` (fluid,): fluid body of each id.
    """

    def __init__(self, scene: Scene, kernel: Kernel, c, ghosts, first: int, body: np.ndarray):
        self._kernel, self._c, self._ghosts, self._first, self._body = kernel.code, c, ghosts, first, body
        self._fluids = {b.name: k for k, b in enumerate(scene.fluid.bodies)}
        self._wall_forces = WallForces(scene, ghosts, c.support)
        self._walls = {w.name: k for k, w in enumerate(scene.walls)}
        self._solids = {b.name: k for k, b in enumerate(scene.solid.bodies)} if scene.solid else {}
        self._probes = [p for p in scene.probes if not is_solids(scene, p)]

    def values(self, store, force: np.ndarray, pose: np.ndarray) -> dict[str, float]:
        """Present value of every fluid probe, by name. `force` (ghosts, 2) [N/m]: of the fluid on each ghost, mean
        over the last window; `pose` (ghosts, 8): present one (motion.py)."""
        return {probe.name: float(self._value(probe, store, force, pose)) for probe in self._probes}

    def _value(self, probe: Probe, store, force: np.ndarray, pose: np.ndarray) -> float:
        S, quantity = store.S[:, : store.count], probe.quantity
        kind = store.kind[: store.count]
        if quantity in _SAMPLED:
            sensor = self._sensor(probe)
            return sample(S, kind, self._kernel, *probe.point, store.grid, sensor)[_SAMPLED.index(quantity)]
        if quantity == "elevation":
            return surface_at(S, kind, self._kernel, probe.point[0], store.grid, self._c) - probe.point[1]
        if quantity in FORCES:
            return self._force_on(probe.body, FORCES.index(quantity), force, pose)
        if quantity == "clipped-impulse":
            return store.clipped.sum()
        if quantity == "leaked":
            reach = INSIDE * self._c.dx
            return store.parked + inside_walls(S, store.start, store.grid, reach)
        chosen = kind == FLUID
        if probe.body is not None:
            chosen[chosen] = self._body[store.ids[: store.count][chosen]] == self._fluids[probe.body]
        if not chosen.any():
            return 0.0
        if quantity == "max-speed":
            return fastest_of(S, chosen)
        if quantity == "kinetic-energy":
            return kinetic(S, chosen)
        if quantity == "total-energy":
            return kinetic(S, chosen) + stored(S, chosen, self._c)
        axis = X if quantity == "front-x" else Y
        return self._front(S, chosen, axis)

    def _sensor(self, probe: Probe):
        """The fluid's constants with a kernel as wide as the probe's extent, if that is wider than the fluid's own."""
        wider = 0.5 * (probe.extent or 0.0) / self._c.support
        return self._c if wider <= 1.0 else self._c._replace(h=wider * self._c.h, support=wider * self._c.support)

    def _front(self, S: np.ndarray, chosen: np.ndarray, axis: int) -> float:
        """Largest coordinate of connected fluid, at the face of its last particle [m]."""
        x, y = np.ascontiguousarray(S[X, chosen]), np.ascontiguousarray(S[Y, chosen])
        order = np.argsort(-S[axis, chosen], kind="stable")
        at = order[first_connected(x, y, order, self._c.support)]
        return (x, y)[axis][at] + 0.5 * self._c.dx

    def _force_on(self, name: str, axis: int, force: np.ndarray, pose: np.ndarray) -> float:
        if name in self._walls:
            return self._wall_forces.on(self._walls[name], force, pose[:, :2], pose[:, 6:])[axis]
        mine = (self._ghosts.kind == STRUCTURE) & (self._ghosts.owner == self._solids[name])
        return force[mine, axis].sum()


@njit
def fastest_of(S, chosen):
    """Largest speed [m/s] of the `chosen` (n,) particles."""
    u2 = 0.0
    for i in range(chosen.size):
        if chosen[i]:
            u2 = max(u2, S[U, i] * S[U, i] + S[V, i] * S[V, i])
    return np.sqrt(u2)


@njit
def kinetic(S, chosen):
    """Kinetic energy [J/m] of the `chosen` (n,) particles."""
    total = 0.0
    for i in range(chosen.size):
        if chosen[i]:
            total += 0.5 * S[M, i] * (S[U, i] * S[U, i] + S[V, i] * S[V, i])
    return total


@njit
def stored(S, chosen, c):
    """Energy [J/m] in the height, zero at the origin, and in the compression: ∫ p/ρ² dρ = c²(ln ρ/ρ0 + ρ0/ρ − 1)."""
    total = 0.0
    for i in range(chosen.size):
        if chosen[i]:
            squeezed = np.log(S[RHO, i] / c.rho0) + c.rho0 / S[RHO, i] - 1.0
            total += S[M, i] * (c.c0 * c.c0 * squeezed - c.gx * S[X, i] - c.gy * S[Y, i])
    return total


@njit
def first_connected(x, y, order, reach):
    """Position in `order` of the first particle with enough neighbours within `reach` [m]; 0 if none has."""
    for k in range(order.size):
        xa, ya = x[order[k]], y[order[k]]
        neighbours = -1  # itself
        for b in range(x.size):
            if (xa - x[b]) ** 2 + (ya - y[b]) ** 2 < reach * reach:
                neighbours += 1
        if neighbours >= CONNECTED:
            return k
    return 0


@njit
def inside_walls(S, start, grid, reach):
    """Number of fluid particles nearer than `reach` [m] to a ghost."""
    found = 0
    for cell in range(grid.columns, grid.columns * (grid.rows - 1)):
        if start[2 * cell] == start[2 * cell + 1] or not ghosts_around(start, grid, cell):
            continue
        for a in range(start[2 * cell], start[2 * cell + 1]):
            nearest = np.inf
            for j in range(-1, 2):
                for i in range(-COLUMNS, COLUMNS + 1):
                    other, x, y = neighbour(grid, cell % grid.columns + i, cell // grid.columns + j)
                    for b in range(start[2 * other + 1], start[2 * other + 2]):
                        nearest = min(nearest, (S[X, a] - S[X, b] - x) ** 2 + (S[Y, a] - S[Y, b] - y) ** 2)
            if nearest < reach * reach:
                found += 1
    return found


@njit
def ghosts_around(start, grid, cell):
    """Whether any cell within the support holds a ghost."""
    for j in range(-1, 2):
        for i in range(-COLUMNS, COLUMNS + 1):
            other, _, _ = neighbour(grid, cell % grid.columns + i, cell // grid.columns + j)
            if start[2 * other + 1] < start[2 * other + 2]:
                return True
    return False
