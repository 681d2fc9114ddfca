"""The elementwise parts of a step: kicks and drifts of the fluid. Each returns or leaves per-block results."""

from __future__ import annotations

import numba
import numpy as np

from fluid_solver.cells import BLOCK
from fluid_solver.fields import (
    AX,
    AY,
    DP,
    FLUID,
    NEW_NX,
    NEW_NY,
    NX,
    NY,
    PR2,
    RHO,
    SX,
    SY,
    VOL,
    M,
    P,
    U,
    V,
    X,
    Y,
)
from shared.jit import inline_njit, parallel_njit


@inline_njit
def set_pressure(S, i, p, c):
    """Particle i's pressure `p` [Pa], and what follows from it: ρ = ρ0 + p/c0², m/ρ, p/ρ²."""
    rho = c.rho0 + p / (c.c0 * c.c0)
    S[RHO, i] = rho
    S[P, i] = p
    S[VOL, i] = S[M, i] / rho
    S[PR2, i] = p / (rho * rho)


@parallel_njit
def kick_and_drift(S, kind, count, dt, shifting, speeds):
    """u += a dt/2, then x += (u + δu) dt/2. Per block the largest |u|² and |u + δu|² [m²/s²] into `speeds`."""
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        u2 = w2 = 0.0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] == FLUID:
                u = S[U, i] + 0.5 * dt * S[AX, i]
                v = S[V, i] + 0.5 * dt * S[AY, i]
                tu = u + S[SX, i] if shifting else u
                tv = v + S[SY, i] if shifting else v
                S[U, i] = u
                S[V, i] = v
                S[X, i] += 0.5 * dt * tu
                S[Y, i] += 0.5 * dt * tv
                u2 = max(u2, u * u + v * v)
                w2 = max(w2, tu * tu + tv * tv)
        speeds[0, block] = u2
        speeds[1, block] = w2


@parallel_njit
def advance_and_drift(S, kind, count, dt, shifting, c, R, clipped):
    """p a full step on, not below c.weakest, and with it ρ = ρ0 + p/c²; then x += (u + δu) dt/2.

    `clipped` (blocks,) [N s/m] grows by Σ V Δp/c0 of the tension Δp taken off: the impulse of the sound it would send.
    """
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        taken = 0.0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] == FLUID:
                free = S[P, i] + dt * R[DP, i]
                p = max(free, c.weakest)
                taken += S[VOL, i] * (p - free)
                set_pressure(S, i, p, c)
                S[X, i] += 0.5 * dt * (S[U, i] + S[SX, i] if shifting else S[U, i])
                S[Y, i] += 0.5 * dt * (S[V, i] + S[SY, i] if shifting else S[V, i])
        clipped[block] += taken / c.c0


@parallel_njit
def keep_volume(S, kind, count, volume, c, sums):
    """Shift p of all fluid by what makes Σ m/ρ the `volume` [m²] that the walls leave it.

    In a disordered fluid Σ V ∇·u is not quite zero. With no free surface to yield, a mean pressure would grow from it,
    and with that the noise of the pressure force.
    """
    blocks = (count + BLOCK - 1) // BLOCK
    for block in numba.prange(blocks):
        total = 0.0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] == FLUID:
                total += S[VOL, i]
        sums[0, block] = total
    shift = c.rho0 * c.c0 * c.c0 * (np.sum(sums[0, :blocks]) / volume - 1.0)
    for block in numba.prange(blocks):
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] == FLUID:
                set_pressure(S, i, S[P, i] + shift, c)


@parallel_njit
def kick(S, kind, count, dt, shifting, R, speeds):
    """u += a dt/2, and the surface normals of the sweep before take effect.

    Per block into `speeds` the largest |a|² [m²/s⁴], and |u + δu|² [m²/s²] after another kick like this one.
    """
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        a2 = w2 = 0.0
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] == FLUID:
                ax, ay = S[AX, i], S[AY, i]
                u = S[U, i] + 0.5 * dt * ax
                v = S[V, i] + 0.5 * dt * ay
                S[U, i] = u
                S[V, i] = v
                tu = u + 0.5 * dt * ax
                tv = v + 0.5 * dt * ay
                if shifting:
                    tu += S[SX, i]
                    tv += S[SY, i]
                a2 = max(a2, ax * ax + ay * ay)
                w2 = max(w2, tu * tu + tv * tv)
                if shifting:
                    S[NX, i] = R[NEW_NX, i]
                    S[NY, i] = R[NEW_NY, i]
        speeds[0, block] = a2
        speeds[1, block] = w2


def largest_of(speeds, count):
    """The two largest sizes of what was left per block in `speeds`, squared."""
    first, second = np.sqrt(speeds[:, : (count + BLOCK - 1) // BLOCK].max(axis=1))
    return float(first), float(second)
