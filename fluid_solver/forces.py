"""Sweep two, at the end of the step: acceleration, shifting velocity and surface marks of the fluid.

du/dt = −Σ m_b (p_a/ρ_a² + p_b/ρ_b² + Π_ab) ∇W + viscous + g + (d·∇)u.

The transport term is (d·∇)u with ∇u = Σ V_b (u_b − u_a) ⊗ ∇W over the fluid: exact for linear fields as far as the
kernel sum is, and blind to a uniform velocity, which the printed A = ρ u ⊗ d form is not on disordered particles. The
d in it is the one with which the particle has just moved.
In a room that water fills, a particle's own p_a below zero counts as −p_a (Sun et al. 2018, with shifting): the force
is then of the difference of pressures, which pulls no particles together. Without it water tears off a sliding lid in
the corner that sucks, and comes to rest (lid_cavity, 25 particles across). The pair's forces are not opposite there.
Sums for shifting and for the surface: ∇C = Σ V_b [1 + 0.2 (W/W(dx))⁴] ∇W and ∇·r = −Σ V_b r² F.
"""

from __future__ import annotations

from functools import cache

import numba
import numpy as np

from fluid_solver.cells import COLUMNS
from fluid_solver.fields import AX, AY, FRICTION, NEW_NX, NEW_NY, NX, NY, PR2, SX, SY, VOL, M, U, V, X, Y
from fluid_solver.gather import gather, next_stretch, run_of
from fluid_solver.shifting import shift_velocity
from fluid_solver.surface import surface_normal
from fluid_solver.terms import (
    artificial_viscosity,
    laminar_viscosity,
    mean_specific_mass,
    pressure_force,
    shifting_weight,
)
from shared.jit import inline_njit, parallel_njit
from shared.kernels import f_shape, w_shape

NEGLIGIBLE = 0.1  # of c0: relative speeds below it need no looking at every pair
_ROWS = (X, Y, U, V, M, VOL, PR2, FRICTION)
_ROWS_SHIFTING = (*_ROWS, NX, NY)


@inline_njit
def pair_force(viscous, rx, ry, ux, uy, m_b, vol_b, pr2_b, friction, pr2_a, inv_rho_a, F, alpha_h_c, c):
    """Acceleration (x, y) [m/s²] that b adds to a with `F` [1/m⁴]. Times m_a it is antisymmetric in a and b.

    `alpha_h_c`: α h c0/ρ0 [m⁵/(kg s)].
    """
    r2 = rx * rx + ry * ry
    along = pressure_force(pr2_a, pr2_b)
    along += alpha_h_c * (friction * artificial_viscosity(rx, ry, ux, uy, r2, c.h))
    along *= m_b
    if viscous:
        along += laminar_viscosity(mean_specific_mass(m_b, vol_b, inv_rho_a), rx, ry, ux, uy, r2, c.h, c.nu)
    return along * F * rx, along * F * ry


@cache
def make_forces(kernel: int, viscous: bool, shifting: bool):
    """The compiled sweep for a kernel code; `shifting`: with (d·∇)u, shifting velocity and surface marks (ctvf)."""
    rows = _ROWS_SHIFTING if shifting else _ROWS

    @parallel_njit
    def forces(S, start, grid, segments, shares, taken, buffers, columns, c, u_max, R, fastest):
        """Writes S[AX], S[AY] of the fluid; if shifting also S[SX], S[SY] and the new normals in R.

        Leaves per thread in `fastest` the largest relative speed, squared [m²/s²], between a fluid particle and another
        in reach, or a bound of it where that is `NEGLIGIBLE`.
        """
        alpha_h_c = c.alpha * c.h * c.c0 / c.rho0
        negligible = (NEGLIGIBLE * c.c0) ** 2
        for worker in numba.prange(taken.size):
            b = buffers[worker]
            relative = 0.0
            row, first, last = next_stretch(start, grid, 0, segments, shares, taken, worker)
            while first < last:
                gather(S, rows, 2, start, grid, row, first, last, b, columns[worker])
                bound = velocity_range(b, columns[worker][0], columns[worker][last - first + 2 * COLUMNS])
                violent = bound > max(relative, negligible)
                if not violent:
                    relative = max(relative, bound)
                for column in range(first, last):
                    cell = row * grid.columns + column
                    lo, hi = run_of(columns[worker], column - first)
                    mine, end = start[2 * cell], start[2 * cell + 1]
                    if violent and mine < end:
                        relative = max(relative, relative_speed(S, mine, end, b, lo, hi, c.support * c.support))
                    surface = shifting and any_surface(b, lo, hi)
                    for a in range(mine, end):
                        xa, ya, ua, va = S[X, a], S[Y, a], S[U, a], S[V, a]
                        pr2_a, inv_rho_a = S[PR2, a], S[VOL, a] / S[M, a]
                        if c.filled > 0.0:
                            pr2_a = abs(pr2_a)
                        ax = ay = cx = cy = div_r = 0.0
                        dx, dy = (S[SX, a], S[SY, a]) if shifting else (0.0, 0.0)
                        for k in range(lo, hi):
                            rx = xa - b[0, k]
                            ry = ya - b[1, k]
                            r2 = rx * rx + ry * ry
                            F = f_shape(kernel, r2, c.h)  # c.slope follows with the sums
                            ux = ua - b[2, k]
                            uy = va - b[3, k]
                            fx, fy = pair_force(
                                viscous, rx, ry, ux, uy, b[4, k], b[5, k], b[6, k], b[7, k],
                                pr2_a, inv_rho_a, F, alpha_h_c, c,
                            )  # fmt: skip
                            ax += fx
                            ay += fy
                            if shifting:
                                vol_f = b[5, k] * F
                                carried = vol_f * (dx * rx + dy * ry)
                                ax -= carried * ux
                                ay -= carried * uy
                                div_r -= vol_f * r2
                                weight = shifting_weight(vol_f, c.pairing * w_shape(kernel, r2, c.h))
                                cx += weight * rx
                                cy += weight * ry
                        S[AX, a] = c.slope * ax + c.gx
                        S[AY, a] = c.slope * ay + c.gy
                        if shifting:
                            cx, cy, div_r = c.slope * cx, c.slope * cy, c.slope * div_r
                            near_x, near_y = sum_of_normals(kernel, xa, ya, b, lo, hi, c) if surface else (0.0, 0.0)
                            dx, dy = shift_velocity(cx, cy, near_x, near_y, div_r, u_max, c)
                            S[SX, a], S[SY, a] = dx, dy
                            R[NEW_NX, a], R[NEW_NY, a] = surface_normal(cx, cy, div_r, c)
                row, first, last = next_stretch(start, grid, 0, segments, shares, taken, worker)
            fastest[worker] = relative

    return forces


@inline_njit
def velocity_range(b, lo, hi):
    """Range of the velocities of the candidates [lo, hi) of the buffer, squared [m²/s²]: the diagonal of the smallest
    upright box around them, a bound of the relative speed of any two."""
    u0 = u1 = b[2, lo]
    v0 = v1 = b[3, lo]
    for k in range(np.uint64(lo), np.uint64(hi)):
        u0, u1 = min(u0, b[2, k]), max(u1, b[2, k])
        v0, v1 = min(v0, b[3, k]), max(v1, b[3, k])
    return (u1 - u0) * (u1 - u0) + (v1 - v0) * (v1 - v0)


@inline_njit
def relative_speed(S, mine, end, b, lo, hi, support2):
    """Largest relative speed, squared [m²/s²], between a particle in [mine, end) and a candidate in reach."""
    largest = 0.0
    for a in range(mine, end):
        for k in range(lo, hi):
            rx, ry = S[X, a] - b[0, k], S[Y, a] - b[1, k]
            ux, uy = S[U, a] - b[2, k], S[V, a] - b[3, k]
            largest = max(largest, ux * ux + uy * uy if rx * rx + ry * ry < support2 else 0.0)
    return largest


@inline_njit
def any_surface(b, lo, hi):
    """Whether any candidate in [lo, hi) of the buffer is marked as surface."""
    size = 0.0
    for k in range(lo, hi):
        size += abs(b[8, k]) + abs(b[9, k])
    return size > 0.0


@inline_njit
def sum_of_normals(kernel, xa, ya, b, lo, hi, c):
    """Kernel sum at (xa, ya) of the candidates' surface normals, without the kernel's scale."""
    near_x = near_y = 0.0
    for k in range(lo, hi):
        rx = xa - b[0, k]
        ry = ya - b[1, k]
        w = w_shape(kernel, rx * rx + ry * ry, c.h)
        near_x += w * b[8, k]
        near_y += w * b[9, k]
    return near_x, near_y
