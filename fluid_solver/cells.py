"""Cell sort, and the segments of rows that sweeps work through (see gather.py).

Cells lie in rows as high as the kernel's support and are `COLUMNS` times narrower than that. Particles are counting-
sorted by cell, row by row, in each cell fluid before ghosts: cell c holds [start[2c], start[2c + 1]) fluid and
[start[2c + 1], start[2c + 2]) ghosts. A ring of empty cells, a support wide, surrounds all. Of the rows, those that
hold fluid are kept, and those beside them; the ghosts of all others meet no fluid, and share the last row within the
ring: high walls and drops that fly far add few cells. Everything within the support of a particle lies in its own row
and the two beside it, at most `COLUMNS` columns away, as long as no particle is more than half the skin away from where
it was sorted to: rows are support + skin high.

In a periodic direction cells tile the period exactly, a little larger than that. A cell at its edge finds its
neighbours at the other edge, and sees them shifted by the period. Positions are wrapped at the sort and may leave the
period by half the skin in between.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fluid_solver.fields import AX, FLUID, PARKED, SX, U, X, Y
from shared.jit import inline_njit, njit, parallel_njit

COLUMNS = 2  # cells per support along a row
SEGMENT = 32  # cells of a row that share a buffer
BLOCK = 4096  # particles per task of an elementwise loop
SORTS = 16  # tasks of a sort, at most
PIECE = 16384  # cells of which one task makes starts from counts
MAX_CELLS = 8_000_000
_NOT_NEGATIVE = 2**62 - 1


class Grid(NamedTuple):
    """Cells in `rows` of `columns`, the empty ring counted; period [m] along x and y, 0 for none."""

    columns: int
    rows: int
    period_x: float
    period_y: float


@parallel_njit
def park_and_bound(S, kind, count, domain, found):
    """Mark fluid that is outside `domain` (x0, y0, x1, y1), or nowhere, as parked.

    Leaves per block in `found` (5, blocks): bounds x0, y0, −x1, −y1 [m] of what is not parked, and how many got parked.
    """
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        x0 = y0 = np.inf
        x1 = y1 = -np.inf
        parked = 0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            x, y = S[X, i], S[Y, i]
            if kind[i] == FLUID and not (domain[0] <= x <= domain[2] and domain[1] <= y <= domain[3]):
                kind[i] = PARKED
                parked += 1
            if kind[i] != PARKED:
                x0, x1, y0, y1 = min(x0, x), max(x1, x), min(y0, y), max(y1, y)
        found[0, block], found[1, block], found[2, block], found[3, block] = x0, y0, -x1, -y1
        found[4, block] = parked


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


@inline_njit
def led(S, i, fluid, axis, lead, kick):
    """Where particle i will be [m] in `lead` [s], having been accelerated for `kick` [s], if it is `fluid`."""
    x = S[X + axis, i]
    return x + lead * (S[U + axis, i] + kick * S[AX + axis, i] + S[SX + axis, i]) if fluid else x


@inline_njit
def row_of(y, origin, inv_cell, places):
    """Row of height `y` [m] among all those over the box, the ring counted."""
    return min(int((y - origin[1]) * inv_cell[1]) + 1, places.size - 2)


@parallel_njit
def mark_rows(S, kind, count, lead, kick, origin, inv_cell, places):
    """Set `places` (all rows,) to 1 for rows that hold fluid; see `find_cells`."""
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] == FLUID:
                places[row_of(led(S, i, True, 1, lead, kick), origin, inv_cell, places)] = 1


@njit
def place_rows(places, periodic):
    """From rows that hold fluid, 1 in `places`, to the place of each: of those that hold some and those beside them
    one after the other, of all others one behind these; if `periodic`, of all where they are. Returns how many rows
    there are, the ring counted."""
    if periodic:
        for row in range(places.size):
            places[row] = row
        return places.size
    here, after, last = 0, places[0], 0
    for row in range(places.size):
        before, here = here, after
        after = places[row + 1] if row + 1 < places.size else 0
        places[row] = -1
        if before + here + after > 0:
            last += 1
            places[row] = last
    for row in range(places.size):
        if places[row] < 0:
            places[row] = last + 1
    return last + 3


@parallel_njit
def find_cells(S, kind, count, lead, kick, origin, inv_cell, grid, places, key, parked_key, spans):
    """Keys of the first `count` particles, `parked_key` of the parked; least and largest of each block in `spans`.

    Fluid belongs to the cell where it will be in `lead` [s], having been accelerated for `kick` [s]. `origin` (2,)
    [m]: corner of the first cell within the ring; `inv_cell` (2,) [1/m]: one over the cells' size; `places` of all
    rows, see `place_rows`.
    """
    last_column = grid.columns - COLUMNS - 1
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        least, most = parked_key, 0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            k = parked_key
            if kind[i] != PARKED:
                fluid = kind[i] == FLUID
                x, y = led(S, i, fluid, 0, lead, kick), led(S, i, fluid, 1, lead, kick)
                column = min(int((x - origin[0]) * inv_cell[0]) + COLUMNS, last_column)
                row = places[row_of(y, origin, inv_cell, places)]
                k = 2 * (row * grid.columns + column) + (0 if fluid else 1)
            key[i] = k
            least, most = min(least, k), max(most, k)
        spans[block, 0], spans[block, 1] = least, most


@parallel_njit
def count_cells(key, count, spans, start, rank, order):
    """Starts of the cells and sorted order of the first `count` particles by `key`, equal ones as they stood.

    A task counts a range of keys. Particles stand in the order of the sort before, so that nearly all of a task's lie
    in few blocks, and ranges cut at every so many particles are of like work. Counts become starts in pieces of as many
    cells each: most of a tank may be empty. `rank`: place of a particle in its cell.
    """
    blocks = (count + BLOCK - 1) // BLOCK
    tasks = max(1, min(SORTS, blocks // 2))  # each goes through whole blocks
    first = np.zeros(tasks + 1, dtype=np.int64)  # key of each task
    for task in range(1, tasks):
        first[task] = max(first[task - 1], key[task * count // tasks])
    first[tasks] = start.size
    pieces = (start.size + PIECE - 1) // PIECE
    before = np.zeros(pieces + 1, dtype=np.int32)  # particles in the pieces before each
    for piece in numba.prange(pieces):
        start[piece * PIECE : piece * PIECE + PIECE] = 0
    for task in numba.prange(tasks):
        lo, hi = first[task], first[task + 1]
        for block in range(blocks):
            if spans[block, 0] < hi and spans[block, 1] >= lo:
                for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
                    if lo <= key[i] < hi:
                        rank[i] = start[key[i]]
                        start[key[i]] += 1
    for piece in numba.prange(pieces):
        before[piece + 1] = np.sum(start[piece * PIECE : piece * PIECE + PIECE])
    for piece in range(pieces):
        before[piece + 1] += before[piece]
    for piece in numba.prange(pieces):
        here = before[piece]
        for k in range(piece * PIECE, min(piece * PIECE + PIECE, start.size)):
            here, start[k] = here + start[k], here
    for block in numba.prange(blocks):
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            order[start[key[i]] + rank[i]] = i


@parallel_njit
def permute(S, rows, kind, ids, order, count, S2, kind2, ids2):
    """Copy the first `count` particles into sorted order, the others as they are; of the state only `rows`."""
    n = kind.size
    for block in numba.prange((n + BLOCK - 1) // BLOCK):
        lo = block * BLOCK
        hi = min(lo + BLOCK, n)
        for k in range(max(lo, count), hi):
            order[k] = k
        for row in rows:
            source = S[row]
            target = S2[row]
            for k in range(lo, hi):
                target[k] = source[order[k] & _NOT_NEGATIVE]
        for k in range(lo, hi):
            kind2[k] = kind[order[k]]
            ids2[k] = ids[order[k]]


@parallel_njit
def pick(S, rows, ids, first, last, out):
    """out[k, id − first] = S[rows[k]] of the particles with ids in [first, last)."""
    for block in numba.prange((ids.size + BLOCK - 1) // BLOCK):
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, ids.size)):
            if first <= ids[i] < last:
                for k in range(rows.size):
                    out[k, ids[i] - first] = S[rows[k], i]


@inline_njit
def neighbour(grid, column, row):
    """The cell at `column` and `row`, which may lie in the ring, and the shift [m] of its particles."""
    x = y = 0.0
    if grid.period_x > 0.0:
        if column < COLUMNS:
            column += grid.columns - 2 * COLUMNS
            x = -grid.period_x
        elif column >= grid.columns - COLUMNS:
            column -= grid.columns - 2 * COLUMNS
            x = grid.period_x
    if grid.period_y > 0.0:
        if row == 0:
            row = grid.rows - 2
            y = -grid.period_y
        elif row == grid.rows - 1:
            row = 1
            y = grid.period_y
    return row * grid.columns + column, x, y


def segments_per_row(grid):
    """Number of segments in a row."""
    return (grid.columns - 2 * COLUMNS + SEGMENT - 1) // SEGMENT


_segments_per_row = inline_njit(segments_per_row)


@inline_njit
def segment_columns(grid, segment):
    """Row of a segment, its first column and the one after its last."""
    first = COLUMNS + segment % _segments_per_row(grid) * SEGMENT
    return segment // _segments_per_row(grid) + 1, first, min(first + SEGMENT, grid.columns - COLUMNS)


@njit
def list_segments(start, grid, segments, shares):
    """List the segments with fluid in segments[0] and those with ghosts in segments[1], in order, and cut either list
    into shares of as many segments each: share k holds [shares[kind, k], shares[kind, k + 1]). Returns the most
    candidates of any segment.

    Most of a tank may be empty: sweeps are spared looking, and counting, there.
    """
    most = 0
    listed = np.zeros(2, dtype=np.int64)
    per_row = _segments_per_row(grid)
    dry = grid.rows - (2 if grid.period_y == 0.0 else 0)  # its ghosts meet nobody
    for row in range(1, grid.rows - 1):
        if start[2 * row * grid.columns] == start[2 * (row + 1) * grid.columns]:
            continue
        for segment in range((row - 1) * per_row, row * per_row):
            _, first, last = segment_columns(grid, segment)
            lo, hi = 2 * (row * grid.columns + first), 2 * (row * grid.columns + last)
            if start[lo] == start[hi]:
                continue
            if row < dry:
                most = max(most, candidates(start, grid, row, first, last))
            fluid = 0
            for k in range(lo, hi, 2):
                fluid += start[k + 1] - start[k]
            for kind, count in enumerate((fluid, start[hi] - start[lo] - fluid)):
                if count > 0:
                    segments[kind, listed[kind]] = segment
                    listed[kind] += 1
    workers = shares.shape[1] - 1
    for kind in range(2):
        for k in range(workers + 1):
            shares[kind, k] = listed[kind] * k // workers
    return most


@njit
def candidates(start, grid, row, first, last):
    """Number of particles in the three rows around the columns [first, last) of `row`, and `COLUMNS` beyond."""
    found = 0
    if grid.period_x > 0.0 or grid.period_y > 0.0:
        for column in range(first - COLUMNS, last + COLUMNS):
            for j in range(-1, 2):
                cell, _, _ = neighbour(grid, column, row + j)
                found += start[2 * cell + 2] - start[2 * cell]
    else:
        for j in range(-1, 2):
            of_row = (row + j) * grid.columns
            found += start[2 * (of_row + last + COLUMNS)] - start[2 * (of_row + first - COLUMNS)]
    return found
