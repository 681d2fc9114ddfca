"""Model `still`: water that stays at rest, and the load of its weight on what it touches.

Each wetted stretch of a solid's outline is a chain of nodes, the interface points, about dx apart. A node at x carries
p = ρ max(0, g·x + s), with s the largest of −g·x over the water at t = 0: the surface stays where it is. Between two
nodes the face is straight and p linear, and its force −∫ p n dl goes to both by the linear shape functions: exact for
the deformed chain, so that load and its moment follow the interface.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Frame, Kinematics, Loads, SolverFailed
from shared.geometry import contains, fill, outline
from shared.schema import Scene
from shared.wetted_faces import wet_links

_FORCES = ("force-x", "force-y")


class StillWater:
    """Hydrostatic load on the structure's wetted faces (see the module's text; contract.Model)."""

    role = "fluid"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._nodes, self._links, self._body, self._top = _chains(scene)
        self._place = self._nodes.copy()
        self._pressure, self._force = self._load(self._place)
        self._mean = self._force.copy()
        self._steps = 0

    def describe(self) -> Description:
        """The nodes of the wetted faces are the interface points."""
        length = np.zeros(len(self._nodes))
        for end in (0, 1):
            np.add.at(length, self._links[:, end], 0.5 * np.hypot(*self._along(self._nodes).T))
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
            self._place = motion.position.copy()
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
            self._place = boundary.position.copy()
        self._pressure, self._force = self._load(self._place)
        self._mean = 0.5 * (before + self._force)
        self._steps += substeps
        return Loads(self._pressure, self._mean)

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on."""
        return {"place": self._place, "pressure": self._pressure, "force": self._force, "mean": self._mean}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Back to a `state`, bit for bit."""
        self._place, self._pressure = np.copy(state["place"]), np.copy(state["pressure"])
        self._force, self._mean = np.copy(state["force"]), np.copy(state["mean"])

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
            elif probe.quantity in _FORCES and probe.body in self._solids():
                mine = self._body == self._solids().index(probe.body)
                values[probe.name] = float(self._force[mine, _FORCES.index(probe.quantity)].sum())
            elif probe.quantity == "level":
                bodies = [b for b in self._scene.fluid.bodies if probe.body in (None, b.name)]
                values[probe.name] = float(max(outline(body)[..., 1].max() for body in bodies))
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

    def _along(self, place: np.ndarray) -> np.ndarray:
        return place[self._links[:, 1]] - place[self._links[:, 0]]

    def _load(self, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressure (n,) [Pa] and force (n, 2) [N/m] of nodes at `place` (n, 2)."""
        p = self._scene.fluid.density * np.maximum(place @ np.array(self._scene.gravity) + self._top, 0.0)
        along = self._along(place)
        into_solid = np.c_[-along[:, 1], along[:, 0]]  # the solid is on the left; as long as the link
        force = np.zeros_like(place)
        first, second = self._links.T
        np.add.at(force, first, ((2.0 * p[first] + p[second]) / 6.0)[:, None] * into_solid)
        np.add.at(force, second, ((p[first] + 2.0 * p[second]) / 6.0)[:, None] * into_solid)
        return p, force

    def _at(self, points: np.ndarray) -> np.ndarray:
        """Pressure (m,) [Pa] at `points` (m, 2): of the water that holds them, else of the first."""
        gravity, bodies = np.array(self._scene.gravity), self._scene.fluid.bodies
        top = np.full(len(points), _surface(bodies[0], gravity))
        for body in bodies[1:]:
            top[contains(body, points)] = _surface(body, gravity)
        return self._scene.fluid.density * np.maximum(points @ gravity + top, 0.0)


def _surface(body, gravity: np.ndarray) -> float:
    """Largest of −g·x [m²/s²] over a body of water."""
    return float(np.max(-outline(body).reshape(-1, 2) @ gravity))


def _chains(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (n, 2) [m], links (m, 2) between them with the solid on the left, body and surface level of each node."""
    gravity = np.array(scene.gravity)
    nodes, links, owner, top = [], [], [], []
    for index, water, place, wet in wet_links(scene):
        for k in wet:
            joined = links and links[-1][2] == (index, water.name, k - 1) and np.all(nodes[-1] == place[k])
            if not joined:
                nodes.append(place[k])
            nodes.append(place[k + 1])
            links.append((len(nodes) - 2, len(nodes) - 1, (index, water.name, k)))
            added = len(nodes) - len(owner)
            owner += [index] * added
            top += [_surface(water, gravity)] * added
    pairs = np.array([link[:2] for link in links], dtype=np.int64)
    return np.array(nodes), pairs, np.array(owner, dtype=np.int64), np.array(top)
