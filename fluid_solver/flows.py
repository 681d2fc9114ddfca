"""Initial velocities of the fluid that vary in space: the scene's velocity fields."""

from __future__ import annotations

import math

import numpy as np

from shared.geometry.regions import outline
from shared.schema.fluid import FluidBody


def initial_flow(body: FluidBody, position: np.ndarray, rho0: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocity (n, 2) [m/s] of the body's particles at `position` (n, 2), and the pressure (n,) [Pa] it goes with."""
    velocity = np.tile(body.velocity, (len(position), 1)).astype(float)
    if body.velocity_field is None:
        return velocity, np.zeros(len(position))
    field_velocity, pressure = _FIELDS[body.velocity_field.kind](body, position, rho0)
    return velocity + field_velocity, pressure


def _taylor_green(body: FluidBody, position: np.ndarray, rho0: float) -> tuple[np.ndarray, np.ndarray]:
    """Taylor & Green (1937): vortices that keep their shape and decay as exp(−2νk²t)."""
    speed, k = body.velocity_field.speed, 2.0 * math.pi / body.velocity_field.wavelength
    x, y = k * position.T
    velocity = speed * np.c_[np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)]
    return velocity, 0.25 * rho0 * speed**2 * (np.cos(2.0 * x) + np.cos(2.0 * y))


def _standing_wave(body: FluidBody, position: np.ndarray, rho0: float) -> tuple[np.ndarray, np.ndarray]:
    """Airy's standing wave as its surface passes through level: all energy is in the motion."""
    speed, k = body.velocity_field.speed, 2.0 * math.pi / body.velocity_field.wavelength
    heights = outline(body)[..., 1]
    x, z = k * position[:, 0], k * (position[:, 1] - heights.min())
    scale = speed / math.sinh(k * np.ptp(heights))
    velocity = scale * np.c_[-np.sin(x) * np.cosh(z), np.cos(x) * np.sinh(z)]
    return velocity, np.zeros(len(position))


_FIELDS = {"taylor-green": _taylor_green, "standing-wave": _standing_wave}
