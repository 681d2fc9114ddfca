"""Walls that meet: what the fluid sees as one face, however many walls it is written as.

The fluid is on the left of every walk, so that walls which meet end to start go on as one polyline does at its corner.
Walls of unlike motions part as soon as they move: they are not joined.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shared.geometry.segments import directions, lengths, right_of
from shared.schema.fluid import Wall

MEET = 0.1  # of dx: ends of walls nearer to each other, or to a face, are taken for one point


@dataclass(frozen=True)
class Ground:
    """The face (2, 2) [m] of wall number `wall` on whose wetted side the end of another wall stands."""

    wall: int
    face: np.ndarray


@dataclass(frozen=True)
class Chain:
    """Walls that meet end to start, or one alone.

    `segments` (k, 2, 2) [m]: their faces in the order of the walk; `owner` (k,): number of the wall of each; `closed`:
    the last meets the first; `foot`, `head`: what an open chain stands on where it begins, ends.
    """

    segments: np.ndarray
    owner: np.ndarray
    closed: bool
    foot: Ground | None = None
    head: Ground | None = None


def segments_of(wall: Wall) -> np.ndarray:
    """Faces (k, 2, 2) [m] of a wall in the order of its walk."""
    corners = np.asarray([*wall.polyline, wall.polyline[0]] if wall.closed else wall.polyline, dtype=float)
    return np.stack([corners[:-1], corners[1:]], axis=1)


def chains(walls: Sequence[Wall], dx: float) -> list[Chain]:
    """All walls as chains at ghost spacing `dx` [m]: open ones, then closed ones, each from its first wall on."""
    after = _followers(walls, MEET * dx)
    heads = [k for k in range(len(walls)) if k not in after.values()]
    found: list[Chain] = []
    taken: set[int] = set()
    for first in [*heads, *range(len(walls))]:
        if first in taken:
            continue
        order = [first]
        while after.get(order[-1], first) != first:
            order.append(after[order[-1]])
        taken.update(order)
        found.append(_chain(walls, order, walls[first].closed or order[-1] in after, MEET * dx))
    return found


def crowds(walls: Sequence[Wall], dx: float) -> list[list[int]]:
    """Numbers of the walls, of like motion, that end or start in one point, for every point where more than two do."""
    groups = (tuple(sorted(k for k, _ in met)) for met in _meetings(walls, MEET * dx))
    return [list(group) for group in dict.fromkeys(groups) if len(group) > 2]


def parting(walls: Sequence[Wall], dx: float) -> list[tuple[Ground, Ground, bool]]:
    """Ends of walls that stand on the face of a wall of unlike motion at first: that face, the wall's own there, and
    whether it starts there."""
    found = []
    for chain in chains(walls, dx):
        motion = walls[chain.owner[0]].motion
        grounds = [Ground(k, face) for k, w in enumerate(walls) if w.motion != motion for face in segments_of(w)]
        for end, starts in ((0, True), (-1, False)) if grounds and not chain.closed else ():
            segment = chain.segments[end]
            ground = _under(*(segment if starts else segment[::-1]), grounds, MEET * dx)
            if ground is not None:
                found.append((ground, Ground(int(chain.owner[end]), segment), starts))
    return found


def _meetings(walls: Sequence[Wall], near: float) -> Counter[frozenset[tuple[int, bool]]]:
    """Ends of open walls, each as number of the wall and whether it starts there: those of like motion that lie at an
    end, counted over all ends."""
    ends = [(k, starts) for k, wall in enumerate(walls) if not wall.closed for starts in (True, False)]
    place = np.array([walls[k].polyline[0 if starts else -1] for k, starts in ends], dtype=float).reshape(-1, 2)
    met = Counter()
    for (number, _), point in zip(ends, place, strict=True):
        here = [ends[m] for m in np.flatnonzero(np.hypot(*(place - point).T) <= near)]
        met[frozenset(end for end in here if walls[end[0]].motion == walls[number].motion)] += 1
    return met


def _followers(walls: Sequence[Wall], near: float) -> dict[int, int]:
    """Which wall starts where a wall ends, if no third one ends or starts there."""
    after = {}
    for met, times in _meetings(walls, near).items():
        if len(met) == times == 2:
            (one, one_starts), (other, other_starts) = met
            if one_starts != other_starts:
                after |= {other: one} if one_starts else {one: other}
    return after


def _chain(walls: Sequence[Wall], order: list[int], closed: bool, near: float) -> Chain:
    parts = [segments_of(walls[k]) for k in order]
    segments = np.concatenate(parts)
    owner = np.repeat(order, [len(part) for part in parts])
    if closed:
        return Chain(segments, owner, closed)
    like = [k for k, wall in enumerate(walls) if wall.motion == walls[order[0]].motion]
    grounds = [Ground(k, face) for k in like for face in segments_of(walls[k])]
    foot, head = _under(*segments[0], grounds, near), _under(*segments[-1, ::-1], grounds, near)
    return Chain(segments, owner, closed, foot, head)


def _under(end: np.ndarray, inner: np.ndarray, grounds: Sequence[Ground], near: float) -> Ground | None:
    """The ground between whose ends the `end` (2,) of a wall lies, if `inner` (2,), the corner next to the end, is on
    the left of it."""
    faces = np.stack([ground.face for ground in grounds])
    along, length = directions(faces), lengths(faces)
    left = -right_of(along)
    s = np.sum((end - faces[:, 0]) * along, axis=1)
    d = np.abs(np.sum((end - faces[:, 0]) * left, axis=1))
    stands = (d <= near) & (s > near) & (s < length - near) & (np.sum((inner - faces[:, 0]) * left, axis=1) > near)
    return grounds[np.argmax(stands)] if stands.any() else None
