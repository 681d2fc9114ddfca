"""Stepping the updated-Lagrangian solid: neighbour lists that are made anew, and shifting, as the pairs call for it.

The sweeps are in updated_steps.py, the shift in shifting.py.
"""

from __future__ import annotations

import math

import numpy as np

from solid_solver.shifting import NEEDED, shift
from solid_solver.updated_fields import X, Y
from solid_solver.updated_start import Start
from solid_solver.updated_steps import CROWDED, NEAREST2, OUTGROWN, needs, steps


class Stepper:
    """Steps of the state in `start`. `blocks`: the lists of neighbours; `listed_at` (2, slots): the places that they
    were made for; `gauge`: see updated_steps.py."""

    def __init__(self, start: Start, shifting: bool, viscosity: float, moduli: tuple[float, float, float, float]):
        self._s, self._moduli = start, moduli
        self._viscosity = viscosity
        self._heeded = OUTGROWN | CROWDED if shifting else OUTGROWN
        self.gauge = np.stack([start.spacing**-2.0, np.full(len(start.spacing), math.inf)])
        self.list_pairs(start.S[X : Y + 1])

    def closest(self) -> float:
        """Least distance of a particle to its nearest one, over the spacing, at the last look."""
        return math.sqrt(self.gauge[NEAREST2, self._s.storage.free].min())

    def take(self, places: np.ndarray, loads: tuple, dt: float, kick: tuple[float, float]) -> None:
        """Advance by all sub-steps, listing pairs and shifting in between as needed."""
        s = self._s
        held = s.storage.held, places
        corrected = None if s.order == 2 else float(s.order)
        done = 0
        while done < len(places) - 1:
            found = needs(self.blocks, s.S, *self._watch)
            if found & OUTGROWN:
                self.list_pairs(s.S[X : Y + 1])
            if found & self._heeded & CROWDED:
                shift(s.S, self.blocks, s.spacing, s.curvature, *self._kernel)
            numbers, watch = (dt, self._viscosity, self._moduli, done), (*self._watch, self._heeded)
            done = steps(s.S, self.blocks, watch, self._kernel, held, loads, kick, numbers, corrected)

    def list_pairs(self, at: np.ndarray) -> None:
        """Make the lists of neighbours for places `at` (2, slots)."""
        s = self._s
        spacing = min(float(b.spacing.min()) for b in s.bodies)
        self.blocks = s.storage.blocks(at, s.kernel.support * s.h, spacing)
        self.listed_at = at.copy()
        self._closest = np.zeros(len(self.blocks.start))
        self.look()

    def look(self) -> None:
        """Note how close the particles are."""
        needs(self.blocks, self._s.S, *self._watch)

    @property
    def _kernel(self) -> tuple[int, float]:
        return self._s.kernel.code, self._s.h

    @property
    def _watch(self) -> tuple:
        return self.gauge, self._closest, self._s.kernel.support * self._s.h, NEEDED[self._s.order]
