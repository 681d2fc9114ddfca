"""The ledger: what crossed the interface in each accepted window, on both sides.

Per window, with F̄ the mean forces, Δx the windows' displacements:

    impulse on the ghosts   I_f = Σ_g F̄_g Δt          (what the fluid gave)
    impulse on the points   I_s = Σ_s F̂_s Δt          (what the structure took: the predicted load)
    work of the structure   W_s = Σ_s F̂_s · Δx_s
    work of the fluid       W_f = −Σ_g F̄_g · Δx_g
    lag energy              running sum of W_s + W_f   (what the one-window lag creates)
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from shared.clock import Window
from shared.contract import Kinematics, Loads

COLUMNS = (
    "window",
    "t",
    "iterations",
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


class Ledger:
    """Writes `ledger.csv`, one row per accepted window, and keeps the sums."""

    def __init__(self, path: Path):
        self._file = path.open("w", newline="")
        self._writer = csv.writer(self._file)
        self._writer.writerow(COLUMNS)
        self._impulse_fluid = np.zeros(2)
        self._impulse_structure = np.zeros(2)
        self._work = 0.0
        self._work_fluid = 0.0
        self._largest_work = 0.0
        self._largest_impulse = 0.0
        self._mapping_error = 0.0

    def record(
        self,
        window: Window,
        iterations: int,
        used: Loads,
        mapped: Loads,
        found: Loads,
        points: tuple[Kinematics, Kinematics],
        ghosts: tuple[Kinematics, Kinematics],
    ) -> None:
        """One accepted window.

        `used`: loads on the points under which the structure moved; `found`: loads on the ghosts that the fluid
        answered with; `mapped`: these on the points. `points`, `ghosts`: motion at the window's start and end.
        """
        forces = [loads.force.sum(axis=0) for loads in (found, mapped, used)]
        self._impulse_fluid += forces[0] * window.length
        self._impulse_structure += forces[2] * window.length
        self._work += float(np.sum(used.force * (points[1].position - points[0].position)))
        self._work_fluid -= float(np.sum(found.force * (ghosts[1].position - ghosts[0].position)))
        self._largest_work = max(self._largest_work, abs(self._work))
        self._largest_impulse = max(self._largest_impulse, float(np.linalg.norm(self._impulse_fluid)))
        scale = float(np.abs(found.force).sum())
        if scale > 0.0:
            self._mapping_error = max(self._mapping_error, float(np.abs(forces[0] - forces[1]).max()) / scale)
        sums = [*self._impulse_fluid, *self._impulse_structure]
        work = [self._work, self._work_fluid, self._work + self._work_fluid]
        row = [window.index, window.t1, iterations, *(c for f in forces for c in f), *sums, *work]
        self._writer.writerow([repr(float(v)) if isinstance(v, float) else v for v in row])

    def summary(self) -> dict[str, float]:
        """The sums as fractions.

        `impulse_error`: impulses' difference over the largest impulse; `work_error`: lag energy over the largest work
        done on the structure, which is also `energy_injected_fraction` when positive; `mapping_error`: largest
        difference between the fluid's total force and the mapped total, over the sum of the forces' sizes.
        """
        impulse = float(np.linalg.norm(self._impulse_structure - self._impulse_fluid))
        lag = self._work + self._work_fluid
        scale = self._largest_work or 1.0
        return {
            "impulse_error": impulse / (self._largest_impulse or 1.0),
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
