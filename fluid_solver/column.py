"""Model `column`: water as one-dimensional columns that stand side by side on the structure's wetted faces.

Each ghost is the foot of a column of length L. With v the face's speed into the water, f the wave that leaves the face
and g the one that arrives there, c the sound speed, τ = 2L/c and R the far end's reflection (−d open, +d closed):

    p = f + g,   ρ c v = f − g,   g(t) = R f(t − τ)                    (linear acoustics, by characteristics)
    p = ρ L v̇                                                         (incompressible, open far end)

Both are integrated over a window exactly: with F = ∫f dt and x the face's displacement, F(t) = ρ c x(t) + R F(t − τ),
so that the impulse on the face is ρ c Δx + 2R ΔF(t − τ), whatever the number of steps. The waves' memory is in
delay_line.py.
Under a structure that deforms, incompressible water takes the speed of its foot at a window's end from the mean speeds
of that window and the one before, v = (3 v̄ − v̄₋₁)/2 (BDF2), and v̇ from these speeds. Modes of the structure that are
faster than a window show any phase at its ends: their own speeds there would drive them, places let them die out.

Hydrostatic pressure at rest is added; the columns do not speak to each other (piston theory).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np

from fluid_solver.column_faces import wetted_patches
from fluid_solver.delay_line import DelayLine
from fluid_solver.hermite import hermite
from shared.contract import Description, Frame, Kinematics, Loads, SolverFailed
from shared.expected_speed import sound_speed
from shared.schema.probes import FORCES
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS


class Columns:
    """All columns of the scene (see the module's text; contract.Model)."""

    role = "fluid"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        fluid, self._column = scene.fluid, scene.fluid.column
        self._patches = wetted_patches(scene)
        self._rho = fluid.density
        self._c = sound_speed(scene) if self._column.compressible else math.inf
        sign = -1.0 if self._column.far_end == "open" else 1.0
        self._reflection = sign * self._column.reflection
        self._reference = np.concatenate([patch.position for patch in self._patches])
        self._normal = np.concatenate([np.tile(patch.normal, (len(patch.position), 1)) for patch in self._patches])
        self._length = np.concatenate([np.full(len(patch.position), patch.length) for patch in self._patches])
        self._width = np.concatenate([patch.width for patch in self._patches])
        self._static = np.concatenate([patch.static(scene, patch.position) for patch in self._patches])
        bounds = np.cumsum([0, *(len(patch.position) for patch in self._patches)])
        self._own = [slice(a, b) for a, b in itertools.pairwise(bounds)]
        self._lines = [DelayLine(len(patch.position)) for patch in self._patches] if math.isfinite(self._c) else []
        count = len(self._reference)
        self._time = np.zeros(1)
        self._face = np.zeros((3, count))  # displacement into the water, speed and acceleration at the window's end
        self._follows = not self._lines and scene.solid.model not in RIGID_MODELS  # speeds are taken from places
        self._mean_speed = np.zeros(count)  # in the last window
        self._pressure = self._static.copy()
        self._force = self._on_face(self._static)
        self._steps = 0

    # ---- the contract ---------------------------------------------------------------------------------------------

    def describe(self) -> Description:
        """The feet of the columns are the interface points."""
        return Description(
            name="fluid",
            role="fluid",
            model="column",
            stable_step=self.stable_step(),
            spacing=self._scene.fluid.dx,
            position=self._reference,
            volume=self._width * self._length,
            body=np.concatenate([np.full(len(patch.position), patch.body) for patch in self._patches]),
            numbers={
                "density": self._rho,
                "support": self._scene.fluid.dx,
                "depth": float(self._length.max()),
                **({"sound_speed": self._c} if math.isfinite(self._c) else {}),
            },
        )

    def begin(self, motion: Kinematics | None) -> Loads:
        """The waves at t = 0: what the face's speed sends out, nothing arriving."""
        if motion is not None:
            self._face = self._into_water(motion)
        for k, line in enumerate(self._lines):
            speed = self._face[1, self._own[k]]
            line.append(0.0, np.zeros_like(speed), self._rho * self._c * speed)
        self._mean_speed = self._face[1].copy()
        self._pressure = self._static + (self._rho * self._c * self._face[1] if self._lines else self._inertia())
        self._force = self._on_face(self._pressure)
        return Loads(self._pressure, self._force)

    def stable_step(self) -> float:
        """No step is unstable; a wave must not come back within the step that sends it."""
        step = self._scene.end_time
        return min(step, float(2.0 * self._length.min() / self._c)) if self._lines else step

    def advance(self, t0: float, t1: float, substeps: int, boundary: Kinematics | None) -> Loads:
        """Integrate from t0 to t1 [s]; the face moves by the cubic through its places and speeds at both ends."""
        start = self._face
        end = start.copy() if boundary is None else self._into_water(boundary)
        if self._lines:
            impulse = self._waves(t0, t1, substeps, start, end)
            mean = self._static + impulse / (t1 - t0)
            self._pressure = self._static + self._rho * self._c * end[1] + 2.0 * self._arriving(t1)[1]
        else:
            if self._follows:
                end[1:] = self._followed(end[0], t1 - t0)
            mean = self._static + self._rho * self._length * (end[1] - start[1]) / (t1 - t0)
            self._pressure = self._static + self._rho * self._length * end[2]
        self._face, self._time[0] = end, t1
        self._force = self._on_face(mean)
        self._steps += substeps
        return Loads(self._pressure, self._force)

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on."""
        result = {"time": self._time, "face": self._face, "pressure": self._pressure, "force": self._force}
        result["mean_speed"] = self._mean_speed
        for k, line in enumerate(self._lines):
            result[f"waves_{k}"] = line.state()
        return result

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Back to a `state`, bit for bit."""
        self._time, self._face = np.copy(state["time"]), np.copy(state["face"])
        self._pressure, self._force = np.copy(state["pressure"]), np.copy(state["force"])
        self._mean_speed = np.copy(state["mean_speed"])
        for k, line in enumerate(self._lines):
            line.restore(state[f"waves_{k}"])

    def check(self) -> None:
        """Raise SolverFailed if the waves are not finite."""
        if not np.isfinite(self._pressure.sum() + self._force.sum()):
            raise SolverFailed(
                f"The water column failed at t = {self._time[0]:.6g} s: its pressure is not finite. The coupling "
                'diverges: shorten coupling.window, or set coupling.scheme = "serial-implicit".'
            )

    def probe_values(self) -> dict[str, float]:
        """Pressures at points of the water, forces on bodies."""
        values, solids = {}, [body.name for body in self._scene.solid.bodies]
        for probe in self._scene.probes:
            if probe.quantity == "pressure":
                values[probe.name] = float(self._within(np.array([probe.point]))[0][0])
            elif probe.quantity in FORCES and probe.body in solids:
                mine = self.describe().body == solids.index(probe.body)
                values[probe.name] = float(self._force[mine, FORCES.index(probe.quantity)].sum())
        return values

    def frame(self) -> Frame:
        """The water's lattice at rest with pressure and velocity there."""
        position = np.concatenate([patch.lattice for patch in self._patches])
        pressure, velocity = self._within(position)
        return Frame(position, {"velocity": velocity, "pressure": pressure})

    def particles(self) -> int:
        """Number of columns."""
        return len(self._reference)

    def steps(self) -> int:
        """Time steps taken so far."""
        return self._steps

    # ---- inside ---------------------------------------------------------------------------------------------------

    def _into_water(self, motion: Kinematics) -> np.ndarray:
        """Displacement, speed and acceleration (3, n) of the feet along the columns."""
        along = [motion.position - self._reference, motion.velocity, motion.acceleration]
        return np.stack([np.sum(vector * self._normal, axis=1) for vector in along])

    def _on_face(self, pressure: np.ndarray) -> np.ndarray:
        """Force (n, 2) [N/m] of the pressures (n,) on the faces."""
        return -(pressure * self._width)[:, None] * self._normal

    def _inertia(self) -> np.ndarray:
        return self._rho * self._length * self._face[2]

    def _followed(self, place: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
        """Speed at the end of a window of `length` [s] that ends at `place` (n,) [m], and mean acceleration in it."""
        before, self._mean_speed = self._mean_speed, (place - self._face[0]) / length
        found = 1.5 * self._mean_speed - 0.5 * before
        return found, (found - self._face[1]) / length

    def _waves(self, t0: float, t1: float, substeps: int, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Send the window's waves off; the impulse ∫(f + g) dt (n,) per length of face."""
        length, rho_c, R = t1 - t0, self._rho * self._c, self._reflection
        before = self._arriving(t0)[0]
        for k in range(1, substeps + 1):
            time = t1 if k == substeps else t0 + length * (k / substeps)
            x, v = hermite((time - t0) / length, length, *start[:2], *end[:2])
            g_sum, g = self._arriving(time)
            for own, line in zip(self._own, self._lines, strict=True):
                line.append(time, rho_c * x[own] + g_sum[own], rho_c * v[own] + g[own])
        for line, patch in zip(self._lines, self._patches, strict=True):
            line.forget(t1 - 2.0 * patch.length / self._c)
        return rho_c * (end[0] - start[0]) + (2.0 * (self._arriving(t1)[0] - before) if R else 0.0)

    def _arriving(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """∫g dt and g (n,) at the feet."""
        if self._reflection == 0.0:
            return np.zeros(len(self._length)), np.zeros(len(self._length))
        parts = [
            line.at(time - 2.0 * patch.length / self._c) for line, patch in zip(self._lines, self._patches, strict=True)
        ]
        sums, values = (np.concatenate(column) for column in zip(*parts, strict=True))
        return self._reflection * sums, self._reflection * values

    def _within(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressure (m,) and velocity (m, 2) of the water at `points` (m, 2), each in the column nearest to it."""
        pressure, velocity = np.zeros(len(points)), np.zeros((len(points), 2))
        nearest = np.argmin([patch.distance(points) for patch in self._patches], axis=0)
        for k, patch in enumerate(self._patches):
            rows = np.flatnonzero(nearest == k)
            column, away = patch.locate(points[rows])
            pressure[rows] = patch.static(self._scene, points[rows])
            beyond, speed = self._dynamic(k, column, away)
            pressure[rows] += beyond
            velocity[rows] = speed[:, None] * patch.normal
        return pressure, velocity

    def _dynamic(self, k: int, i: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressure beyond the static one, and speed, (m,), `x` (m,) [m] from the feet of the columns i (m,) of patch
        k."""
        patch, at = self._patches[k], self._own[k].start + i
        if not self._lines:
            return self._rho * (patch.length - x) * self._face[2, at], self._face[1, at]
        now, back = self._time[0], 2.0 * patch.length / self._c
        f = self._lines[k].value(now - x / self._c, i)
        g = self._reflection * self._lines[k].value(now + x / self._c - back, i)
        return f + g, (f - g) / (self._rho * self._c)
