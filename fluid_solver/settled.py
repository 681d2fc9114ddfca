"""Water at rest as it starts: settled compressible columns between the faces of its body.

Under gravity a column of nominal depth H carries p = ρ0 g D exactly where a mass ρ0 D per area lies above, at
ρ = ρ0 + p/c², and stands lower, at depth d = (c²/g) ln(1 + g D/c²) below its own settled top; mass and bottom stay.

A stretch of the body that begins or ends at another height, over a ridge, on or under something in the water, holds
what fits between the same pressures: its ends stay where they are, and with them half a spacing before every face, and
its particles weigh a little more or less. Let down with the rest, water would stand a third of a spacing off the
underside of a block and as much too near to its top (0.3 m of water at c0 = 15 m/s, dx 5 mm). wcsph makes up for that
by pressures that give the right force: 30 % too high below, and of any sign above.
"""

from __future__ import annotations

import math

import numpy as np

from shared.geometry import outline
from shared.schema_geometry import Body

LIGHTEST = 0.5  # share of its mass that a particle has at least: less at the edge of deep water, which is let down
_THINNEST = 1e-9  # of the water's depth: a thinner stretch


def settle(body: Body, position: np.ndarray, gravity: np.ndarray, c0: float, rho0: float):
    """Positions (n, 2) and pressures (n,) of the body's particles, settled under `gravity`, and their masses over
    those at rest density (n,)."""
    g = math.hypot(*gravity)
    if g == 0.0:
        return position, np.zeros(len(position)), np.ones(len(position))
    up = -gravity / g
    across = np.array([up[1], -up[0]])
    faces = np.stack([outline(body) @ across, outline(body) @ up], axis=2)
    lowest, highest = faces[:, :, 1].min(), faces[:, :, 1].max()
    height = position @ up
    foot, head = stretch(faces, position @ across, height)
    deep = highest - lowest

    def settled(mass):
        return c0**2 / g * np.log1p(g * mass / c0**2)

    def mass_above(end):
        return np.maximum(0.0, c0**2 / g * np.expm1(g * (lowest + settled(deep) - end) / c0**2))

    below = np.where(foot > lowest, mass_above(foot), deep)
    above = np.where(head < highest, mass_above(head), 0.0)
    share = (below - above) / np.maximum(head - foot, _THINNEST * deep)
    depth = above + share * (head - height)
    lift = (settled(deep) - settled(depth)) - (deep - (highest - height))
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
