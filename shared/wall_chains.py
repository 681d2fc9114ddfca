"""Walls that meet: what the fluid sees as one face, however many walls it is written as.

The fluid is on the left of every walk, so that walls which meet end to start go on as one polyline does at its corner.
Walls of unlike motions part as soon as they move: they are not joined.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from shared.schema_fluid import Wall

MEET = 0.1  # of dx: ends of walls nearer to each other, or to a face, are taken for one point


@dataclass(frozen=True)
class Chain:
    """Walls that meet end to start, or one alone.

    `segments` (k, 2, 2) [m]: their faces in the order of the walk; `owner` (k,): number of the wall of each; `closed`:
    the last meets the first; `foot`, `head`: the segment (2, 2) of another wall on whose wetted side an open chain
    begins, ends.
    """

    segments: np.ndarray
    owner: np.ndarray
    closed: bool
    foot: np.ndarray | None = None
    head: np.ndarray | None = None


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
    groups = (tuple(sorted(k for k, _ in met)) for _, met in _meetings(walls, MEET * dx))
    return [list(group) for group in dict.fromkeys(groups) if len(group) > 2]


def _meetings(walls: Sequence[Wall], near: float) -> Iterator[tuple[tuple[int, bool], list[tuple[int, bool]]]]:
    """Every end of an open wall, as its number and whether it starts there, and all ends there of like motion."""
    ends = [(k, starts) for k, wall in enumerate(walls) if not wall.closed for starts in (True, False)]
    place = np.array([walls[k].polyline[0 if starts else -1] for k, starts in ends], dtype=float).reshape(-1, 2)
    for end, point in zip(ends, place, strict=True):
        here = np.flatnonzero(np.hypot(*(place - point).T) <= near)
        yield end, [ends[m] for m in here if walls[ends[m][0]].motion == walls[end[0]].motion]


def _followers(walls: Sequence[Wall], near: float) -> dict[int, int]:
    """Which wall starts where a wall ends, if no third one ends or starts there."""
    after = {}
    for (number, starts), met in _meetings(walls, near):
        following = [k for k, begins in met if begins]
        if not starts and len(met) == 2 and following:
            after[number] = following[0]
    return after


def _chain(walls: Sequence[Wall], order: list[int], closed: bool, near: float) -> Chain:
    parts = [segments_of(walls[k]) for k in order]
    segments = np.concatenate(parts)
    owner = np.repeat(order, [len(part) for part in parts])
    if closed:
        return Chain(segments, owner, closed)
    like = [segments_of(wall) for wall in walls if wall.motion == walls[order[0]].motion]
    faces = np.concatenate(like)
    return Chain(segments, owner, closed, _under(*segments[0], faces, near), _under(*segments[-1, ::-1], faces, near))


def _under(end: np.ndarray, inner: np.ndarray, faces: np.ndarray, near: float) -> np.ndarray | None:
    """The one of `faces` (k, 2, 2) between whose ends the `end` (2,) of a wall lies, if the wall comes from its left:
    from `inner` (2,)."""
    along = faces[:, 1] - faces[:, 0]
    length = np.hypot(*along.T)
    along = along / length[:, None]
    left = np.c_[-along[:, 1], along[:, 0]]
    s = np.sum((end - faces[:, 0]) * along, axis=1)
    d = np.abs(np.sum((end - faces[:, 0]) * left, axis=1))
    stands = (d <= near) & (s > near) & (s < length - near) & (np.sum((inner - faces[:, 0]) * left, axis=1) > near)
    return faces[np.argmax(stands)] if stands.any() else None
