"""Sweep one, at the middle of the step: the rate of pressure, and with it of density.

dp/dt = ρ_a c² Σ V_b u_ab·∇W + (transport of p) + diffusion of p.                            (EDAC, `ctvf`)

Density follows as ρ = ρ0 + p/c². Without the last two terms (`wcsph`) this is the continuity equation with the linear
equation of state. With them it is EDAC with the continuity equation given the same diffusion: two fields that start
proportional, obey proportional equations and stay so, hence one. Without diffusion of its own, ρ beside an EDAC
pressure drifts without bound where particles are shifted (a still tank: 20 % in 2 s).

A particle torn off keeps the pressure it had then, below zero after a pull, and would stick to, and creep into, the
next wall. So particles with too few neighbours to know a pressure, ∇·r below `ISOLATED`, forget tension. Compression
stays: it is what stops a single drop at a wall.
"""

from __future__ import annotations

from functools import cache

import numba

from fluid_solver.fields import DP, RHO, SX, SY, VOL, P, U, V, X, Y
from fluid_solver.gather import gather, next_stretch, run_of
from fluid_solver.surface import ISOLATED
from fluid_solver.terms import pressure_diffusion, transport, velocity_divergence
from shared.jit import parallel_njit
from shared.kernels import f_shape

FORGETTING = 0.2  # rate in c0/h: fast beside the flight of a drop, slow beside a step
_ROWS = (X, Y, U, V, VOL)
_ROWS_TRANSPORT = (*_ROWS, SX, SY, P)


@cache
def make_rates(kernel: int, transported: bool):
    """The compiled sweep for a kernel code; `transported`: EDAC pressure and transport terms (ctvf)."""
    rows = _ROWS_TRANSPORT if transported else _ROWS

    @parallel_njit
    def rates(S, start, grid, segments, shares, taken, buffers, columns, c, R):
        """Writes R[DP] [Pa/s] of the fluid."""
        rho_gx = c.rho0 * c.gx
        rho_gy = c.rho0 * c.gy
        for worker in numba.prange(taken.size):
            b = buffers[worker]
            row, first, last = next_stretch(start, grid, 0, segments, shares, taken, worker)
            while first < last:
                gather(S, rows, 2, start, grid, row, first, last, b, columns[worker])
                for column in range(first, last):
                    cell = row * grid.columns + column
                    lo, hi = run_of(columns[worker], column - first)
                    for a in range(start[2 * cell], start[2 * cell + 1]):
                        xa, ya, ua, va, rho_a, p_a = S[X, a], S[Y, a], S[U, a], S[V, a], S[RHO, a], S[P, a]
                        div = div_r = p_rate = 0.0
                        for k in range(lo, hi):
                            rx = xa - b[0, k]
                            ry = ya - b[1, k]
                            r2 = rx * rx + ry * ry
                            F = f_shape(kernel, r2, c.h)  # c.slope follows with the sums
                            div_r -= b[4, k] * F * r2
                            div += velocity_divergence(b[4, k], rx, ry, ua - b[2, k], va - b[3, k], F)
                            if transported:
                                p_ab = p_a - b[7, k]
                                p_rate += transport(b[4, k], p_ab, rx, ry, b[5, k], b[6, k], F)
                                p_rate += pressure_diffusion(b[4, k], p_ab, rx, ry, rho_gx, rho_gy, c.nu_edac, F)
                        R[DP, a] = c.slope * (rho_a * c.c0 * c.c0 * div + p_rate)
                        if c.slope * div_r < ISOLATED:
                            R[DP, a] -= FORGETTING * c.c0 / c.h * min(0.0, p_a)
                row, first, last = next_stretch(start, grid, 0, segments, shares, taken, worker)

    return rates
