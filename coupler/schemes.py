"""Coupling schemes: one window of each, readable as the order of events.

Serial: the structure moves first, under a predicted mean load, and the fluid follows its true motion, so that its wall
never jumps. Parallel: both sides work at once, on predictions of both. Explicit: a window is taken once. Implicit: the
load used is compared with the load found, and the window is taken again from a better one until they agree.

The state between windows is `Coupled`; each scheme takes a window and says what happened as an `Outcome`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from coupler.acceleration import Acceleration
from coupler.mapping import Mapping
from coupler.prediction import Predictor, carried_on
from coupler.remote import Remote
from coupler.vectors import Measure, pack, unpack
from shared.clock import Window
from shared.contract import Kinematics, Loads, SolverFailed, exchange_fields
from shared.run.checkpoint import State, inside, under

Probes = dict[str, float]


@dataclass
class Coupled:
    """The two sides and what lies between them at a window's start.

    `points`, `ghosts`: motion of the structure's points and of the fluid's wall, as they are; `loads`, `motions`: the
    predictors of the mean loads on the points and of their motion.
    """

    fluid: Remote
    structure: Remote
    mapping: Mapping
    points: Kinematics
    ghosts: Kinematics
    loads: Predictor
    motions: Predictor

    def accept(
        self,
        used: Loads,
        found: Loads,
        mapped: Loads,
        points: Kinematics,
        ghosts: Kinematics,
        changes: Sequence[float],
        converged: bool = True,
    ) -> Outcome:
        """The window is final: the loads `mapped` to the points become the past, `points` and `ghosts` the next start;
        what happened in it."""
        outcome = Outcome(used, found, mapped, (self.points, points), (self.ghosts, ghosts), tuple(changes), converged)
        self.loads.add(mapped)
        self.motions.add(points)
        self.points, self.ghosts = points, ghosts
        return outcome

    def state(self) -> State:
        """What lies between the two sides, as named arrays; the sides have their own."""
        return (
            under("points", exchange_fields(self.points))
            | under("ghosts", exchange_fields(self.ghosts))
            | under("loads", self.loads.state())
            | under("motions", self.motions.state())
        )

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        self.points, self.ghosts = (Kinematics(**inside(name, state)) for name in ("points", "ghosts"))
        self.loads.restore(inside("loads", state))
        self.motions.restore(inside("motions", state))


@dataclass(frozen=True)
class Outcome:
    """One accepted window: loads on the points as `used` by the structure, loads on the ghosts as `found` by the fluid,
    these as `mapped` to the points; motion of points and ghosts at start and end; `changes`: the difference of loads
    found and used over the loads, at every iteration; whether the last met the tolerance."""

    used: Loads
    found: Loads
    mapped: Loads
    points: tuple[Kinematics, Kinematics]
    ghosts: tuple[Kinematics, Kinematics]
    changes: tuple[float, ...]
    converged: bool = True


@dataclass(frozen=True)
class Iteration:
    """How an implicit scheme iterates."""

    acceleration: Acceleration
    measure: Measure
    most: int
    accept_at_cap: bool

    def capped(self, window: Window, changes: list[float]) -> None:
        """All iterations are used up: fail, unless the scene says otherwise."""
        self.acceleration.forget()
        if not self.accept_at_cap:
            raise SolverFailed(
                f"window {window.index}, t = {window.t0:.6g} s: the loads still change by {changes[-1]:.2g} of "
                f"themselves after {self.most} iterations (first {changes[0]:.2g}; coupling.tolerance = "
                f'{self.measure.relative:g}). Use coupling.acceleration = "iqn-ils", shorten coupling.window, raise '
                'coupling.max_iterations or coupling.tolerance, or set coupling.on_cap = "accept".'
            )


def serial_explicit(c: Coupled, window: Window, measure: Measure) -> Outcome:
    """Structure first, then the fluid on its true motion; no iteration.

    Stability on an absorbing column: α = ρ_f c Δt/(ρ_s t) up to 2, 1.155, 0.709 for prediction of order 0, 1, 2.
    """
    # 1. predict the mean load
    used = c.loads.predict(window)
    # 2. the structure moves under it
    points = c.structure.advance(window, used, final=True)
    # 3. the fluid follows the true motion
    ghosts = c.mapping.motion(points)
    found = c.fluid.advance(window, ghosts, final=True)
    # 4. accept
    return once(c, measure, used, found, points, ghosts)


def parallel_explicit(c: Coupled, window: Window, measure: Measure) -> Outcome:
    """Both sides at once, on predictions of both; no iteration."""
    # 1. predict the mean load, and where the fluid's wall will be
    used = c.loads.predict(window)
    ghosts = carried_on(c.ghosts, c.mapping.motion(c.motions.predict(window)), window)
    # 2. both sides at the same time
    c.structure.begin_advance(window, used, final=True)
    c.fluid.begin_advance(window, ghosts, final=True)
    points, found = c.structure.end_advance(), c.fluid.end_advance()
    # 3. accept
    return once(c, measure, used, found, points, ghosts)


def once(c: Coupled, measure: Measure, used: Loads, found: Loads, points: Kinematics, ghosts: Kinematics) -> Outcome:
    """Accept a window that was taken once."""
    mapped = c.mapping.loads(found, points, ghosts)
    return c.accept(used, found, mapped, points, ghosts, [measure.change(used, mapped)])


def serial_implicit(c: Coupled, window: Window, how: Iteration) -> Outcome:
    """Structure first, then the fluid on its true motion, again and again until the loads agree."""
    # 1. predict the mean load
    used = c.loads.predict(window)
    how.acceleration.begin()
    changes: list[float] = []
    while True:
        # 2. the structure moves under it
        points = c.structure.advance(window.again(len(changes)), used)
        # 3. the fluid follows the true motion
        ghosts = c.mapping.motion(points)
        found = c.fluid.advance(window.again(len(changes)), ghosts)
        # 4. compare the load used with the load found
        mapped = c.mapping.loads(found, points, ghosts)
        changes.append(how.measure.change(used, mapped))
        converged = how.measure.agrees((used,), (mapped,))
        if converged or len(changes) == how.most:
            break
        # 5. a better load; both sides go back
        (used,) = unpack(how.acceleration.next(pack(used), pack(mapped), how.measure.weights(mapped)), mapped)
        both(c, "rollback")
    # 6. accept
    if not converged:
        how.capped(window, changes)
    both(c, "accept")
    return c.accept(used, found, mapped, points, ghosts, changes, converged)


def parallel_implicit(c: Coupled, window: Window, how: Iteration) -> Outcome:
    """Both sides at once, again and again until loads and motions both agree."""
    # 1. predict the mean load and the motion
    used, followed = c.loads.predict(window), c.motions.predict(window)
    how.acceleration.begin()
    changes: list[float] = []
    while True:
        # 2. both sides at the same time
        ghosts = carried_on(c.ghosts, c.mapping.motion(followed), window)
        c.structure.begin_advance(window.again(len(changes)), used)
        c.fluid.begin_advance(window.again(len(changes)), ghosts)
        points, found = c.structure.end_advance(), c.fluid.end_advance()
        # 3. compare loads and motions used with those found
        mapped = c.mapping.loads(found, points, ghosts)
        changes.append(how.measure.change(used, mapped))
        before, after = (used, followed), (mapped, points)
        converged = how.measure.agrees(before, after)
        if converged or len(changes) == how.most:
            break
        # 4. better ones; both sides go back
        better = how.acceleration.next(pack(*before), pack(*after), how.measure.weights(*after))
        used, followed = unpack(better, *after)
        both(c, "rollback")
    # 5. accept
    if not converged:
        how.capped(window, changes)
    both(c, "accept")
    return c.accept(used, found, mapped, points, ghosts, changes, converged)


def both(c: Coupled, verb: str) -> None:
    """Both sides go back, or accept, at the same time."""
    for side in (c.structure, c.fluid):
        getattr(side, f"begin_{verb}")()
    for side in (c.structure, c.fluid):
        getattr(side, f"end_{verb}")()


def probes(c: Coupled) -> Probes | None:
    """Both sides' probes as one row, or None when none is due."""
    due = [side.row for side in (c.structure, c.fluid) if side.row is not None]
    return {name: value for row in due for name, value in row.items()} if due else None
