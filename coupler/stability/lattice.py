"""How long a step the waves of a lattice of particles bear.

A square lattice of spacing dx, V = dx², F = (1/r) dW/dr scaled so that Σ V r⊗∇W = −I, a wave e^{i k·r} of small size.
The sums over neighbours turn into numbers of k:

    D = Σ V F r sin(k·r)                                       of ∇p and of ∇·u
    L = −2 Σ V F (1 − cos(k·r))                                of the diffusion of p
    N = −Σ V F (r⊗r)/(r² + ε h²) (1 − cos(k·r))                of artificial viscosity, its largest eigenvalue

With u at half steps, a fluid's step is u' = (1 − a) u − Δt i D p/ρ, p' = (1 − b) p − Δt ρ c² i D·u', where
a = α h c Δt N/2 (Π acts on approaching pairs alone, half of them) and b = ν_e Δt L, ν_e = h c/16 with EDAC pressure,
otherwise 0. The slowest decay flips its sign every step; solutions stay bounded while

    (c Δt |D|)² ≤ (2 − a) (2 − b),   a ≤ 2,   b ≤ 2   for every k.

The Courant number C = c Δt/h that follows depends on kernel, h/dx and α, on neither dx nor c.
"""

from __future__ import annotations

import math

import numpy as np

from shared.kernels import Kernel, evaluate

EDAC = 0.5 / 8.0  # ν_e/(h c0), Ramachandran & Puri 2019
_EPS = 0.01  # ε: keeps Π finite
_WAVES = 48  # wave numbers along each axis, from 0 to π/dx
_MOST = 8.0  # Courant number that nothing bears
_BISECTIONS = 40


def wave_numbers(kernel: Kernel, h_over_dx: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """|D| dx, L dx² and N dx² of all waves of the lattice, (waves,) each."""
    reach = kernel.support * h_over_dx
    i, j = (axis.ravel() for axis in np.mgrid[-math.ceil(reach) : reach + 1, -math.ceil(reach) : reach + 1])
    r2 = i**2 + j**2
    F = evaluate(kernel, np.sqrt(r2), h_over_dx)[1]
    F *= -2.0 / np.sum(r2 * F)
    k = np.linspace(0.0, math.pi, _WAVES + 1)
    phase = (k[:, None, None] * i + k[None, :, None] * j).reshape(-1, len(i))
    D = np.hypot(np.sin(phase) @ (F * i), np.sin(phase) @ (F * j))
    still = 1.0 - np.cos(phase)
    L = -2.0 * still @ F
    weight = -F / (r2 + _EPS * h_over_dx**2)
    xx, yy, xy = (still @ (weight * a * b) for a, b in ((i, i), (j, j), (i, j)))
    N = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
    return D, L, N


def largest_courant(kernel: Kernel, h_over_dx: float, alpha: float, edac: bool) -> float:
    """C = c Δt/h up to which no wave grows; `edac`: with EDAC's diffusion of pressure."""
    D, L, N = wave_numbers(kernel, h_over_dx)
    low, high = 0.0, _MOST
    for _ in range(_BISECTIONS):
        C = 0.5 * (low + high)
        step = C * h_over_dx  # c Δt/dx
        a = 0.5 * alpha * h_over_dx * step * N
        b = EDAC * h_over_dx * step * L if edac else np.zeros_like(L)
        stable = np.all((step * D) ** 2 <= (2.0 - a) * (2.0 - b)) and a.max() <= 2.0 and b.max() <= 2.0
        low, high = (C, high) if stable else (low, C)
    return low
