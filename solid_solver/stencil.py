"""Storage of lattice bodies for fast sweeps: padded rows, and runs of particles that share their coefficients.

On a lattice most particles have the same neighbourhood, hence the same fit coefficients. Each body is laid out in rows
along its longer direction, with empty slots around it, so that a neighbour is a fixed distance away in memory. A *run* is
a stretch of one row whose particles share their *class*: a list of neighbour distances with the coefficients of the
derivatives, forward (a gathers its neighbours' displacements) and transposed (a gathers its neighbours' stresses).
A sweep over a run then reads contiguous memory and holds its coefficients in registers.

Lists of a class are padded to a multiple of GROUP with zero coefficients, the number of neighbours handled per loop.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solid_solver.quadratic_fit import DERIVATIVES, Fit

GROUP = 3
"""Neighbours per inner loop: 30 multiply-adds on 16 memory operations, and the coefficients fit in the registers."""

RUN = 64
"""Longest run, in particles: its ten intermediate sums stay in the first-level cache."""

CHUNK = 256
"""Particles per unit of threaded work."""

SAME = 10
"""Decimals to which two particles' coefficients [index units] must agree to share a class."""


@dataclass(frozen=True)
class Classes:
    """Neighbour lists: class c owns entries `first[c]` … `first[c+1]` of `distance` (m,) and `coefficient` (m, 5)."""

    first: np.ndarray
    distance: np.ndarray
    coefficient: np.ndarray


@dataclass(frozen=True)
class Layout:
    """`slots`: length of padded arrays; `slot` (n,): slot of each particle; `run` (r, 5): first slot, length, forward
    class, transposed class, body; `chunk` (c+1,): runs of each unit of threaded work."""

    slots: int
    slot: np.ndarray
    run: np.ndarray
    chunk: np.ndarray
    forward: Classes
    transposed: Classes


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


class _ClassTable:
    """Collects classes over bodies."""

    def __init__(self):
        self.first, self.distance, self.coefficient = [0], [], []

    def add(self, coefficient: np.ndarray, distance: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """Class number of each particle (n,) for coefficients (n, k, 5), scaled to SI by `scale` (5,)."""
        flat = coefficient.reshape(len(coefficient), -1)
        _, chosen, inverse = np.unique(flat, axis=0, return_index=True, return_inverse=True)
        start = len(self.first) - 1
        for a in chosen:
            used = np.any(coefficient[a] != 0.0, axis=1)
            pad = -int(used.sum()) % GROUP
            self.distance.append(np.concatenate([distance[used], np.zeros(pad, dtype=np.int64)]))
            self.coefficient.append(np.concatenate([coefficient[a, used] * scale, np.zeros((pad, DERIVATIVES))]))
            self.first.append(self.first[-1] + len(self.distance[-1]))
        return start + inverse.ravel()

    def finish(self) -> Classes:
        return Classes(np.array(self.first), np.concatenate(self.distance), np.concatenate(self.coefficient))


def _runs(slot: np.ndarray, forward: np.ndarray, transposed: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Cut particles sorted by slot into runs of equal class and adjacent slots."""
    cut = (np.diff(slot) != 1) | (np.diff(forward) != 0) | (np.diff(transposed) != 0) | (np.diff(body) != 0)
    start = np.concatenate([[0], np.flatnonzero(cut) + 1])
    end = np.concatenate([start[1:], [len(slot)]])
    pieces = [(s, min(s + RUN, e)) for a, e in zip(start, end, strict=True) for s in range(a, e, RUN)]
    return np.array([(slot[s], e - s, forward[s], transposed[s], body[s]) for s, e in pieces], dtype=np.int64)


def _chunks(length: np.ndarray) -> np.ndarray:
    """Bounds (c+1,) of groups of runs of about CHUNK particles."""
    group = np.concatenate([[0], np.cumsum(length)[:-1]]) // CHUNK
    return np.concatenate([[0], np.flatnonzero(np.diff(group)) + 1, [len(length)]]).astype(np.int64)


def lay_out(bodies: list[tuple[np.ndarray, Fit, np.ndarray]]) -> Layout:
    """Lay out bodies, each (index (n, 2), fit, scale (5,): factors from index units to SI per derivative)."""
    slots, slot, body = 0, [], []
    forward, transposed = _ClassTable(), _ClassTable()
    forward_class, transposed_class = [], []
    for number, (index, fit, scale) in enumerate(bodies):
        reach = int(np.abs(fit.offset).max())
        place, stride, slots_after = _slots(index, reach, slots + RUN)
        distance = fit.offset[:, 0] + fit.offset[:, 1] * stride
        coefficient = _shared(fit.coefficient)
        forward_class.append(forward.add(coefficient, distance, scale))
        turned = _transpose(coefficient, place, distance, slots_after)
        transposed_class.append(transposed.add(turned, distance, scale))
        slot.append(place)
        body.append(np.full(len(place), number))
        slots = slots_after
    slot, body = np.concatenate(slot), np.concatenate(body)
    order = np.argsort(slot, kind="stable")
    run = _runs(slot[order], np.concatenate(forward_class)[order], np.concatenate(transposed_class)[order], body[order])
    return Layout(slots, slot, run, _chunks(run[:, 1]), forward.finish(), transposed.finish())
