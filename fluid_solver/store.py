"""The particles of a fluid run in memory: state array, order, cells and buffers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fluid_solver.cells import (
    BLOCK,
    COLUMNS,
    MAX_CELLS,
    SEGMENT,
    Grid,
    count_cells,
    find_cells,
    list_segments,
    mark_rows,
    park_and_bound,
    permute,
    pick,
    place_rows,
    segments_per_row,
    wrap,
)
from fluid_solver.fields import WORK_ROWS
from fluid_solver.gather import LANES
from shared.contract import SolverFailed

BUFFER_ROWS = 12  # the widest sweep's rows
_SKIN = 0.04  # of the support: cells may stay as they are while particles move half of it
_CROWDED = 1.25  # room in a buffer over the candidates met
_FASTER = 1.1  # speed that a ghost may reach within a step, over what it has
_ALIKE = 1e-6  # two steps whose lengths differ by less are of one length: they come from a clock's two times


class Store:
    """State `S` (ROWS, n), `kind` and `ids` (n,) in cell order; the first `count` take part, parked ones follow.

    `start`, `grid`: the cells (see cells.py); `segments`: those with fluid, and those with ghosts; `shares`: where each
    thread's share of either begins; `buffers`: candidates of a segment, one per thread; `work`: results of a sweep;
    `speeds`: per-block maxima; `fastest`: largest relative speed that each thread met, squared [m²/s²]; `clipped`:
    per-block impulse of the tension taken off [N s/m].
    """

    def __init__(
        self,
        S: np.ndarray,
        kind: np.ndarray,
        support: float,
        domain: np.ndarray,
        period: np.ndarray,
        threads: int = 1,
        unused: tuple[int, ...] = (),
    ):
        n = S.shape[1]
        self._carried = np.setdiff1d(np.arange(S.shape[0]), unused)
        self.S, self.kind, self.ids = _with_slack(S), kind.astype(np.int8), np.arange(n)
        self._spare = _with_slack(S), np.empty_like(self.kind), np.empty_like(self.ids)
        self._key, self._rank, self._order = (np.empty(n, dtype=np.int32) for _ in range(3))
        self._found, self._spans = np.empty((5, n // BLOCK + 1)), np.empty((n // BLOCK + 1, 2), dtype=np.int64)
        self._cells, self._places = np.zeros(2, dtype=np.int32), np.zeros(0, dtype=np.int32)
        self._support, self._domain, self.period = support, domain, period
        self.work = np.zeros((WORK_ROWS, n))
        self.speeds = np.empty((2, n // BLOCK + 1))
        self.clipped = np.zeros(n // BLOCK + 1)
        self.fastest = np.zeros(threads)
        self.segments = np.zeros((2, 0), dtype=np.int32)
        self.shares = np.zeros((2, threads + 1), dtype=np.int64)
        self.buffers = np.empty((threads, BUFFER_ROWS, LANES))
        # where the columns of a segment begin in its buffer
        self._columns = np.zeros((threads, SEGMENT + 2 * COLUMNS + 1), dtype=np.int64)
        self._taken = np.zeros(threads, dtype=np.int64)  # segments under way, of each share
        self.start, self.count, self.parked = self._cells, n, 0
        self.grid = Grid(0, 0, *(float(length) for length in period[:, 1] - period[:, 0]))
        # m; how far fluid, and ghosts, are at most from where they were sorted to; below zero on the way there
        self._moved = np.zeros(2)
        self._skin = 0.0  # m; twice what they may be
        self._laid_for = 0.0  # s; length of the step that the cells were laid for before it began

    def move(self, dt: float, fluid: float, ghosts: float) -> None:
        """Count `dt` [s] of motion, in which no fluid and no ghosts were faster than this [m/s]."""
        self._moved += dt * np.array([fluid, ghosts])

    def sort_ahead(self, dt: float, fluid: float, ghosts: float) -> None:
        """Before a step of `dt` [s], sort unless the cells hold to its end. Ghosts may get a little faster.

        Where there is a period, fluid is not sorted to where it will be, so that it is left to the middle of the step.
        """
        if not self.period.any() and self._outlived(dt, fluid, ghosts):
            self.sort(0.5 * dt, dt, fluid, _FASTER * ghosts, 0.5 * dt)
            self._laid_for = dt

    def sort_midway(self, dt: float, fluid: float, ghosts: float) -> None:
        """In the middle of a step of `dt` [s], sort unless the cells hold to its end."""
        foreseen = self._laid_for == 0.0 or abs(dt - self._laid_for) < _ALIKE * dt
        self._laid_for = 0.0
        if not foreseen or self.grid.columns == 0 or self._outlived(0.5 * dt, fluid, ghosts):
            self.sort(0.0, 0.5 * dt, fluid, ghosts)

    def _outlived(self, ahead: float, fluid: float, ghosts: float) -> bool:
        """Whether the cells do not hold for a time `ahead` [s] more."""
        return bool(2.0 * np.max(self._moved + ahead * np.array([fluid, ghosts])) > self._skin)

    def sort(
        self, first: float = 0.0, last: float = 0.0, fluid: float = 0.0, ghosts: float = 0.0, kick: float = 0.0
    ) -> None:
        """Sort all particles by cell, for sweeps from `first` to `last` [s] from now; takes those out of the domain out
        of all loops.

        Until then no fluid is faster than `fluid`, no ghost than `ghosts` [m/s], and fluid moves with the velocity that
        it has after a `kick` [s] of its acceleration. Fluid is sorted to where it will be in the middle of that time,
        from which it is half as far off at either end: fast drops make all cells wider, and what visits them slower.
        """
        S, kind, count = self.S, self.kind, self.count
        wrap(S, count, self.period)
        park_and_bound(S, kind, count, self._domain, self._found)
        found = self._found[:, : (count + BLOCK - 1) // BLOCK]
        self.parked += int(found[4].sum())
        x0, y0, x1, y1 = found[:4].min(axis=1) * (1.0, 1.0, -1.0, -1.0)
        lead = 0.5 * (first + last) if not self.period.any() else 0.0  # else from one end of the period to the other
        off = max((last - lead) * fluid, last * ghosts)
        self._skin = max(_SKIN * self._support, 2.0 * (1.0 + _ALIKE) * off)
        margin = lead * fluid
        origin, inv_cell, size = self._measure(np.array([[x0 - margin, x1 + margin], [y0 - margin, y1 + margin]]))
        places = self._places[: size[1]]
        places[:] = 0
        mark_rows(S, kind, count, lead, kick, origin, inv_cell, places)
        self._lay_cells(size[0], place_rows(places, self.grid.period_y > 0.0))
        last = len(self.start) - 2
        find_cells(S, kind, count, lead, kick, origin, inv_cell, self.grid, places, self._key, last, self._spans)
        count_cells(self._key, count, self._spans, self.start, self._rank, self._order)
        S2, kind2, ids2 = self._spare
        permute(S, self._carried, kind, self.ids, self._order, count, S2, kind2, ids2)
        self._spare = S, kind, self.ids
        self.S, self.kind, self.ids = S2, kind2, ids2
        self.count = int(self.start[-2])
        self._moved = np.array([-lead * fluid, 0.0])
        self._share()

    def _measure(self, box: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[int, int]]:
        """Cells over `box` (2, 2), lower and upper bound [m] along x and y; periods instead where given.

        Returns the corner (2,) [m] of the first cell, one over the cells' size (2,) [1/m], and the numbers of columns
        and rows.
        """
        if box[0, 0] > box[0, 1]:
            raise SolverFailed(
                "all fluid has left the domain, and the scene has no walls: nothing is left to compute. "
                "Shorten end_time, or make domain larger."
            )
        length = self.period[:, 1] - self.period[:, 0]
        periodic = length > 0.0
        box = np.where(periodic[:, None], self.period, box)
        width = self._support + self._skin
        tiles = np.maximum(1.0, np.floor(length / width))
        parts = np.array([float(COLUMNS), 1.0])  # cells in a width
        inv_cell = parts * np.where(periodic, tiles / np.where(periodic, length, 1.0), 1.0 / width)
        inside = np.where(periodic, parts * tiles, np.floor((box[:, 1] - box[:, 0]) * inv_cell) + 1.0)
        size = inside + 2.0 * parts
        if not size[0] * size[1] < MAX_CELLS:
            raise SolverFailed(
                f"the particles spread from ({box[0, 0]:.4g}, {box[1, 0]:.4g}) to ({box[0, 1]:.4g}, {box[1, 1]:.4g}) m,"
                f" too far for cells of {width:.3g} m: a body or wall has run away, or dx is too small for the scene"
            )
        if size[1] > self._places.size:
            self._places = np.empty(int(_CROWDED * size[1]), dtype=np.int32)
        return box[:, 0].copy(), inv_cell, (int(size[0]), int(size[1]))

    def _lay_cells(self, columns: int, rows: int) -> None:
        """Make room for the starts of all cells."""
        self.grid = self.grid._replace(columns=columns, rows=rows)
        cells = 2 * self.grid.columns * self.grid.rows + 2
        if cells > self._cells.size:
            self._cells = np.empty(int(_CROWDED * cells), dtype=np.int32)
        self.start = self._cells[:cells]

    def _share(self) -> None:
        segments = (self.grid.rows - 2) * segments_per_row(self.grid)
        if segments > self.segments.shape[1]:
            self.segments = np.empty((2, int(_CROWDED * segments)), dtype=np.int32)
        most = list_segments(self.start, self.grid, self.segments, self.shares)
        if most + 2 * LANES > self.buffers.shape[2]:
            room = int(_CROWDED * most / LANES + 3) * LANES
            self.buffers = np.empty((len(self.buffers), BUFFER_ROWS, room))

    def cells(self, kind: int = 0) -> tuple:
        """What a sweep over fluid (`kind` 0) or ghosts (1) needs: start, grid, segments, shares, taken, buffers,
        columns."""
        self._taken[:] = 0
        lists = self.segments[kind], self.shares[kind]
        return self.start, self.grid, *lists, self._taken, self.buffers, self._columns

    def nbytes(self) -> int:
        """Bytes of the arrays that a step works on."""
        arrays = [value for value in vars(self).values() if isinstance(value, np.ndarray) and value is not self.start]
        return sum(array.nbytes for array in [*arrays, *self._spare])

    def in_order_of_ids(self, rows, first: int, last: int) -> np.ndarray:
        """Rows of the state, (len(rows), last − first), of the particles with ids in [first, last), by id."""
        out = np.empty((len(rows), last - first))
        pick(self.S, np.array(rows), self.ids, first, last, out)
        return out

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on."""
        return {
            "S": self.S,
            "kind": self.kind,
            "ids": self.ids,
            "start": self.start,
            "cells": np.array([self.grid.columns, self.grid.rows, self.count, self.parked]),
            "skin": np.array([*self._moved, self._skin, self._laid_for]),
            "clipped": self.clipped,
            "fastest": self.fastest.max(keepdims=True),
        }

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Back to a `state`, bit for bit."""
        self.S[...], self.kind[...], self.ids[...] = state["S"], state["kind"], state["ids"]
        self._cells = np.array(state["start"], dtype=np.int32)
        self.start = self._cells
        columns, rows, self.count, self.parked = (int(k) for k in state["cells"])
        self.grid = self.grid._replace(columns=columns, rows=rows)
        *moved, self._skin, self._laid_for = (float(k) for k in state["skin"])
        self._moved = np.array(moved)
        self.clipped[...], self.fastest[...] = state["clipped"], state["fastest"]
        self._share()


def _with_slack(S: np.ndarray) -> np.ndarray:
    """A copy of S with a spare row of memory after it: whole vectors are read past the end of a row."""
    slack = np.zeros((S.shape[0] + 1, S.shape[1]))
    padded = slack[: S.shape[0], : S.shape[1]]
    padded[...] = S
    return padded
