"""Strain energies of both particle solids, and the books of the work that loads do."""

from __future__ import annotations

import numpy as np


def lattice_energy(planes: np.ndarray, axes: np.ndarray, moment: np.ndarray, lam: float, mu: float) -> np.ndarray:
    """Energy per volume (n,) [J/m³] of the total-Lagrangian solid's cells, see strain_gradient.py.

    `planes` (10, n): derivatives of both displacement components; `axes` (n, 2, 2): rows e_K; `moment` (n, 2): d²/12;
    `lam`, `mu` [Pa].
    """
    d = planes.reshape(2, 5, -1).transpose(2, 0, 1)
    gradient, frame = d[:, :, :2], axes.transpose(0, 2, 1)
    f = frame + gradient
    # From displacement gradients: FᵀF − I would lose the digits of small strains.
    mixed = frame.transpose(0, 2, 1) @ gradient
    strain = 0.5 * (mixed + mixed.transpose(0, 2, 1) + gradient.transpose(0, 2, 1) @ gradient)
    total = _quadratic(strain, lam, mu)
    for k, second in enumerate((d[:, :, [2, 3]], d[:, :, [3, 4]])):
        mixed = f.transpose(0, 2, 1) @ second
        total += moment[:, k] * _quadratic(0.5 * (mixed + mixed.transpose(0, 2, 1)), lam, mu)
    return total


def _quadratic(strain: np.ndarray, lam: float, mu: float) -> np.ndarray:
    trace = strain[:, 0, 0] + strain[:, 1, 1]
    return 0.5 * lam * trace**2 + mu * np.sum(strain**2, axis=(1, 2))


def stress_energy(
    stress: np.ndarray, pressure: np.ndarray, curvature: np.ndarray, volume: np.ndarray, moduli: tuple
) -> np.ndarray:
    """Energy (n,) [J/m] of the updated-Lagrangian solid's particles: V [S:S/4G + p²/2K + Q²/2E'(V/12)], or with Z_k in
    place of Q, Σ_k Z_k:C⁻¹:Z_k/2(V/12).

    `stress` (4, n): S as xx, xy, yy, zz; `curvature`: Q (2, n), or xx, xy, yy of Z_0 and Z_1 (6, n); `moduli`: G, K and
    E' [Pa] (E' = 0: no Q).
    """
    shear, bulk, bending = moduli
    xx, xy, yy, zz = stress
    density = (xx**2 + yy**2 + zz**2 + 2.0 * xy**2) / (4.0 * shear) + pressure**2 / (2.0 * bulk)
    if len(curvature) == 2:
        return volume * (density + (np.sum(curvature**2, axis=0) * 6.0 / (bending * volume) if bending else 0.0))
    nu = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
    for xx, xy, yy in (curvature[:3], curvature[3:]):
        varying = (1.0 - nu) * (xx**2 + yy**2) - 2.0 * nu * xx * yy + 2.0 * xy**2
        density += varying / (4.0 * shear) * 12.0 / volume
    return volume * density


class WorkBook:
    """Work of the loads on each body, `done` (bodies,) [J/m], added up over steps or windows where it is `wanted`.

    `owner` (n,): body of each particle; `mass` (n,) [kg/m].
    """

    def __init__(self, wanted: bool, owner: np.ndarray, mass: np.ndarray, bodies: int):
        self.wanted = wanted
        self.done = np.zeros(bodies)
        self._owner, self._mass = owner, mass

    def add(self, acceleration: np.ndarray, moved: np.ndarray) -> None:
        """Add the work of loads that give a mean `acceleration` (n, 2) [m/s²] while particles move (n, 2) [m]."""
        if self.wanted:
            power = self._mass * np.sum(acceleration * moved, axis=1)
            self.done += np.bincount(self._owner, power, len(self.done))


def trapezoid(shares: np.ndarray) -> np.ndarray:
    """Mean (g,) of factors (m + 1, g) over the m steps between them."""
    return (0.5 * (shares[0] + shares[-1]) + shares[1:-1].sum(axis=0)) / (len(shares) - 1)
