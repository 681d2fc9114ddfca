"""Cell sort, and the candidates of a cell.

Particles are counting-sorted by cell, row of cells by row, in each cell fluid before ghosts. Cell c holds
[start[2c], start[2c + 1]) fluid and [start[2c + 1], start[2c + 2]) ghosts; one ring of empty cells surrounds all.
Everything within the kernel's support of a particle lies in the 3 × 3 cells around its own, as long as no particle
has moved more than half the skin since the sort: cells are support + skin wide.

In a periodic direction cells tile the period exactly, a little wider than that. A cell at its edge finds its
neighbours at the other edge, and sees them shifted by the period. Positions are wrapped at the sort and may leave the
period by half the skin in between.

A sweep copies the candidates of a cell once into small contiguous rows, padded with far-away dummies of no mass to
a multiple of the vector width, and runs each particle of the cell over them without branches: that vectorises,
which walking the cells directly does not.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fluid_solver.fields import FLUID, PARKED, X, Y
from shared.jit import inline_njit, njit, parallel_njit

LANES = 8  # float64 per vector register (AVX-512); shorter registers divide it
FAR = 1.0e12  # m; where the dummies stand
BLOCK = 4096  # particles per task of an elementwise loop
CHUNKS = 48  # tasks of a sweep; fixed, so that nothing depends on the thread count
MAX_CELLS = 4_000_000
_NOT_NEGATIVE = 2**62 - 1


class Grid(NamedTuple):
    """Cells in rows of `columns`, the empty ring counted; period [m] along x and y, 0 for none."""

    columns: int
    rows: int
    period_x: float
    period_y: float


@njit
def bounds(S, kind, count):
    """Bounding box (x0, y0, x1, y1) [m] of the first `count` particles, less the parked ones."""
    x0 = y0 = np.inf
    x1 = y1 = -np.inf
    for i in range(count):
        if kind[i] != PARKED:
            x0 = min(x0, S[X, i])
            x1 = max(x1, S[X, i])
            y0 = min(y0, S[Y, i])
            y1 = max(y1, S[Y, i])
    return x0, y0, x1, y1


@njit
def park(S, kind, count, domain):
    """Mark fluid that is outside `domain` (x0, y0, x1, y1), or nowhere, as parked; returns how many were."""
    parked = 0
    for i in range(count):
        inside = domain[0] <= S[X, i] <= domain[2] and domain[1] <= S[Y, i] <= domain[3]
        if kind[i] == FLUID and not inside:
            kind[i] = PARKED
            parked += 1
    return parked


@njit
def wrap(S, count, period):
    """Bring positions back into `period` (2, 2): lower and upper bound [m] along x and y, equal where there is none."""
    for axis in range(2):
        length = period[axis, 1] - period[axis, 0]
        if length > 0.0:
            for i in range(count):
                if S[axis, i] < period[axis, 0]:
                    S[axis, i] += length
                elif S[axis, i] >= period[axis, 1]:
                    S[axis, i] -= length


@njit
def count_cells(S, kind, count, origin, inv_cell, grid, key, start, order):
    """Keys, starts and sorted order of the first `count` particles; parked ones go to the end.

    `origin` (2,) [m]: corner of the first cell within the ring; `inv_cell` (2,) [1/m]: one over the cells' size.
    """
    parked_key = start.size - 2
    last_column, last_row = grid.columns - 2, grid.rows - 2
    start[:] = 0
    for i in range(count):
        if kind[i] == PARKED:
            key[i] = parked_key
        else:
            column = min(int((S[X, i] - origin[0]) * inv_cell[0]) + 1, last_column)
            row = min(int((S[Y, i] - origin[1]) * inv_cell[1]) + 1, last_row)
            key[i] = 2 * (row * grid.columns + column) + (0 if kind[i] == FLUID else 1)
        start[key[i] + 1] += 1
    for k in range(start.size - 1):
        start[k + 1] += start[k]
    for i in range(count):
        order[start[key[i]]] = i
        start[key[i]] += 1
    for k in range(start.size - 1, 0, -1):
        start[k] = start[k - 1]
    start[0] = 0


@parallel_njit
def permute(S, kind, ids, order, count, S2, kind2, ids2):
    """Copy the first `count` particles into sorted order, the others as they are."""
    n = kind.size
    for block in numba.prange((n + BLOCK - 1) // BLOCK):
        lo = block * BLOCK
        hi = min(lo + BLOCK, n)
        for k in range(max(lo, count), hi):
            order[k] = k
        for row in range(S.shape[0]):
            source = S[row]
            target = S2[row]
            for k in range(lo, hi):
                target[k] = source[order[k] & _NOT_NEGATIVE]
        for k in range(lo, hi):
            kind2[k] = kind[order[k]]
            ids2[k] = ids[order[k]]


@njit
def neighbour(grid, cell, i, j):
    """The cell `i` columns and `j` rows from `cell` (each −1, 0 or 1), and the shift [m] of its particles."""
    row, column = cell // grid.columns + j, cell % grid.columns + i
    x = y = 0.0
    if grid.period_x > 0.0:
        if column == 0:
            column, x = grid.columns - 2, -grid.period_x
        elif column == grid.columns - 1:
            column, x = 1, grid.period_x
    if grid.period_y > 0.0:
        if row == 0:
            row, y = grid.rows - 2, -grid.period_y
        elif row == grid.rows - 1:
            row, y = 1, grid.period_y
    return row * grid.columns + column, x, y


@njit
def share_cells(start, grid, edges, ghosts):
    """Cut the cells into chunks of like work, in place in `edges`; returns the most candidates of any cell.

    `ghosts`: how many of the sorted particles are ghosts.
    """
    nx = grid.columns
    cells = (start.size - 2) // 2
    ghost_weight = 0.3  # work of a ghost over that of a fluid particle
    total = start[start.size - 2] - ghosts + ghost_weight * ghosts
    most = 0
    chunks = edges.size - 1
    edges[0] = nx + 1
    chunk = 1
    done = 0.0
    for c in range(nx + 1, cells - nx - 1):
        while chunk < chunks and done >= total * chunk / chunks:
            edges[chunk] = c
            chunk += 1
        if start[2 * c + 2] == start[2 * c]:
            continue
        fluid = start[2 * c + 1] - start[2 * c]
        done += fluid + ghost_weight * (start[2 * c + 2] - start[2 * c + 1])
        most = max(most, candidates(start, grid, c))
    for k in range(chunk, chunks + 1):
        edges[k] = cells - nx - 1
    return most


@njit
def candidates(start, grid, cell):
    """Number of particles in the 3 × 3 cells around `cell`."""
    found = 0
    if grid.period_x > 0.0 or grid.period_y > 0.0:
        for j in range(-1, 2):
            for i in range(-1, 2):
                other, _, _ = neighbour(grid, cell, i, j)
                found += start[2 * other + 2] - start[2 * other]
    else:
        for j in range(-1, 2):
            found += start[2 * (cell + j * grid.columns) + 4] - start[2 * (cell + j * grid.columns) - 2]
    return found


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
def gather(S, rows, start, grid, cell, buffer):
    """Copy `rows` (x and y first) of all candidates of `cell` into `buffer`, padded; returns the padded number."""
    n = 0
    for j in range(-1, 2):
        lo = start[2 * (cell + j * grid.columns) - 2]
        hi = start[2 * (cell + j * grid.columns) + 4]
        for f in range(len(rows)):
            copy_run(S[rows[f]], lo, hi, buffer[f], n)
        n += hi - lo
    if grid.period_x > 0.0 or grid.period_y > 0.0:
        n = gather_images(S, rows, start, grid, cell, buffer, n, 2)
    return pad(len(rows), n, buffer)


@njit
def gather_fluid(S, rows, start, grid, cell, buffer):
    """The same for the fluid among them alone."""
    n = 0
    for j in range(-1, 2):
        for i in range(-1, 2):
            c = cell + j * grid.columns + i
            lo = start[2 * c]
            hi = start[2 * c + 1]
            for f in range(len(rows)):
                copy_run(S[rows[f]], lo, hi, buffer[f], n)
            n += hi - lo
    if grid.period_x > 0.0 or grid.period_y > 0.0:
        n = gather_images(S, rows, start, grid, cell, buffer, n, 1)
    if n == 0:
        return 0
    return pad(len(rows), n, buffer)


@njit
def gather_images(S, rows, start, grid, cell, buffer, n, kinds):
    """Append candidates of `cell` from across the period, shifted; returns how many there are then.

    `kinds`: 1 for the fluid, 2 for fluid and ghosts.
    """
    for j in range(-1, 2):
        for i in range(-1, 2):
            c, x, y = neighbour(grid, cell, i, j)
            if x == 0.0 and y == 0.0:
                continue
            lo = start[2 * c]
            hi = start[2 * c + kinds]
            for f in range(len(rows)):
                copy_run(S[rows[f]], lo, hi, buffer[f], n)
            for k in range(n, n + hi - lo):
                buffer[0, k] += x
                buffer[1, k] += y
            n += hi - lo
    return n


@njit
def pad(fields, n, buffer):
    """Fill up to a multiple of the vector width with far dummies (rows 0 and 1 are x and y); returns it."""
    padded = (n + LANES - 1) & ~(LANES - 1)
    for k in range(n, padded):
        buffer[0, k] = FAR
        buffer[1, k] = FAR
        for f in range(2, fields):
            buffer[f, k] = 0.0
    return padded
