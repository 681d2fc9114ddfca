"""Where a step's time goes, and how near its sweeps come to what the machine can do.

A particle of a cell visits all candidates of the three rows and five columns around it: two fifths of them lie within
the support; the others are the price of loops without branches, in whole vectors. Each visit takes one square root in
either sweep. Roots pass one by one through a unit that does nothing else, eight of them in 16 to 20 cycles: they are
four fifths of the sweep of rates and half of that of forces, while additions and products, of which the peak is made,
fill a third of their slots.

Tried without gain on three machines, of 57, 65 and 66 GFLOP/s multiply-add per core: three or four columns per support
(fewer candidates in shorter runs); rows half as high and columns half as wide (41 candidates in place of 54, but the
copying takes 40 ns a particle in place of 10, for the cells are so many); sorting keys on two threads, gathering field
by field, 512-bit registers, also with loops that the compiler does not interleave; roots by way of float32 (in 512-bit
registers they take a quarter off the rates of wcsph and nothing off ctvf, for seven digits in place of sixteen; with a
Newton step that brings the digits back they gain nothing), or guessed from the bits with Newton's, Householder's or
Goldschmidt's steps: a root alone takes a third of the time, but the sweep does not, for its chain of products is too
long for the scheduler to overlap. What a division was, in artificial viscosity, is such a guess (terms.inverse): there
the chain is short. Not tried, for order in time would be lost: rates and forces in one sweep.
"""

from __future__ import annotations

import time

import numpy as np

from fluid_solver.cells import COLUMNS
from fluid_solver.sweeps import Sweeps

OPERATIONS = {"wcsph": {"rates": 21, "forces": 36}, "ctvf": {"rates": 35, "forces": 61}}
"""Floating-point operations per candidate, a root counted as one, by hand from terms.py and kernels.py."""
_SWEEPS = ("ghosts' velocities", "rates", "ghosts' pressures and forces", "forces")  # in the order of `Sweeps`


def stages(fluid, dt: float, steps: int) -> dict[str, float]:
    """Core seconds per step of every stage of a `ParticleFluid` under way, over `steps` steps of `dt` [s]."""
    spent = dict.fromkeys([*_SWEEPS, "cell sort"], 0.0)
    sweeps = fluid.sweeps
    fluid.sweeps = Sweeps(*(_timed(sweep, spent, stage) for sweep, stage in zip(sweeps, _SWEEPS, strict=True)))
    fluid.store.sort = _timed(fluid.store.sort, spent, "cell sort")  # of this one store
    begun = time.process_time()
    fluid.advance(0.0, steps * dt, steps, None)
    whole = time.process_time() - begun
    fluid.sweeps = sweeps
    del fluid.store.sort
    spent["kicks, drifts, the rest"] = whole - sum(spent.values())
    return {stage: seconds / steps for stage, seconds in spent.items()}


def _timed(call, spent: dict[str, float], stage: str):
    def timed(*arguments):
        begun = time.process_time()
        call(*arguments)
        spent[stage] += time.process_time() - begun

    return timed


def candidates(store) -> float:
    """Candidates that a fluid particle visits in a sweep, on average."""
    shape = store.grid.rows, store.grid.columns
    starts = store.start[: 2 * shape[0] * shape[1] + 1]
    counts = (starts[1::2] - starts[:-1:2]).reshape(shape)
    everything = (starts[2::2] - starts[:-1:2]).reshape(shape)
    rows = sum(np.roll(everything, k, axis=0) for k in (-1, 0, 1))
    around = sum(np.roll(rows, k, axis=1) for k in range(-COLUMNS, COLUMNS + 1))
    return float(np.sum(counts * around) / np.sum(counts))
