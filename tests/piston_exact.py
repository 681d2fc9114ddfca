"""The piston on a column of water in closed form: a step force on a mass on a spring that closes a tube of water.

Per area of face: mass m, stiffness k, column of density ρ, length L, sound speed c; force F from t = 0 on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

MODES = 400


@dataclass(frozen=True)
class Piston:
    """The case `piston` as it ships: entry P1_mu1 of the reference."""

    m: float = 1000.0
    k: float = 1000.0 * 2.0 * (2.0 * np.pi) ** 2
    rho: float = 1000.0
    L: float = 1.0
    c: float = 50.0
    at_rest: float = 0.01

    def characteristic(self, omega, far_end: str):
        """Zero at the angular frequencies [1/s]: (k − m ω²) cos − ρ c ω sin (open), (k − m ω²) sin + ρ c ω cos."""
        phase, elastic, wave = omega * self.L / self.c, self.k - self.m * omega**2, self.rho * self.c * omega
        if far_end == "open":
            return elastic * np.cos(phase) - wave * np.sin(phase)
        return elastic * np.sin(phase) + wave * np.cos(phase)

    def frequencies(self, far_end: str) -> np.ndarray:
        """The first `MODES` roots."""
        grid = np.arange(20 * MODES) * np.pi * self.c / self.L / 16.0 + 1e-3
        values = self.characteristic(grid, far_end)
        left = np.flatnonzero(values[:-1] * values[1:] < 0.0)
        return np.array([brentq(self.characteristic, grid[i], grid[i + 1], (far_end,), xtol=1e-13) for i in left])

    def displacement(self, times: np.ndarray, far_end: str) -> np.ndarray:
        """Displacement [m] at `times` after F = k · at_rest is switched on; far_end open, closed or absorbing."""
        force = self.k * self.at_rest
        if far_end == "absorbing":
            decay = self.rho * self.c / (2.0 * self.m)
            omega = np.sqrt(complex(self.k / self.m - decay**2))
            swing = np.cos(omega * times) + decay / omega * np.sin(omega * times)
            return self.at_rest * (1.0 - np.exp(-decay * times) * swing).real
        if far_end == "incompressible":
            omega = np.sqrt(self.k / (self.m + self.rho * self.L))
            return self.at_rest * (1.0 - np.cos(omega * times))
        omega = self.frequencies(far_end)
        phase = omega * self.L / self.c
        shape, edge = (np.cos(phase), 1.0) if far_end == "open" else (np.sin(phase), -1.0)
        mass = self.m + 0.5 * self.rho * self.L * (1.0 + edge * np.sin(2.0 * phase) / (2.0 * phase)) / shape**2
        return np.sum(force / (mass * omega**2) * (1.0 - np.cos(np.outer(times, omega))), axis=1)
