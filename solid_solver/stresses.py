"""Stress fields for output."""

from __future__ import annotations

import numpy as np


def stress_fields(sxx: np.ndarray, syy: np.ndarray, szz: np.ndarray, sxy: np.ndarray) -> dict[str, np.ndarray]:
    """Pressure and von Mises stress (n,) [Pa] with the components of the Cauchy stress in the plane."""
    pressure = -(sxx + syy + szz) / 3.0
    shear = 0.5 * ((sxx - syy) ** 2 + (syy - szz) ** 2 + (szz - sxx) ** 2) + 3.0 * sxy**2
    return {
        "pressure": pressure,
        "von_mises": np.sqrt(shear),
        "stress_xx": sxx,
        "stress_yy": syy,
        "stress_xy": sxy,
    }


def cauchy_fields(planes: np.ndarray, axes: np.ndarray, lam: float, mu: float) -> dict[str, np.ndarray]:
    """Stress fields of St. Venant-Kirchhoff's law, plane strain: σ = F S Fᵀ/J, σ_zz = λ tr(E)/J.

    `planes` (10, n): derivatives of both displacement components; `axes` (n, 2, 2): rows e_K; `lam`, `mu` [Pa].
    """
    gradient = np.stack([planes[[0, 1]], planes[[5, 6]]]).transpose(2, 0, 1)
    f = axes.transpose(0, 2, 1) + gradient
    strain = 0.5 * (f.transpose(0, 2, 1) @ f - np.eye(2))
    trace = np.trace(strain, axis1=1, axis2=2)
    second = lam * trace[:, None, None] * np.eye(2) + 2.0 * mu * strain
    jacobian = np.abs(np.linalg.det(f))
    sigma = f @ second @ f.transpose(0, 2, 1) / jacobian[:, None, None]
    return stress_fields(sigma[:, 0, 0], sigma[:, 1, 1], lam * trace / jacobian, sigma[:, 0, 1])
