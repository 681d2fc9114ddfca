"""Model `still`: water that stays at rest, and the load of its weight on what it touches.

Each wetted stretch of a solid's outline is a chain of nodes, the interface points, about dx apart (two spacings of a
solid of particles at most), and goes on up to the end of the straight side that it stands on. A node at x carries
p = ρ max(0, g·x + s), with s that of the level that keeps the water's volume between the faces as they are
(still_level.py). Between two nodes the face is straight and p linear up to the level, and its force −∫ p n dl goes to
both by the linear shape functions: exact for the deformed chain, so that load and its moment follow the interface.
Such forces alone bend a plate too much: a face w(x) lies h² w″/12 off the straight lines between nodes h apart, in the
mean. So each link's force f takes f (w₋ − 2 w + w₊)/12 back, from the second differences at the nodes next to it; on
chains of four links and more, which have three of them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import csr_matrix, lil_matrix

from fluid_solver.still_level import Level, pools
from shared.contract import Description, Frame, Kinematics, Loads, SolverFailed
from shared.geometry.particles import fill
from shared.geometry.regions import contains, outline
from shared.geometry.segments import lengths, right_of
from shared.geometry.wetted_faces import DRY, wet_links
from shared.schema.probes import FORCES
from shared.schema.scene import Scene

_LEAST_BENDS = 3  # of a chain, from which they tell how it bends at its ends


class StillWater:
    """Hydrostatic load on the structure's wetted faces (see the module's text; contract.Model)."""

    role = "fluid"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._gravity, self._g = np.array(scene.gravity), float(np.hypot(*scene.gravity))
        self._up = -self._gravity / (self._g or 1.0)
        self._pools = pools(scene.fluid.bodies)
        self._nodes, self._links, self._body, self._pool = _chains(scene, self._pools)
        self._bends, self._shares = _bends(self._links)
        self._place = self._nodes.copy()
        self._level = self._lay_levels()
        self._height = {k: level.first for k, level in self._level.items()}
        self._pressure, self._force = self._load(self._place)
        self._mean = self._force.copy()
        self._steps = 0

    def describe(self) -> Description:
        """The nodes of the wetted faces are the interface points."""
        length = np.zeros(len(self._nodes))
        for end in (0, 1):
            np.add.at(length, self._links[:, end], 0.5 * lengths(self._nodes[self._links]))
        dx = self._scene.fluid.dx
        return Description(
            name="fluid",
            role="fluid",
            model="still",
            stable_step=self.stable_step(),
            spacing=dx,
            position=self._nodes,
            volume=length * dx,
            body=self._body,
            numbers={"density": self._scene.fluid.density, "support": dx},
        )

    def begin(self, motion: Kinematics | None) -> Loads:
        """The load on the faces as they stand at t = 0."""
        if motion is not None:
            self._move(motion.position)
        self._pressure, self._force = self._load(self._place)
        self._mean = self._force.copy()
        return Loads(self._pressure, self._force)

    def stable_step(self) -> float:
        """Any step is stable."""
        return self._scene.end_time

    def advance(self, t0: float, t1: float, substeps: int, boundary: Kinematics | None) -> Loads:
        """The load at the window's end; as force the mean of both ends' [N/m]."""
        before = self._force
        if boundary is not None:
            self._move(boundary.position)
        self._pressure, self._force = self._load(self._place)
        self._mean = 0.5 * (before + self._force)
        self._steps += substeps
        return Loads(self._pressure, self._mean)

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on."""
        return {
            "place": self._place,
            "height": np.array(list(self._height.values())),
            "pressure": self._pressure,
            "force": self._force,
            "mean": self._mean,
        }

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Back to a `state`, bit for bit."""
        self._place, self._pressure = np.copy(state["place"]), np.copy(state["pressure"])
        self._force, self._mean = np.copy(state["force"]), np.copy(state["mean"])
        self._height = dict(zip(self._height, map(float, state["height"]), strict=True))

    def check(self) -> None:
        """Raise SolverFailed if the load is not finite."""
        if not np.isfinite(self._force.sum()):
            raise SolverFailed("the load of the water at rest is not finite: the structure ran away.")

    def probe_values(self) -> dict[str, float]:
        """Pressures at points of the water, forces on bodies, the level."""
        values = {}
        for probe in self._scene.probes:
            if probe.quantity == "pressure":
                values[probe.name] = float(self._at(np.array([probe.point]))[0])
            elif probe.quantity in FORCES and probe.body in self._solids():
                mine = self._body == self._solids().index(probe.body)
                values[probe.name] = float(self._mean[mine, FORCES.index(probe.quantity)].sum())
            elif probe.quantity == "level":
                values[probe.name] = self._probed_level(probe.body)
        return values

    def frame(self) -> Frame:
        """The water's lattice with the pressure there."""
        position = np.concatenate([fill(body, self._scene.fluid.dx).position for body in self._scene.fluid.bodies])
        return Frame(position, {"velocity": np.zeros_like(position), "pressure": self._at(position)})

    def particles(self) -> int:
        """Number of nodes."""
        return len(self._nodes)

    def steps(self) -> int:
        """Time steps taken so far."""
        return self._steps

    def _solids(self) -> list[str]:
        return [body.name for body in self._scene.solid.bodies]

    def _lay_levels(self) -> dict[int, Level]:
        """The level of each pool, by its first body; none without gravity."""
        if self._g == 0.0:
            return {}
        bodies = self._scene.fluid.bodies
        return {
            k: Level(
                np.concatenate([outline(body) for body, pool in zip(bodies, self._pools, strict=True) if pool == k]),
                self._links[self._pool[self._links[:, 0]] == k],
                self._nodes,
                self._up,
            )
            for k in sorted(set(self._pools))
        }

    def _move(self, place: np.ndarray) -> None:
        """The faces' nodes are at `place` (n, 2) [m]: so are the levels that keep the water's volume."""
        self._place = place.copy()
        self._height = {k: level.at(place, self._height[k]) for k, level in self._level.items()}

    def _top(self, pool: np.ndarray) -> np.ndarray:
        """Largest of −g·x [m²/s²] over the water of each `pool` (m,)."""
        return np.array([self._g * self._height.get(int(k), 0.0) for k in pool])

    def _probed_level(self, name: str | None) -> float:
        """Height y [m] of the surface of the water `name`, or the highest of all."""
        tops = []
        for body, k in zip(self._scene.fluid.bodies, self._pools, strict=True):
            if name in (None, body.name):
                rise = (self._height[k] - self._level[k].first) * self._up[1] if self._level else 0.0
                tops.append(float(outline(body)[..., 1].max()) + rise)
        return max(tops)

    def _load(self, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressure (n,) [Pa] and force (n, 2) [N/m] of nodes at `place` (n, 2)."""
        p = self._scene.fluid.density * (place @ self._gravity + self._top(self._pool))
        first, second = self._links.T
        into_solid = -right_of(place[second] - place[first])  # the solid is on the left; as long as the link
        at_first, at_second = _shared(p[first], p[second])
        force = np.zeros_like(place)
        np.add.at(force, first, at_first[:, None] * into_solid)
        np.add.at(force, second, at_second[:, None] * into_solid)
        back = self._shares @ ((at_first + at_second)[:, None] * into_solid)
        for node, times in zip(self._bends.T, (-1.0, 2.0, -1.0), strict=True):
            np.add.at(force, node, times * back)
        return np.maximum(p, 0.0), force

    def _at(self, points: np.ndarray) -> np.ndarray:
        """Pressure (m,) [Pa] at `points` (m, 2): of the water that holds them, else of the first."""
        pool = np.full(len(points), self._pools[0])
        for body, k in zip(self._scene.fluid.bodies[1:], self._pools[1:], strict=True):
            pool[contains(body, points)] = k
        return self._scene.fluid.density * np.maximum(points @ self._gravity + self._top(pool), 0.0)


def _chains(scene: Scene, pool: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (n, 2) [m], links (m, 2) between them with the solid on the left, body and pool of each node."""
    nodes, links, owner, of_pool = [], [], [], []
    for index, place, water in wet_links(scene):
        touched = np.where(water == DRY, DRY, np.array(pool)[water])
        touched = _upward(touched, float((place[-1] - place[0]) @ np.array(scene.gravity)))
        for k in np.flatnonzero(touched != DRY):
            if k == 0 or touched[k - 1] != touched[k]:
                nodes.append(place[k])
            nodes.append(place[k + 1])
            links.append((len(nodes) - 2, len(nodes) - 1))
            added = len(nodes) - len(owner)
            owner += [index] * added
            of_pool += [touched[k]] * added
    return np.array(nodes), np.array(links), np.array(owner, dtype=np.int64), np.array(of_pool)


def _shared(p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Integrals of the positive part of a pressure, from `p` (m,) to `q` (m,) on links of length 1, times the shape
    functions of both ends."""
    high, low = np.maximum(p, q), np.minimum(p, q)
    wet = np.where(low < 0.0, np.maximum(high, 0.0) / np.where(high > low, high - low, 1.0), 1.0)  # from the higher on
    high, low = np.maximum(high, 0.0), np.maximum(low, 0.0)
    total, far = 0.5 * wet * (high + low), wet**2 * (high + 2.0 * low) / 6.0
    return np.where(p >= q, total - far, far), np.where(p >= q, far, total - far)


def _bends(links: np.ndarray) -> tuple[np.ndarray, csr_matrix]:
    """Nodes (k, 3) of two links in a row, and the share of each link's force (k, m) that they take back: a twelfth, by
    their second differences as they are at the link's middle."""
    after = np.flatnonzero(links[:-1, 1] == links[1:, 0])  # the first link of each bend
    shares = lil_matrix((len(after), len(links)))
    for run in np.split(np.arange(len(after)), np.flatnonzero(np.diff(after) > 1) + 1):
        for k in range(len(run) + 1 if len(run) >= _LEAST_BENDS else 0):
            near = min(max(k - 1, 0), len(run) - 2)
            beyond = k - 0.5 - near
            shares[run[near], after[run[0]] + k] = (1.0 - beyond) / 12.0
            shares[run[near + 1], after[run[0]] + k] = beyond / 12.0
    return np.c_[links[after], links[after + 1, 1]], shares.tocsr()


def _upward(touched: np.ndarray, fall: float) -> np.ndarray:
    """Pools (m,) along a side, `DRY` where there is none: what lies above water is of its pool, for the level may
    rise. `fall`: what gravity does along the side."""
    climbing = touched if fall < 0.0 else touched[::-1]
    for k in range(1, len(climbing) if fall != 0.0 else 0):
        if climbing[k] == DRY:
            climbing[k] = climbing[k - 1]
    return touched
