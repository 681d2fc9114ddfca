"""Storage of lattice bodies for fast sweeps: padded rows, and runs of particles that share their coefficients.

On a lattice most particles have the same neighbourhood, hence the same fit coefficients. Each body is laid out in rows
along its longer direction, with empty slots around it, so that a neighbour is a fixed distance away in memory. A
*run* is a stretch of one row whose particles share their *class*: a list of neighbour distances with the coefficients
of the derivatives, forward (a gathers its neighbours' displacements) and transposed (a gathers their stresses).
A sweep over a run then reads contiguous memory and holds its coefficients in registers.

Lists of a class are padded to a multiple of GROUP with zero coefficients, the number of neighbours handled per loop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solid_solver.quadratic_fit import DERIVATIVES, Fit

GROUP = 3
"""Neighbours per inner loop: 30 multiply-adds on 16 memory operations, and the coefficients fit in the registers."""

RUN = 128
"""Longest run, in particles: its intermediate sums and strains, 19 kB, stay in the first-level cache."""

CHUNK = 256
"""Particles per unit of threaded work."""

SAME = 10
"""Decimals to which two particles' coefficients [index units] must agree to share a class."""


class Gather(NamedTuple):
    """One direction of the fit, as compiled sweeps take it.

    `run` (r, 4): first slot, length, class, body; `chunk` (c+1,): bounds of the runs of each unit of threaded work;
    class c owns entries `first[c]` … `first[c+1]` of `distance` (m,) and `coefficient` (m, 5).
    """

    run: np.ndarray
    chunk: np.ndarray
    first: np.ndarray
    distance: np.ndarray
    coefficient: np.ndarray


class Driven(NamedTuple):
    """What clamps in motion add to derivatives. Forward run n owns entries `first[n]` … `first[n+1]` of `place` (m,),
    the particle within the run, `field` (m,), and `weight` (m, 5), its derivatives where that field has size 1."""

    first: np.ndarray
    place: np.ndarray
    field: np.ndarray
    weight: np.ndarray


@dataclass(frozen=True)
class Layout:
    """`slots`: length of padded arrays; `slot` (n,): slot of each particle; gathers of both directions; `driven`: by
    clamps in motion."""

    slots: int
    slot: np.ndarray
    forward: Gather
    transposed: Gather
    driven: Driven


def fast_axis_first(index: np.ndarray) -> np.ndarray:
    """Order (2,) of the lattice's axes that puts the body's longer direction first."""
    extent = index.max(axis=0) - index.min(axis=0)
    return np.array([0, 1]) if extent[0] >= extent[1] else np.array([1, 0])


def _slots(index: np.ndarray, reach: int, base: int) -> tuple[np.ndarray, int, int]:
    """Slots of lattice points `index` (first axis fastest), row stride, and the end of the body's storage."""
    shifted = index - index.min(axis=0) + reach
    stride = int(shifted[:, 0].max()) + 1 + reach
    rows = int(shifted[:, 1].max()) + 1 + reach
    return base + shifted[:, 1] * stride + shifted[:, 0], stride, base + rows * stride + RUN


def _shared(coefficient: np.ndarray) -> np.ndarray:
    """The coefficients (n, k, 5) with those that agree made equal to the bit."""
    key = np.round(coefficient, SAME) + 0.0
    _, first, inverse = np.unique(key.reshape(len(key), -1), axis=0, return_index=True, return_inverse=True)
    return coefficient[first[inverse.ravel()]]


def _transpose(coefficient: np.ndarray, slot: np.ndarray, distance: np.ndarray, slots: int) -> np.ndarray:
    """For each a and each distance d the coefficient of a in the fit of the particle at a + d (zero if none)."""
    owner = np.full(slots, -1)
    owner[slot] = np.arange(len(slot))
    back = {int(d): k for k, d in enumerate(distance)}
    result = np.zeros_like(coefficient)
    for k, d in enumerate(distance):
        neighbour = owner[slot + d]
        there = neighbour >= 0
        result[there, k] = coefficient[neighbour[there], back[-int(d)]]
    return result


class _GatherTable:
    """Collects the classes and runs of one direction over bodies."""

    def __init__(self):
        self.first, self.distance, self.coefficient, self.runs = [0], [], [], []

    def add(self, coefficient, distance, scale, slot, body) -> None:
        """A body's coefficients (n, k, 5) [index units] at its `slot` (n,), to be scaled to SI by `scale` (5,)."""
        flat = coefficient.reshape(len(coefficient), -1)
        _, chosen, inverse = np.unique(flat, axis=0, return_index=True, return_inverse=True)
        self.runs += _runs(slot, len(self.first) - 1 + inverse.ravel(), body)
        for a in chosen:
            used = np.any(coefficient[a] != 0.0, axis=1)
            pad = -int(used.sum()) % GROUP
            self.distance.append(np.concatenate([distance[used], np.zeros(pad, dtype=np.int64)]))
            self.coefficient.append(np.concatenate([coefficient[a, used] * scale, np.zeros((pad, DERIVATIVES))]))
            self.first.append(self.first[-1] + len(self.distance[-1]))

    def finish(self) -> Gather:
        run = np.array(self.runs, dtype=np.int64)
        return Gather(
            run,
            _chunks(run[:, 1]),
            np.array(self.first),
            np.concatenate(self.distance),
            np.concatenate(self.coefficient),
        )


def _runs(slot: np.ndarray, cls: np.ndarray, body: int) -> list[tuple[int, int, int, int]]:
    """Stretches of adjacent slots of equal class, in order of slots: (first slot, length, class, body)."""
    order = np.argsort(slot)
    slot, cls = slot[order], cls[order]
    start = np.concatenate([[0], np.flatnonzero((np.diff(slot) != 1) | (np.diff(cls) != 0)) + 1])
    end = np.concatenate([start[1:], [len(slot)]])
    pieces = [(s, min(s + RUN, e)) for a, e in zip(start, end, strict=True) for s in range(a, e, RUN)]
    return [(slot[s], e - s, cls[s], body) for s, e in pieces]


def _chunks(length: np.ndarray) -> np.ndarray:
    """Bounds (c+1,) of groups of runs of about CHUNK particles."""
    group = np.concatenate([[0], np.cumsum(length)[:-1]]) // CHUNK
    return np.concatenate([[0], np.flatnonzero(np.diff(group)) + 1, [len(length)]]).astype(np.int64)


def _driven(runs: np.ndarray, entries: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> Driven:
    """Entries (slots, fields, weights) by the forward `runs` (r, 4) that hold their slots."""
    slot, field, weight = (np.concatenate(part) for part in zip(*entries, strict=True))
    owner = np.searchsorted(runs[:, 0], slot, side="right") - 1
    order = np.lexsort((slot, field, owner))
    first = np.searchsorted(owner[order], np.arange(len(runs) + 1))
    return Driven(first, (slot - runs[owner, 0])[order], field[order], weight[order])


def lay_out(bodies: list[tuple[np.ndarray, Fit, np.ndarray]]) -> Layout:
    """Lay out bodies, each (index (n, 2), fit, scale (5,): factors from index units to SI per derivative)."""
    slots, slot, fields, entries = 0, [], 0, []
    forward, transposed = _GatherTable(), _GatherTable()
    for number, (index, fit, scale) in enumerate(bodies):
        reach = int(np.abs(fit.offset).max())
        place, stride, slots = _slots(index, reach, slots + RUN)
        distance = fit.offset[:, 0] + fit.offset[:, 1] * stride
        coefficient = _shared(fit.coefficient)
        forward.add(coefficient, distance, scale, place, number)
        transposed.add(_transpose(coefficient, place, distance, slots), distance, scale, place, number)
        slot.append(place)
        particle, field = np.nonzero(np.any(fit.held != 0.0, axis=2))
        entries.append((place[particle], fields + field, fit.held[particle, field] * scale))
        fields += fit.held.shape[1]
    ahead = forward.finish()
    return Layout(slots, np.concatenate(slot), ahead, transposed.finish(), _driven(ahead.run, entries))
