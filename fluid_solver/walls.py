"""Ghost particles: what walls and structures show to the fluid, and what the fluid does to them.

Pressure by eq. 14, p_s = [Σ p_f W + (g − a_s)·Σ ρ_f r_sf W] / Σ W, exact for a linear pressure. The ghost's density
follows from it by the equation of state while its volume stays the lattice's, so that its hydrodynamic mass is
ρ_s V_s: with ρ_f V_s instead, constant pressure on compressed water would push at walls.

Density keeps no memory of place, so a lone drop of spray could creep into a wall at no pressure. Hence a floor: a
ghost that fluid has come closer to than `CONTACT` carries at least a pressure that grows as the gap closes. Fluid in
bulk never comes so close, but in splashes and where tension draws it to a corner. A ghost's push on one particle is as
weak as the kernel is wide, and the floor as much higher (parameters.closed_of): with h = 2 dx particles got into floors
and rafts.

Velocity: the fluid's, mirrored at the wall, u_s = ũ − 2 n n·(ũ − u_wall), or 2 u_wall − ũ where it sticks. It enters
the rate of pressure, ∇u and the laminar viscosity. With the wall's own velocity there (Adami et al. 2012), the layer
at the wall would be too soft by half, and the work of the wall pressure not the energy that compression stores: the
period of a standing wave over 30 particles comes out 9 % long. The normal must be the wall's own: one taken from
kernel sums is tilted by disorder, and mirrors a fast flow along the wall into the wall. Structures bend and tell no
normals: there a slipping ghost has the structure's velocity.

The force on a ghost is the sum of the same pair force that the fluid feels, from the ghost's side.
"""

from __future__ import annotations

import math
from functools import cache

import numba

from fluid_solver.fields import (
    AX,
    AY,
    FRICTION,
    NO_SLIP,
    PR2,
    RHO,
    STRUCTURE,
    VOL,
    M,
    P,
    U,
    V,
    X,
    Y,
)
from fluid_solver.forces import pair_force
from fluid_solver.gather import gather, next_stretch, run_of
from fluid_solver.parameters import CONTACT
from shared.jit import inline_njit, parallel_njit
from shared.kernels import f_shape, kernel_w

_ROWS = (X, Y, U, V, M, VOL, PR2, P, RHO)
_ROWS_VELOCITY = (X, Y, U, V)
_LEAST_WEIGHT = 1.0e-6  # Σ V W below which a ghost sees no fluid


@cache
def make_ghost_velocity(kernel: int, viscous: bool):
    """The compiled sweep that mirrors the fluid's velocity at walls; `viscous`: structures are sticky."""

    @parallel_njit
    def ghost_velocity(S, kind, ids, start, grid, segments, shares, taken, buffers, columns, c, first_id, pose):
        """Sets S[U], S[V] of the ghosts. A ghost's own velocity and normal are in `pose` at its id less `first_id`."""
        for worker in numba.prange(taken.size):
            b = buffers[worker]
            row, first, last = next_stretch(start, grid, 1, segments, shares, taken, worker)
            while first < last:
                gather(S, _ROWS_VELOCITY, 1, start, grid, row, first, last, b, columns[worker])
                for column in range(first, last):
                    cell = row * grid.columns + column
                    lo, hi = run_of(columns[worker], column - first)
                    for a in range(start[2 * cell + 1], start[2 * cell + 2]):
                        total = u_sum = v_sum = 0.0
                        xa, ya = S[X, a], S[Y, a]
                        for k in range(lo, hi):
                            rx = xa - b[0, k]
                            ry = ya - b[1, k]
                            w = kernel_w(kernel, rx * rx + ry * ry, c.h)
                            total += w
                            u_sum += b[2, k] * w
                            v_sum += b[3, k] * w
                        sticky = kind[a] == NO_SLIP or (viscous and kind[a] == STRUCTURE)
                        S[U, a], S[V, a] = mirrored(S, a, total, u_sum, v_sum, sticky, pose[ids[a] - first_id])
                row, first, last = next_stretch(start, grid, 1, segments, shares, taken, worker)

    return ghost_velocity


@inline_njit
def mirrored(S, a, total, u_sum, v_sum, sticky, pose):
    """Velocity of ghost `a` from the kernel sums of the fluid's."""
    own_u, own_v, nx, ny = pose[2], pose[3], pose[6], pose[7]
    slips_on_structure = nx == 0.0 and ny == 0.0 and not sticky
    if total * S[VOL, a] < _LEAST_WEIGHT or slips_on_structure:
        return own_u, own_v
    u, v = u_sum / total, v_sum / total
    if sticky:
        return 2.0 * own_u - u, 2.0 * own_v - v
    twice = 2.0 * ((u - own_u) * nx + (v - own_v) * ny)
    return u - twice * nx, v - twice * ny


@cache
def make_ghosts(kernel: int, viscous: bool):
    """The compiled sweep for pressures of ghosts and forces on them."""

    @parallel_njit
    def ghosts(S, ids, start, grid, segments, shares, taken, buffers, columns, c, first_id, force):
        """Sets pressure, density and mass of the ghosts, and their `force` (ghosts, 2) [N/m].

        A ghost's place in `force` is its id less `first_id`.
        """
        alpha_h_c = c.alpha * c.h * c.c0 / c.rho0
        for worker in numba.prange(taken.size):
            b = buffers[worker]
            row, first, last = next_stretch(start, grid, 1, segments, shares, taken, worker)
            while first < last:
                gather(S, _ROWS, 1, start, grid, row, first, last, b, columns[worker])
                for column in range(first, last):
                    cell = row * grid.columns + column
                    lo, hi = run_of(columns[worker], column - first)
                    for a in range(start[2 * cell + 1], start[2 * cell + 2]):
                        extrapolate(S, kernel, a, lo, hi, b, c)
                        fx = fy = 0.0
                        xa, ya, ua, va = S[X, a], S[Y, a], S[U, a], S[V, a]
                        pr2_a, inv_rho_a, friction = S[PR2, a], S[VOL, a] / S[M, a], S[FRICTION, a]
                        for k in range(lo, hi):
                            rx = xa - b[0, k]
                            ry = ya - b[1, k]
                            F = c.slope * f_shape(kernel, rx * rx + ry * ry, c.h)
                            px, py = pair_force(
                                viscous, rx, ry, ua - b[2, k], va - b[3, k],
                                b[4, k], b[5, k], b[6, k], friction, pr2_a, inv_rho_a, F, alpha_h_c, c,
                            )  # fmt: skip
                            fx += px
                            fy += py
                        force[ids[a] - first_id, 0] = S[M, a] * fx
                        force[ids[a] - first_id, 1] = S[M, a] * fy
                row, first, last = next_stretch(start, grid, 1, segments, shares, taken, worker)

    return ghosts


@inline_njit
def extrapolate(S, kernel, a, lo, hi, b, c):
    """Pressure of ghost `a` by eq. 14 from the fluid candidates [lo, hi) of the buffer; density and mass with it."""
    nearest = c.support * c.support
    total = p_sum = x_sum = y_sum = 0.0
    xa, ya = S[X, a], S[Y, a]
    for k in range(lo, hi):
        rx = xa - b[0, k]
        ry = ya - b[1, k]
        r2 = rx * rx + ry * ry
        nearest = min(nearest, r2)
        w = kernel_w(kernel, r2, c.h)
        total += w
        p_sum += b[7, k] * w
        x_sum += b[8, k] * rx * w
        y_sum += b[8, k] * ry * w
    p = 0.0
    if total * S[VOL, a] >= _LEAST_WEIGHT:
        p = (p_sum + (c.gx - S[AX, a]) * x_sum + (c.gy - S[AY, a]) * y_sum) / total
    gap = math.sqrt(nearest) / (CONTACT * c.dx)
    if gap < 1.0:
        p = max(p, c.closed * (1.0 - gap))
    rho = c.rho0 + p / (c.c0 * c.c0)
    S[P, a] = p
    S[RHO, a] = rho
    S[M, a] = rho * S[VOL, a]
    S[PR2, a] = p / (rho * rho)
