"""Storage of a deforming solid for fast sweeps: particles in rows, and neighbours as distances in memory.

The particles of a body, fixed ones included, are stored row by row along its longer direction, so that the neighbours
of adjacent particles are adjacent too. A *block* is a stretch of RUN slots at most; its list holds the distances in
memory at which any of its particles has a neighbour. A sweep over a block then reads contiguous memory for each
distance, without an index per pair. Pairs that a list holds in excess are out of the kernel's reach and add nothing.
Around each body lie empty slots, far away and without mass, for distances that lead past its ends.

A second list holds the distances of pairs a little farther apart, to be watched: while none of them has come into
reach, the first is complete. So a list lasts as long as the body does not deform much, however far it moves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from solid_solver.bodies import LatticeBody

RUN = 64
"""Most particles of a block: its sums stay in the first-level cache."""

GROUP = 4
"""Neighbours added up at a time; lists are padded to a multiple of it with distance 0, the particle itself."""

FAR = 1.0e9
"""Place of empty slots, in spacings."""

CHUNK = 4
"""Blocks per unit of threaded work."""

SKIN = 0.2
"""Width of the shell around the kernel's support in which pairs are listed, over the spacing: a lattice has none."""

WATCHED = 1.0
"""Width of the next shell, whose pairs are watched, over the spacing."""


class Blocks(NamedTuple):
    """`start`, `count` (b,): first slot and particles of each block, which owns the entries `first[k]` … `first[k+1]`
    of `distance`, and of `outer` those from `first_outer[k]` on (distances to be watched)."""

    start: np.ndarray
    count: np.ndarray
    first: np.ndarray
    distance: np.ndarray
    first_outer: np.ndarray
    outer: np.ndarray


class Storage:
    """Slots of particles: `slots` in all, `free` (n,) of the bodies' particles in published order, `held` (m,) of the
    fixed ones, `used`: from the first to the last, `extents`: first slot and number of particles by body."""

    def __init__(self, bodies: list[LatticeBody], held: list[np.ndarray]):
        sizes = [len(b.position) + len(points) for b, points in zip(bodies, held, strict=True)]
        gap = max(sizes)
        base, free, fixed, self.extents = gap, [], [], []
        for body, points, size in zip(bodies, held, sizes, strict=True):
            along, across = np.concatenate([body.index, body.to_index(points)]).T
            order = np.lexsort((along, np.rint(2.0 * across)))
            slot = np.empty(size, dtype=np.int64)
            slot[order] = base + np.arange(size)
            free.append(slot[: len(body.position)])
            fixed.append(slot[len(body.position) :])
            self.extents.append((base, size))
            base += size + gap
        self.slots, self.used = base, slice(gap, base - gap)
        self.free, self.held = np.concatenate(free), np.concatenate(fixed)

    def plane(self, free: np.ndarray, held: np.ndarray | float, empty: float = 0.0) -> np.ndarray:
        """An array (slots,) with values `free` (n,), `held` (m,), and `empty` in empty slots."""
        result = np.full(self.slots, empty)
        result[self.free], result[self.held] = free, held
        return result

    def blocks(self, x: np.ndarray, reach: float, spacing: float) -> Blocks:
        """Blocks with neighbours of particles at `x` (2, slots) [m], listed within `reach` and a skin [m]."""
        start, count, lists, outer = [], [], [], []
        for base, size in self.extents:
            near, far = _distances(x[:, base : base + size], reach, spacing)
            for k in range(len(near)):
                start.append(base + k * RUN)
                count.append(min(RUN, size - k * RUN))
                lists.append(near[k])
                outer.append(far[k])
        return Blocks(np.array(start), np.array(count), *_flat(lists), *_flat(outer))


def _distances(x: np.ndarray, reach: float, spacing: float) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Distances in memory listed and watched, block by block, of one body's particles at `x` (2, n) [m]."""
    n = x.shape[1]
    a, b = cKDTree(x.T).query_pairs(reach + (SKIN + WATCHED) * spacing, output_type="ndarray").T
    close = np.sum((x[:, a] - x[:, b]) ** 2, axis=0) < (reach + SKIN * spacing) ** 2
    near, far = [], []
    owner, step = np.concatenate([a, b]) // RUN, np.concatenate([b - a, a - b])
    inside = np.concatenate([close, close])
    listed = np.unique(owner[inside] * (2 * n) + step[inside] + n)
    watched = np.setdiff1d(owner[~inside] * (2 * n) + step[~inside] + n, listed)
    for k in range((n + RUN - 1) // RUN):
        for keys, lists in ((listed, near), (watched, far)):
            begin, end = np.searchsorted(keys, [k * 2 * n, (k + 1) * 2 * n])
            lists.append(keys[begin:end] - k * 2 * n - n)
    pad = [np.zeros(-len(d) % GROUP, dtype=np.int64) for d in near]
    return [np.concatenate([d, p]) for d, p in zip(near, pad, strict=True)], far


def _flat(lists: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (k + 1,) and entries of `lists` one after the other."""
    return np.concatenate([[0], np.cumsum([len(d) for d in lists])]), np.concatenate(lists).astype(np.int64)
