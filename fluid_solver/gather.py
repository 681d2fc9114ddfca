"""The candidates of a stretch of cells in one buffer, and the runs of them that a cell's particles visit.

A sweep works through segments of rows. It copies the three rows around a segment into one contiguous buffer, column by
column, closed by far-away dummies of no mass. The candidates of a cell are then one run of it, 2 `COLUMNS` + 1 columns
long, and each particle of the cell runs over them without branches, in whole vectors: that vectorises, which walking
the cells does not. A run may end beyond its last column: what stands there is out of reach and adds nothing.
"""

from __future__ import annotations

import numpy as np

from fluid_solver.cells import COLUMNS, neighbour, segment_columns
from shared.jit import inline_njit, njit, one_more

LANES = 8  # float64 per vector register (AVX-512); shorter registers divide it
FAR = 1.0e12  # m; where the dummies stand
_NOT_NEGATIVE = 2**62 - 1


@inline_njit
def copy_run(source, lo, hi, target, n):
    """target[n:] = source[lo:hi], in whole vectors: up to LANES − 1 values more are copied, to be overwritten.

    Eight loads before eight stores become one vector each; the compiler's own loop for so short a run costs more than
    the physics. Indices are masked so that the compiler knows them not to be negative.
    """
    for k in range(0, hi - lo, LANES):
        i = (lo + k) & _NOT_NEGATIVE
        j = (n + k) & _NOT_NEGATIVE
        v0, v1, v2, v3 = source[i], source[i + 1], source[i + 2], source[i + 3]
        v4, v5, v6, v7 = source[i + 4], source[i + 5], source[i + 6], source[i + 7]
        target[j], target[j + 1], target[j + 2], target[j + 3] = v0, v1, v2, v3
        target[j + 4], target[j + 5], target[j + 6], target[j + 7] = v4, v5, v6, v7


@njit
def with_targets(start, grid, segment, kind):
    """Row of a segment that has targets, and its columns [first, last) from the first with targets to the last.

    `kind`: 0 where fluid is looked for, 1 for ghosts.
    """
    row, first, last = segment_columns(grid, segment)
    of_row = row * grid.columns
    while start[2 * (of_row + first) + kind] == start[2 * (of_row + first) + kind + 1]:
        first += 1
    while start[2 * (of_row + last - 1) + kind] == start[2 * (of_row + last - 1) + kind + 1]:
        last -= 1
    return row, first, last


@njit
def next_stretch(start, grid, kind, segments, shares, taken, worker):
    """Row and columns [first, last) of the next stretch with targets of `kind` for a `worker`; first = last when none
    is left.

    A worker goes through its own share of the `segments`, whose particles it has near, and then helps the others with
    what is left of theirs: one that is held up holds up nothing but its own segment. `taken` (workers,): how many of
    each share are taken, none at the start of a sweep. Who works through a segment must not matter to the result.
    """
    for k in range(taken.size):
        owner = (worker + k) % taken.size
        at = shares[owner] + one_more(taken, owner)
        if at < shares[owner + 1]:
            return with_targets(start, grid, segments[at], kind)
    return 0, 0, 0


@njit
def gather(S, rows, kinds, start, grid, row, first, last, buffer, columns):
    """Copy `rows` (x and y first) of all candidates of the columns [first, last) of `row` into `buffer`.

    `kinds`: 1 for the fluid alone, 2 for fluid and ghosts. `columns`: where each column begins in the buffer, from
    `COLUMNS` before the first on.
    """
    n = 0
    for column in range(first - COLUMNS, last + COLUMNS):
        columns[column - first + COLUMNS] = n
        for j in range(-1, 2):
            cell, x, y = neighbour(grid, column, row + j)
            lo = start[2 * cell]
            hi = start[2 * cell + kinds]
            for f in range(len(rows)):
                copy_run(S[rows[f]], lo, hi, buffer[f], n)
            if x != 0.0 or y != 0.0:
                for k in range(n, n + hi - lo):
                    buffer[0, k] += x
                    buffer[1, k] += y
            n += hi - lo
    columns[last - first + 2 * COLUMNS] = n
    for k in range(n, n + LANES):
        buffer[0, k] = FAR
        buffer[1, k] = FAR
        for f in range(2, len(rows)):
            buffer[f, k] = 0.0


@inline_njit
def run_of(columns, column):
    """Bounds in the buffer of the candidates of the `column`-th column gathered, in whole vectors.

    Unsigned, so that the compiler knows that no index is negative: else no loop over them would vectorise.
    """
    lo = columns[column]
    n = (columns[column + 2 * COLUMNS + 1] - lo + LANES - 1) & ~(LANES - 1)
    return np.uint64(lo), np.uint64(lo + n)
