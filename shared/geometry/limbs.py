"""Limbs of a body: how thick it is where it bears, which its bounding box does not tell of a frame, a ring or a tee,
and how thick a lattice of particles makes them.

From points along the outline the way straight through to the other side is a thickness; that which half of the outline
has, or less, is the body's. A body is made of limbs where it is below `SLENDER` of the box's smaller side; they are as
long, together, as the area over it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from shared.geometry.regions import Same, area, outline_own, own_box, own_size
from shared.geometry.segments import directions, lengths, right_of
from shared.schema.geometry import Shape

SLENDER = 0.75  # thickness over the box's smaller side
FITS = 0.02  # of a bending compliance
_POINTS = 400  # along the outline, and one per segment
_THICK = 2.0  # times the body's thickness: ways through joints and along limbs, which say nothing of bending
_MOST = 0.9  # of the limbs: what a lattice makes of the worst tenth is not looked at
_ON = 1e-9  # of the size
_TIE = 1e-6  # of a spacing: a particle this near to a face stands on it
_LEAST = 0.1  # of a thickness: a limb that holds no particle
_SHARP = 0.7  # sine of a turn of the outline from which it is a corner


@dataclass(frozen=True)
class Limbs:
    """`thickness`, `length` [m]: of a body's limbs, together; `corners`: number of those that the body goes round."""

    thickness: float
    length: float
    corners: int


def limbs(shape: Shape) -> Limbs | None:
    """A shape's limbs; None of one that is a single stout or slender piece."""
    return _limbs(Same(shape))


def thickness_of(shape: Shape) -> float:
    """Thickness [m] of a shape's limbs, or the smaller side of its bounding box."""
    found = limbs(shape)
    return found.thickness if found else float(own_size(shape).min())


@lru_cache(maxsize=512)
def _limbs(same: Same) -> Limbs | None:
    shape = same.shape
    if shape.rectangle is not None or shape.circle is not None:
        return None
    _, _, way, share, _ = _ways(same)
    order = np.argsort(way)
    middle = float(way[order][np.searchsorted(np.cumsum(share[order]), 0.5 * share.sum())])
    if middle > SLENDER * float(own_size(shape).min()):
        return None
    return Limbs(middle, area(shape) / middle, _corners(outline_own(shape)))


@lru_cache(maxsize=512)
def _ways(same: Same) -> tuple[np.ndarray, ...]:
    """From points along the outline straight through the body: where they start and end (n, 2) [m] in its own frame,
    their length and that of outline which each stands for (n,) [m], and whether they end square (n,)."""
    segments = outline_own(same.shape)
    along = segments[:, 1] - segments[:, 0]
    length = lengths(segments)
    count = np.maximum(1, np.rint(_POINTS * length / length.sum()).astype(int))
    owner = np.repeat(np.arange(len(segments)), count)
    place = (np.concatenate([np.arange(c) for c in count]) + 0.5) / count[owner]
    start = segments[owner, 0] + place[:, None] * along[owner]
    inward = -right_of(directions(segments))[owner]
    offset = segments[None, :, 0] - start[:, None]
    across = inward[:, None, 0] * along[None, :, 1] - inward[:, None, 1] * along[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        way = (offset[..., 0] * along[:, 1] - offset[..., 1] * along[:, 0]) / across
        hit = (offset[..., 0] * inward[:, None, 1] - offset[..., 1] * inward[:, None, 0]) / across
    met = (np.abs(hit - 0.5) <= 0.5 + _ON) & (way > _ON * length.sum())
    other = np.argmin(np.where(met, way, math.inf), axis=1)
    kept, row = met.any(axis=1), np.arange(len(start))
    nearest, square = way[row, other], np.abs(across[row, other]) >= (1.0 - _ON) * length[other]
    end, share = start + nearest[:, None] * inward, length[owner] / count[owner]
    return start[kept], end[kept], nearest[kept], share[kept], square[kept]


def _corners(segments: np.ndarray) -> int:
    """Number of corners at which an outline (k, 2, 2) turns away from the body."""
    along = directions(segments)
    size = float(np.ptp(segments.reshape(-1, 2), axis=0).max())
    gap = np.hypot(*(segments[:, None, 1] - segments[None, :, 0]).T).T
    turn = along[:, None, 0] * along[None, :, 1] - along[:, None, 1] * along[None, :, 0]
    return int(np.count_nonzero((gap <= 1e-6 * size) & (turn < -_SHARP)))


def bearing(shape: Shape, dx: float) -> float:
    """What a lattice of spacing `dx` [m] makes the bending compliance of a shape's limbs, over their own, less 1: of
    the limb that it changes most. Faces that slant, or are not parallel, are held on average."""
    found = limbs(shape)
    if found is None:
        return 0.0
    start, end, way, share, square = _ways(Same(shape))
    lower, size = own_box(shape)[0], own_size(shape)
    spacing = size / np.maximum(1, np.floor(size / dx + 0.5))
    step = np.abs(end - start)
    straight = square & (np.min(step, axis=1) <= _ON * way)
    row, axis = np.arange(len(way)), np.argmax(step, axis=1)
    first, last = (np.ceil((p - lower) / spacing - 0.5 - _TIE)[row, axis] for p in (start, end))
    held = np.where(straight, np.abs(last - first) * spacing[axis] / way, 1.0)
    thin = way <= _THICK * found.thickness
    changed = np.maximum(held[thin], _LEAST) ** -3 - 1.0
    order = np.argsort(np.abs(changed))
    reached = np.cumsum(share[thin][order]) >= _MOST * share[thin].sum()
    return float(changed[order][np.argmax(reached)])


def fitting(shape: Shape, dx: float) -> float | None:
    """The largest spacing below `dx` [m], down to a third of it, that fits a shape's limbs; None if there is none."""
    side = float(own_size(shape).min())
    least = math.ceil(side / dx)
    spacings = (side / count for count in range(least, 3 * least + 1))
    return next((one for one in spacings if abs(bearing(shape, one)) < FITS), None)
