"""Water at rest as it starts: settled compressible columns between the faces of its body.

Under gravity a column of nominal depth H carries p = ρ0 g D exactly where a mass ρ0 D per area lies above, at
ρ = ρ0 + p/c², and stands lower, at depth d = (c²/g) ln(1 + g D/c²) below its own settled top; mass and bottom stay.

A stretch of the body that begins or ends at another height, over a ridge, on or under something in the water, holds
what fits between the same pressures: its ends stay where they are, and with them half a spacing before every face, and
its particles weigh a little more or less. Let down with the rest, water would stand a third of a spacing off the
underside of a block and as much too near to its top (0.3 m of water at c0 = 15 m/s, dx 5 mm). wcsph makes up for that
by pressures that give the right force: 30 % too high below, and of any sign above.

What nothing covers ends in the open, at no pressure, however high the rest of the body stands: of a deep and a shallow
water in one outline, or of a surface that slopes, each column below the highest level is settled by itself.
"""

from __future__ import annotations

import math

import numpy as np

from shared.geometry.regions import outline
from shared.geometry.segments import right_of
from shared.schema.geometry import Body

LIGHTEST = 0.5  # share of its mass that a particle has at least: less at the edge of deep water, which is let down
_THINNEST = 1e-9  # of the water's depth: a thinner stretch


def settle(
    body: Body, position: np.ndarray, gravity: np.ndarray, c0: float, rho0: float, faces: np.ndarray, near: float
):
    """Positions (n, 2) and pressures (n,) of the body's particles, settled under `gravity`, and their masses over
    those at rest density (n,). `faces` (k, 2, 2) [m]: what holds the water, the fluid on their left; one nearer than
    `near` [m] to the end of a stretch covers it."""
    g = math.hypot(*gravity)
    if g == 0.0:
        return position, np.zeros(len(position)), np.ones(len(position))
    up = -gravity / g
    across = right_of(up)
    edges, held = (np.stack([k @ across, k @ up], axis=2) for k in (outline(body), faces))
    lowest, highest = edges[:, :, 1].min(), edges[:, :, 1].max()
    place, height = position @ across, position @ up
    foot, head = stretch(edges, place, height)
    below_top = head < highest - _THINNEST * (highest - lowest)
    covered = below_top & _covered(held, place, head, near)
    top = _level_over(place, np.where(below_top, head, highest), covered, highest)
    lowest = np.where(top < highest, foot, lowest)
    deep = top - lowest

    def settled(mass):
        return c0**2 / g * np.log1p(g * mass / c0**2)

    def mass_above(end):
        return np.maximum(0.0, c0**2 / g * np.expm1(g * (lowest + settled(deep) - end) / c0**2))

    below = np.where(foot > lowest, mass_above(foot), deep)
    above = np.where(covered, mass_above(head), 0.0)
    share = (below - above) / np.maximum(head - foot, _THINNEST * np.ptp(edges[:, :, 1]))
    depth = above + share * (head - height)
    lift = (settled(deep) - settled(depth)) - (deep - (top - height))
    return position + lift[:, None] * up, rho0 * g * depth, np.maximum(share, LIGHTEST)


def stretch(faces: np.ndarray, across: np.ndarray, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights (n,) of the `faces` (k, 2, 2), the body on their left, that a point's stretch of it stands on and ends
    at; `across` and `height` (n,) are the points', as those of the faces are. Lowest and highest of all where there is
    none.

    A point that was moved out of the body, as packing does beside a slope, is of the stretch below it.
    """
    lowest, highest = faces[:, :, 1].min(), faces[:, :, 1].max()
    foot, head = np.full(len(height), lowest), np.full(len(height), highest)
    for carries, found in ((True, foot), (False, head)):
        for (start, low), (end, high) in faces:
            if (end > start) == carries and end != start:
                crossed = (across >= min(start, end)) & (across < max(start, end))
                at = low + (high - low) * (across - start) / (end - start)
                if carries:
                    found[...] = np.where(crossed & (at <= height), np.maximum(found, at), found)
                else:
                    found[...] = np.where(crossed & (at > foot), np.minimum(found, at), found)
    return foot, head


def _covered(faces: np.ndarray, across: np.ndarray, head: np.ndarray, near: float) -> np.ndarray:
    """Which stretches, at `across` (n,) and up to `head` (n,) [m], end below one of the `faces` (k, 2, 2)."""
    found = np.zeros(len(head), dtype=bool)
    for (start, low), (end, high) in faces:
        if end < start:
            at = low + (high - low) * (across - start) / (end - start)
            found |= (across >= end) & (across < start) & (np.abs(at - head) < near)
    return found


def _level_over(across: np.ndarray, head: np.ndarray, covered: np.ndarray, highest: float) -> np.ndarray:
    """Height (n,) [m] of the surface that presses on each stretch: its own `head`, or where it is `covered` that of the
    open one nearest to it across; the body's `highest` where there is none."""
    if covered.all():
        return np.full(len(head), highest)
    order = np.flatnonzero(~covered)[np.argsort(across[~covered], kind="stable")]
    after = np.clip(np.searchsorted(across[order], across), 1, max(len(order) - 1, 1)) % len(order)
    before = order[after - 1]
    nearest = np.where(across - across[before] < across[order[after]] - across, before, order[after])
    return np.where(covered, head[nearest], head)
