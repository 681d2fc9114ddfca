"""The particle fluid: models `ctvf` and `wcsph`, one stepping routine.

`ctvf`: EDAC pressure, corrected transport velocity, Sun's shifting. `wcsph`: equation of state, no shifting. They
differ by the terms that are compiled into the sweeps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from fluid_solver import diagnosis
from fluid_solver.fields import FLUID, OF_SHIFTING, PARKED, RHO, VOL, P, U, V, X, Y
from fluid_solver.ghosts import lay_ghosts
from fluid_solver.initial import fluid_particles, initial_state
from fluid_solver.integrate import advance_and_drift, keep_volume, kick, kick_and_drift, largest_of
from fluid_solver.motion import GhostMotion, keep_room, place_ghosts
from fluid_solver.observe import Observer
from fluid_solver.parameters import Parameters, courant_of, parameters
from fluid_solver.period import period_of, wrapped
from fluid_solver.sampling import FILLED, lowest_filling
from fluid_solver.store import Store
from fluid_solver.sweeps import Sweeps, make_sweeps
from fluid_solver.thin import refuse_thin
from shared.contract import Description, Frame, Kinematics, Loads
from shared.expected_speed import sound_speed
from shared.fluid_step import fluid_step
from shared.jit import use_threads
from shared.kernels import kernel_named
from shared.schema.scene import Scene

SERIAL_BELOW = 5000  # particles; fewer run faster on one thread


class ParticleFluid:
    """A weakly compressible fluid of particles, with walls and structures as ghosts (contract.Model)."""

    role = "fluid"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        fluid = scene.fluid
        self.scene, self._coupled = scene, coupled
        kernel = kernel_named(fluid.kernel)
        self.c: Parameters = parameters(scene, kernel, sound_speed(scene))
        self._courant = courant_of(fluid)
        refuse_thin(scene)
        self._transported = fluid.model == "ctvf"
        self.sweeps: Sweeps = make_sweeps(kernel.code, fluid.viscosity > 0.0, self._transported)
        self.ghosts = lay_ghosts(scene, self.c.support)
        water = fluid_particles(scene, self.c.c0, self.ghosts)
        self.fluid_count = len(water.position)
        self._first = self.fluid_count  # id of the first ghost
        self._walls = self.ghosts.walls
        self._threads = threads if self.particles() >= SERIAL_BELOW else 1
        self.store = Store(
            *initial_state(water, self.ghosts),
            self.c.support,
            diagnosis.domain_of(scene),
            period_of(scene),
            self._threads,
            () if self._transported else OF_SHIFTING,
        )
        u2 = np.max(np.sum(water.velocity**2, axis=1), initial=0.0)
        self.store.fastest[...] = 4.0 * u2  # streams that meet
        self._motion = GhostMotion(scene, self.ghosts)
        self.force = np.zeros((len(self.ghosts.position), 2))  # N/m on every ghost, at the last step's end
        self._mean_force = np.zeros_like(self.force)  # the same, mean over the last window
        self._volume = 0.0  # m² that the walls leave the fluid; 0 where it has a free surface
        self._speed = math.sqrt(u2)  # m/s, largest |u| at the last half step
        self._acceleration = 0.0  # m/s², largest |a|
        self._steps = 0
        self._unsettled = 0.0  # s, the step whose end `reach` has left
        self._ghost_speed = 0.0  # m/s, of the fastest in the last step
        self._lost = 0  # particles out of the domain that have been reported
        self._observer = Observer(scene, kernel, self.c, self.ghosts, self._first, water.body)

    # ---- the contract ---------------------------------------------------------------------------------------------

    def describe(self) -> Description:
        """The fluid's ghosts in the structure are its interface points."""
        structure = slice(self._walls, None)
        return Description(
            name="fluid",
            role="fluid",
            model=self.scene.fluid.model,
            stable_step=self.stable_step(),
            spacing=self.c.dx,
            position=self.ghosts.position[structure],
            volume=self.ghosts.volume[structure],
            body=self.ghosts.owner[structure],
            numbers={
                "density": self.c.rho0,
                "sound_speed": self.c.c0,
                "support": self.c.support,
                "h": self.c.h,
                "particles": float(self.particles()),
            },
        )

    def begin(self, motion: Kinematics | None) -> Loads:
        """Ghosts in place, first sort, pressures of ghosts and accelerations at t = 0."""
        use_threads(self._threads)
        self._motion.start(motion)
        self._place(0.0, 0.0, 1.0, motion, always=True)
        store = self.store
        store.sort()
        self._mirror()
        self._load_ghosts()
        self._fill(self._enclosed_volume())
        self._accelerate(0.0)
        self._mean_force[...] = self.force
        return self._loads()

    def _enclosed_volume(self) -> float:
        """Volume [m²] of fluid without a free surface between walls that leave it the same; 0 for any other."""
        store = self.store
        if (
            not keep_room(self.scene.walls)
            or self._coupled
            or lowest_filling(store.S, store.start, store.grid, self.c) < FILLED
        ):
            return 0.0
        return float(store.S[VOL, store.kind == FLUID].sum())

    def _fill(self, volume: float) -> None:
        """Take the `volume` [m²] that walls leave the fluid; 0 of one with a free surface."""
        self._volume = volume
        self.c = self.c._replace(filled=1.0 if volume > 0.0 and self._transported else 0.0)

    def stable_step(self) -> float:
        """Least of the acoustic, viscous and force limits [s]."""
        signal = self.c.c0 + 0.5 * math.sqrt(self.store.fastest.max())
        return fluid_step(self._courant, self.c.h, signal, self.c.nu, self._acceleration)

    def advance(self, t0: float, t1: float, substeps: int, boundary: Kinematics | None) -> Loads:
        """Integrate from t0 to t1 [s] in equal steps; the ghosts of structures follow `boundary`."""
        loads = self.reach(t0, t1, substeps, boundary)
        self.settle()
        return loads

    def reach(self, t0: float, t1: float, substeps: int, boundary: Kinematics | None) -> Loads:
        """As `advance`, but for the fluid's own last acceleration, for which its partner need not wait."""
        use_threads(self._threads)
        dt = (t1 - t0) / substeps
        mean = self._mean_force
        mean[...] = 0.0
        for k in range(substeps):
            if k > 0:
                self._accelerate(dt)
            mean += self.force
            self._drift(dt, t0, k * dt, t1 - t0, boundary)
            mean += self.force
        mean *= 0.5 / substeps
        self._steps += substeps
        self._motion.start(boundary)
        self._unsettled = dt
        return self._loads()

    def settle(self) -> None:
        """What `reach` has left."""
        use_threads(self._threads)
        self._accelerate(self._unsettled)

    def _drift(self, dt: float, t0: float, since: float, length: float, boundary: Kinematics | None) -> None:
        """A kick-drift-kick step of `dt` [s], at `since` after the start t0 of a window of `length`, but for the end:
        the fluid's acceleration and second kick."""
        store, c = self.store, self.c
        # 1, 2  u_half = u + a dt/2;  x += (u_half + δu) dt/2;  walls and ghosts to the middle of the step
        kick_and_drift(store.S, store.kind, store.count, dt, self._transported, store.speeds)
        self._speed, drift = largest_of(store.speeds, store.count)
        self._place(t0, since + 0.5 * dt, length, boundary)
        # 3  cells, if particles will have moved too far for the present ones
        ghosts = self._ghost_speed = self._motion.speed(boundary)
        store.move(0.5 * dt, drift, ghosts)
        store.sort_midway(dt, drift, ghosts)
        # 4, 5  ghosts' velocities and rates at the middle; p and ρ a full step on
        # 6     x += (u_half + δu) dt/2; walls and ghosts to the end
        self._mirror()
        self.sweeps.rates(store.S, *store.cells(), c, store.work)
        advance_and_drift(store.S, store.kind, store.count, dt, self._transported, c, store.work, store.clipped)
        if self._volume > 0.0:
            keep_volume(store.S, store.kind, store.count, self._volume, c, store.speeds)
        self._place(t0, since + dt, length, boundary)
        store.move(0.5 * dt, drift, ghosts)
        # 7  pressures of ghosts, eq. 14, and the forces on them
        self._load_ghosts()

    def _mirror(self) -> None:
        s = self.store
        self.sweeps.ghost_velocity(s.S, s.kind, s.ids, *s.cells(1), self.c, self._first, self._motion.pose)

    def _load_ghosts(self) -> None:
        s = self.store
        self.sweeps.ghosts(s.S, s.ids, *s.cells(1), self.c, self._first, self.force)

    def _accelerate(self, dt: float) -> None:
        """The end of a step of `dt` [s]."""
        s = self.store
        # 8  accelerations, shifting and surface at the new positions
        self.sweeps.forces(s.S, *s.cells(), self.c, self._speed, s.work, s.fastest)
        # 9  u = u_half + a dt/2;  cells for the next step, if it is like this one
        kick(s.S, s.kind, s.count, dt, self._transported, s.work, s.speeds)
        self._acceleration, drift = largest_of(s.speeds, s.count)
        s.sort_ahead(dt, drift, self._ghost_speed)

    def compile_sweeps(self) -> None:
        """Compile the sweeps over pairs, by one over the cells that there are before the first sort: none."""
        s = self.store
        self._load_ghosts()
        self.sweeps.forces(s.S, *s.cells(), self.c, self._speed, s.work, s.fastest)
        self.sweeps.rates(s.S, *s.cells(), self.c, s.work)
        self._mirror()

    def _place(self, t0, since, length, boundary, always=False) -> None:
        """Ghosts to the pose they have `since` seconds after t0; nothing to do when all stand still."""
        if self._motion.still(boundary) and not always:
            return
        self._motion.to(t0, since, length, boundary)
        s = self.store
        place_ghosts(s.S, s.kind, s.ids, s.count, s.grid, self._first, self._motion.pose)

    def _loads(self) -> Loads:
        last = self._first + len(self.ghosts.position)
        pressure = self.store.in_order_of_ids([P], self._first + self._walls, last)[0]
        return Loads(pressure, self._mean_force[self._walls :].copy())

    # ---- state and observation --------------------------------------------------------------------------------------

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on."""
        return {
            **self.store.state(),
            "force": self.force,
            "x0": self._motion.x0,
            "v0": self._motion.v0,
            "pose": self._motion.pose,
            "largest": np.array([self._speed, self._acceleration]),
            "volume": np.array([self._volume]),
        }

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Back to a `state`, bit for bit."""
        self.store.restore(state)
        moved = {"x0": self._motion.x0, "v0": self._motion.v0, "pose": self._motion.pose}
        for name, array in ({"force": self.force} | moved).items():
            array[...] = state[name]
        self._speed, self._acceleration = (float(k) for k in state["largest"])
        self._fill(float(state["volume"][0]))

    def check(self) -> None:
        """Raise SolverFailed if the state is not finite or the density far off."""
        diagnosis.check(self.store, self.c)
        self._lost = diagnosis.report_lost(self.store, self._lost)

    def probe_values(self) -> dict[str, float]:
        """Present values of the scene's fluid probes."""
        return self._observer.values(self.store, self._mean_force, self._motion.pose)

    def frame(self) -> Frame:
        """All fluid particles inside the domain, in their first order: velocity, pressure, density."""
        inside = np.ones(self.fluid_count, dtype=bool)
        inside[self.store.ids[self.store.kind == PARKED]] = False
        x, y, u, v, p, rho = self.store.in_order_of_ids([X, Y, U, V, P, RHO], 0, self.fluid_count)[:, inside]
        return Frame(
            wrapped(np.c_[x, y], period_of(self.scene)), {"velocity": np.c_[u, v], "pressure": p, "density": rho}
        )

    def particles(self) -> int:
        """Fluid, wall and structure-ghost particles."""
        return self.fluid_count + len(self.ghosts.position)

    def losses(self) -> dict[str, object]:
        """What has left the domain."""
        return diagnosis.losses(self.store, self.fluid_count)

    def steps(self) -> int:
        """Time steps taken so far."""
        return self._steps
