"""How fast moved walls push water, and which only slide along themselves: a gate that is lifted, a belt."""

from __future__ import annotations

import numpy as np

from shared.geometry.motion_table import MotionTable, largest_speed
from shared.geometry.wall_chains import segments_of
from shared.schema.fluid import Wall

_SAMPLES = 1001  # times at which a wall is looked at
_ALONG = 1e-6  # speed across its faces, over the largest, up to which a wall slides along them
_PLANE = np.array([1.0, 1.0j])  # vectors as complex numbers


def pushing_speed(wall: Wall, water: np.ndarray) -> float:
    """Largest speed [m/s] at which a wall pushes or drags the water whose corners start at `water` (n, 2) [m].

    Of a free-slip wall the speed across its faces, and along them where an end runs ahead to where water starts: a gate
    that is lifted leaves the water as it is.
    """
    if wall.motion is None:
        return abs(wall.surface_speed)
    if wall.slip == "no":
        return largest_speed(wall.motion, wall.polyline)
    place, axis, speed = _course(wall)
    fastest = np.abs(speed.imag).max()
    if not wall.closed:
        for tip, ahead, along in (
            (place[:, 0, 0], -axis[:, 0], -speed[:, 0, 0].real),
            (place[:, -1, 1], axis[:, -1], speed[:, -1, 1].real),
        ):
            wet = np.any(((water @ _PLANE - tip[:, None]) * ahead.conj()[:, None]).real > 0.0, axis=1)
            fastest = max(fastest, along[wet].max(initial=0.0))
    return float(fastest)


def lasting_faces(wall: Wall) -> np.ndarray:
    """Faces (k, 2, 2) [m] on which water may rest: of a wall that only slides along itself where it ends, else where it
    starts."""
    if wall.motion is None:
        return segments_of(wall)
    place, _, speed = _course(wall)
    slides = np.abs(speed.imag).max() <= _ALONG * np.abs(speed).max()
    return np.stack([place.real, place.imag], axis=-1)[-1 if slides else 0]


def _course(wall: Wall) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a moved wall's k faces at some times t: places (t, k, 2) [m] of start and end, direction (t, k), and speeds
    (t, k, 2) [m/s] of both, real along the face and imaginary across it."""
    table, times = MotionTable(wall.motion), np.linspace(0.0, wall.motion.times[-1], _SAMPLES)
    x, y, angle = table.displacements(times).T[:, :, None, None]
    u, v, spin = table.displacements(times, order=1).T[:, :, None, None]
    arm = np.exp(1j * angle) * ((segments_of(wall) - table.about) @ _PLANE)
    place, speed = table.about @ _PLANE + x + 1j * y + arm, u + 1j * v + 1j * spin * arm
    axis = np.diff(arm, axis=2)[:, :, 0]  # far away a wall has no length in rounded places
    axis = axis / np.abs(axis)
    return place, axis, speed * axis.conj()[:, :, None]
