"""The contract between a participant and the coupler: what is exchanged, and what a model must offer.

One participant is one process, or one object in a test. The verbs, in call order:

    describe → start → ( advance → [rollback → advance …] → accept )* → finish

`Participant` (participant.py) speaks the verbs, watches their order and keeps the books; a physical *model* only
implements `Model` below. Models know nothing of links, files or the coupler.

Exchange per window: kinematics from the structure to the fluid, loads from the fluid to the structure, both per
interface point. All arrays float64, SI, per metre of depth.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Literal, Protocol, runtime_checkable

import numpy as np

CONTRACT_VERSION = 1

Role = Literal["fluid", "structure"]


class ShearwaterError(Exception):
    """An error with one paragraph for the user: what is wrong, where, and the way out. `exit_code` as documented."""

    exit_code = 3


class BadInput(ShearwaterError):
    """The scene or the command line is wrong."""

    exit_code = 2


class SolverFailed(ShearwaterError):
    """A solver diverged or produced a non-finite state."""

    exit_code = 3


class ParticipantLost(ShearwaterError):
    """A participant died or made no progress."""

    exit_code = 4


class OutOfOrder(ShearwaterError):
    """A verb was called before its precondition held."""

    exit_code = 3


@dataclass(frozen=True)
class Kinematics:
    """Motion of n interface points over a window; each array (n, 2).

    `position` [m], `velocity` [m/s] and `acceleration` [m/s²] are at the window's end; `velocity_mean` and
    `acceleration_mean` are over the window. position_end = position_start + Δt · velocity_mean to rounding.
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    velocity_mean: np.ndarray
    acceleration_mean: np.ndarray

    @classmethod
    def at_rest(cls, position: np.ndarray) -> Kinematics:
        """Points that stand still at `position` (n, 2) [m]."""
        zero = np.zeros_like(position)
        return cls(position.copy(), zero, zero.copy(), zero.copy(), zero.copy())


@dataclass(frozen=True)
class Loads:
    """Loads on n interface points: extrapolated ghost `pressure` (n,) [Pa] at the window's end, and `force` (n, 2)
    [N per metre of depth], the mean over the window."""

    pressure: np.ndarray
    force: np.ndarray

    @classmethod
    def zero(cls, count: int) -> Loads:
        """No load on `count` points."""
        return cls(np.zeros(count), np.zeros((count, 2)))


Exchange = Kinematics | Loads


EXCHANGE_FIELDS = {kind: tuple(f.name for f in fields(kind)) for kind in (Kinematics, Loads)}
"""Names of the fields of either kind of exchange, in order."""


GIVES: dict[Role, type[Exchange]] = {"fluid": Loads, "structure": Kinematics}
"""What a participant of either role gives its partner."""
TAKES: dict[Role, type[Exchange]] = {"fluid": Kinematics, "structure": Loads}
"""What it takes of it."""


def exchange_shapes(kind: type[Exchange], count: int) -> dict[str, tuple[int, ...]]:
    """Shapes of the fields of an exchange on `count` points."""
    return {name: (count,) if name == "pressure" else (count, 2) for name in EXCHANGE_FIELDS[kind]}


def exchange_fields(exchange: Exchange) -> dict[str, np.ndarray]:
    """The exchange as named arrays."""
    return {name: getattr(exchange, name) for name in EXCHANGE_FIELDS[type(exchange)]}


@dataclass(frozen=True)
class Description:
    """What a participant says of itself.

    `position` (n, 2) [m]: a structure's interface points, or a fluid's ghosts, in the reference configuration.
    `volume` (n,) [m²]: area each stands for. `body` (n,): index of the scene's solid body it belongs to.
    `spacing` [m]: particle spacing of the side. `numbers`: named scalars that pre-flight and the window choice need
    (fluid: density, sound_speed, support, …; structure: density, thickness, wave_speed, …).
    """

    name: str
    role: Role
    model: str
    stable_step: float
    spacing: float
    position: np.ndarray
    volume: np.ndarray
    body: np.ndarray
    numbers: Mapping[str, float] = field(default_factory=dict)
    contract: int = CONTRACT_VERSION


@dataclass(frozen=True)
class Frame:
    """A snapshot to be written: `position` (n, 2) [m] and point `fields`, each (n,) or (n, 2)."""

    position: np.ndarray
    fields: Mapping[str, np.ndarray]


class Model(Protocol):
    """A physical model of one side. It is stepped in-process by tests and by `Participant` in a run.

    Constructed from the scene: `Model(scene: Scene, coupled: bool, threads: int)`. With `coupled=False` a fluid
    holds the solid bodies still, and a structure has no fluid.

    A model that knows its own data before it is done with the window may offer `advance` in two parts, `reach`, which
    returns the data, and `settle` (see `EarlyModel`); its partner then works while it settles.
    """

    role: Role

    def describe(self) -> Description: ...

    def begin(self, motion: Kinematics | None) -> Exchange:
        """Complete the initial state and return the own data at t = 0. A coupled fluid gets its ghosts' motion."""

    def stable_step(self) -> float:
        """Largest stable time step [s] in the present state."""

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Exchange:
        """Integrate from t0 to t1 [s] in `substeps` equal steps under the partner's data; return the own data."""

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on, as named arrays (views; the caller copies)."""

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Go back to a `state`, bit for bit."""

    def check(self) -> None:
        """Raise SolverFailed, saying where and what, if the state is not finite or not sane."""

    def probe_values(self) -> dict[str, float]:
        """Present values of the scene's probes that belong to this side."""

    def frame(self) -> Frame:
        """Snapshot for output."""

    def particles(self) -> int:
        """Number of particles stepped (fluid: with walls and ghosts), for the cost figures."""

    def steps(self) -> int:
        """Number of time steps taken so far (rolled-back ones included)."""


@runtime_checkable
class EarlyModel(Model, Protocol):
    """A model whose `advance` is `reach` and then `settle`."""

    def reach(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Exchange:
        """As `advance`, but what the own data do not depend on; until `settle`, only `restore` and `check` may be
        called."""

    def settle(self) -> None:
        """Do the rest of `advance`."""


@runtime_checkable
class LeakyModel(Model, Protocol):
    """A model that gives up what leaves its domain."""

    def losses(self) -> dict[str, object]:
        """`lost`: number of particles that have left since t = 0; `lost_fraction`: of those that may; `lost_near`
        [m]: a place where one of the first did, if any has. For the cost figures."""
