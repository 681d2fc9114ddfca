"""The ledger: what crossed the interface in each accepted window, on both sides.

Per window, with F̄ the mean forces, Δx the windows' displacements:

    impulse on the ghosts   I_f = Σ_g F̄_g Δt          (what the fluid gave)
    impulse on the points   I_s = Σ_s F̂_s Δt          (what the structure took: the predicted load)
    work of the structure   W_s = Σ_s F̂_s · Δx_s
    work of the fluid       W_f = −Σ_g F̄_g · Δx_g
    lag energy              running sum of W_s + W_f   (what the one-window lag creates)

Each is judged against the size of what is exchanged, never against a net that may cancel: impulses against Σ |F̄_g| Δt,
energy against the largest work, and no less than the work of rounding, Σ |F̂_s| ε |x_s|. A structure whose motion is
prescribed takes no load, so that nothing lags: of its exchange only the map is judged.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np

from coupler.schemes import Outcome
from shared.clock import Window
from shared.contract import ShearwaterError, SolverFailed
from shared.run.checkpoint import State
from shared.run.lines import Lines
from shared.schema.coupling import Limits

COLUMNS = (
    "window",
    "t",
    "iterations",
    "change",
    "force_fluid_x",
    "force_fluid_y",
    "force_mapped_x",
    "force_mapped_y",
    "force_structure_x",
    "force_structure_y",
    "impulse_fluid_x",
    "impulse_fluid_y",
    "impulse_structure_x",
    "impulse_structure_y",
    "work_structure",
    "work_fluid",
    "lag_energy",
)


_SUMS = (
    "past",
    "warm",
    "impulse_fluid",
    "impulse_structure",
    "work",
    "work_fluid",
    "excused",
    "largest_work",
    "turned_over",
    "rounding",
    "exchanged",
    "mapping_error",
)
_PATIENCE = 20
"""Windows in a row past a limit that stop the run: in the first windows, and when water hits, lag is all there is."""
_ROUNDING = 10.0 * float(np.finfo(float).eps)
"""Of a point's distance from the origin: what its displacement may be off by, two places and the map between."""
_WARM = 0.5
"""Of the energy limit, past which lag is worth a warning."""
_WARM_FOR = 40
"""Windows in a row past it before the warning. Measured: 8 to 19 where water first strikes dam_break_plate."""
_WAYS_OUT = {
    "energy": (
        "Energy is made or lost at the interface: the window is too long for this water and this structure. Set "
        'coupling.scheme = "serial-implicit", shorten coupling.window'
    ),
    "impulse": (
        "The structure takes another impulse than the water gives: the load used lags behind the load found. Shorten "
        'coupling.window, set coupling.scheme = "serial-implicit"'
    ),
    "mapping": "The map between the two sides loses force, which it must not: check solid.dx and fluid.dx",
}


class LedgerExceeded(SolverFailed):
    """What crossed the interface no longer balances; the text says what, by how much, and the way out."""


class Ledger:
    """Writes `ledger.csv`, one row per accepted window, and keeps the sums; stops the run past a limit.

    `rows`: go on with the file that is there, behind this many rows. `prescribed`: whether the structure moves as it
    was told, whatever its load.
    """

    def __init__(self, path: Path, limits: Limits, rows: int | None = None, prescribed: bool = False):
        self._limits = limits
        self._prescribed = prescribed
        self._past = 0
        self._warm = 0
        self._file = _open(path, rows)
        self._impulse_fluid = np.zeros(2)
        self._impulse_structure = np.zeros(2)
        self._work = 0.0
        self._work_fluid = 0.0
        self._excused = 0.0  # energy that lag made before the exchange was iterated
        self._largest_work = 0.0
        self._turned_over = 0.0  # sum of the sizes of the windows' work
        self._rounding = float(np.finfo(float).tiny)  # work that may be rounding alone
        self._exchanged = float(np.finfo(float).tiny)  # sum of the sizes of the windows' impulses
        self._mapping_error = 0.0
        self._growing = False  # the largest work, in the last window

    def state(self) -> State:
        """The sums, and how long they have been past their limits."""
        return {name: np.array(getattr(self, f"_{name}")) for name in _SUMS}

    def restore(self, state: State) -> None:
        """Go back to a `state`."""
        for name in _SUMS:
            value = state[name]
            setattr(self, f"_{name}", value if value.ndim else value.item())

    def record(self, window: Window, outcome: Outcome) -> str:
        """One accepted window; returns a warning once energy is well on its way to its limit. Raises LedgerExceeded
        past a limit."""
        used, found, mapped = outcome.used, outcome.found, outcome.mapped
        given, passed, taken = (_ones(len(loads.force)) @ loads.force for loads in (found, mapped, used))
        self._impulse_fluid += given * window.length
        self._impulse_structure += taken * window.length
        (points0, points1), (ghosts0, ghosts1) = outcome.points, outcome.ghosts
        self._work += float(np.vdot(used.force, points1.position - points0.position))
        turned = float(np.vdot(found.force, ghosts1.position - ghosts0.position))
        self._work_fluid -= turned
        self._turned_over += abs(turned)
        self._last, before = window, self._largest_work
        self._largest_work = max(before, abs(self._work), abs(self._work_fluid))
        self._growing = self._largest_work > before
        self._rounding += _ROUNDING * float(np.vdot(np.abs(used.force), np.abs(points1.position)))
        scale = float(np.abs(found.force).sum())
        self._exchanged += scale * window.length
        numbers = [*given.tolist(), *passed.tolist(), *taken.tolist()]
        lost = max(abs(numbers[0] - numbers[2]), abs(numbers[1] - numbers[3]))
        self._mapping_error = max(self._mapping_error, lost / scale if scale > 0.0 else 0.0)
        numbers += [*self._impulse_fluid.tolist(), *self._impulse_structure.tolist()]
        numbers += [self._work, self._work_fluid, self._work + self._work_fluid]
        head = f"{window.index},{window.t1!r},{len(outcome.changes)},{outcome.changes[-1]!r},"
        self._file.write(head + ",".join(map(repr, numbers)))
        self._check()
        warm = not self._prescribed and self._energy() > _WARM * self._limits.energy
        self._warm = self._warm + 1 if warm else 0
        share = (self._work + self._work_fluid) / max(self._largest_work, self._rounding)
        return f"lag has made {share:+.0%} of the work at the interface" if self._warm == _WARM_FOR else ""

    def excuse(self) -> None:
        """Count energy from now on: what made it so far has been changed."""
        self._excused, self._past, self._warm = self._work + self._work_fluid, 0, 0

    def _energy(self) -> float:
        """Energy that lag has made over the largest work, or lost over all the work turned over.

        What is made feeds on itself, and counts beside what there is. What is lost comes of loads that change from
        window to window, pressure's noise among them, and never ends: a stiff wall loses more than it ever holds.
        """
        lag = self._work + self._work_fluid - self._excused
        if lag >= 0.0:
            return lag / max(self._largest_work, self._rounding)
        return 0.0 if self._growing else -lag / max(self._turned_over, self._rounding)

    def _impulse(self) -> float:
        """Difference of the impulses given and taken, over all that was exchanged."""
        return math.hypot(*(self._impulse_structure - self._impulse_fluid)) / self._exchanged

    def _check(self) -> None:
        """Energy and impulse count once they stay past their limits; force lost by the map counts at once."""
        past = self._past_limits()
        self._past = self._past + 1 if past else 0
        if self._past >= _PATIENCE or "mapping" in past:
            raise LedgerExceeded(self._complaint(past))

    def _past_limits(self) -> dict[str, float]:
        """What is past its limit, and by how much; force lost by the map first."""
        found = {"mapping": self._mapping_error}
        if not self._prescribed:
            found |= {"energy": self._energy(), "impulse": self._impulse()}
        return {name: value for name, value in found.items() if not value <= getattr(self._limits, name)}

    def _complaint(self, past: dict[str, float]) -> str:
        name, value = next(iter(past.items()))
        return (
            f"the ledger is past its limit in window {self._last.index}, t = {self._last.t1:.6g} s: {name} "
            f"{value:.3g}, coupling.limits.{name} = {getattr(self._limits, name):g}. {_WAYS_OUT[name]} "
            "or raise the limit if this is meant."
        )

    def explained(self, error: ShearwaterError) -> ShearwaterError:
        """What to tell where a side failed with `error`: the ledger's complaint first, if it had one already; a side
        that lag throws about fails for reasons of its own, which lead nowhere."""
        past = self._past_limits()
        return LedgerExceeded(f"{self._complaint(past)} Then a side failed: {error}") if past else error

    def summary(self) -> dict[str, float]:
        """The sums as fractions.

        `impulse_error`: impulses' difference over all that was exchanged; `work_error`: lag energy over the largest
        work done on the structure, which is also `energy_injected_fraction` when positive; `mapping_error`: largest
        difference between the fluid's total force and the mapped total, over the sum of the forces' sizes.
        """
        lag = self._work + self._work_fluid
        scale = max(self._largest_work, self._rounding)
        return {
            "impulse_error": self._impulse(),
            "work_error": lag / scale,
            "energy_injected_fraction": max(lag, 0.0) / scale,
            "mapping_error": self._mapping_error,
        }

    def flush(self) -> None:
        """Write the rows so far to the disk."""
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


@cache
def _ones(count: int) -> np.ndarray:
    """What sums forces up: a product with it is quicker than a sum along the points."""
    return np.ones(count)


def _open(path: Path, rows: int | None) -> Lines:
    """The file, new with its header, or as it was after `rows` rows."""
    if rows is not None:
        return Lines(path, 1 + rows)
    file = Lines(path)
    file.write(",".join(COLUMNS))
    return file
