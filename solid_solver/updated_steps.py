"""Time steps of the updated-Lagrangian solid, and the watch over its pairs.

One step, kick-drift-kick:

    1. u ← half a kick under the loads at its start      2. x ← x + Δt u; fixed particles to where their clamp has them
    3. there, with the displacement Δt u: gradients, ρ, S, fluxes of stress, tracer offsets
    4. accelerations by stress and artificial viscosity   5. u ← half a kick under the loads at its end

Sums over neighbours are made at one place per step, so that forces are the exact transpose of the gradients: internal
forces keep momentum and, where the gradient is exact for linear fields, angular momentum, to rounding.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from shared.jit import ordered_njit, ordered_parallel_njit
from solid_solver.blocks import CHUNK, RUN
from solid_solver.updated_fields import AX, MOVES, U, X, Y
from solid_solver.updated_linear import linear_forces, linear_stress
from solid_solver.updated_quadratic import quadratic_forces, quadratic_stress

CADENCE = 4
"""Steps between looks at the pairs: whether lists are outgrown, whether particles are crowded."""

OUTGROWN, CROWDED = 1, 2
"""What a look at the pairs may find: lists that miss some, particles that are crowded."""

PER_S2, NEAREST2 = range(2)
"""Rows of the gauge: 1/s² with the spacing s that a particle keeps from others; the least r²/s² over its neighbours."""


@ordered_njit
def _kicked(S, blocks, steady, ramped, share, kick):
    """u ← e u + τφ (a + loads) for the particles that move; `kick`: (e, τφ)."""
    total = np.empty(RUN)
    for n in range(blocks.start.size):
        s, count = blocks.start[n], blocks.count[n]
        for i in range(2):
            for l in range(count):
                total[l] = S[AX + i, s + l] + steady[i, s + l]
            for g in range(share.size):
                for l in range(count):
                    total[l] += share[g] * ramped[g, i, s + l]
            for l in range(count):
                u = S[U + i, s + l]
                S[U + i, s + l] = u + S[MOVES, s + l] * ((kick[0] - 1.0) * u + kick[1] * total[l])


@ordered_njit
def _drifted(S, blocks, held, place, dt):
    """x ← x + Δt u; the fixed particles, in slots `held`, go to `place` (2, m) where there is one."""
    for j in range(place.shape[1]):
        for i in range(2):
            S[U + i, held[j]] = (place[i, j] - S[X + i, held[j]]) / dt
    for n in range(blocks.start.size):
        s, count = blocks.start[n], blocks.count[n]
        for i in range(2):
            for l in range(count):
                S[X + i, s + l] += dt * S[U + i, s + l]


@ordered_njit
def _look(n, blocks, S, gauge):
    """Nearest neighbours of block `n` into `gauge`; returns the least squared distance of a watched pair [m²]."""
    s, count = blocks.start[n], blocks.count[n]
    least, apart = np.empty(RUN), np.empty(RUN)
    for l in range(count):
        least[l], apart[l] = math.inf, math.inf
    for k in range(blocks.first[n], blocks.first[n + 1]):
        if blocks.distance[k] != 0:
            p = s + blocks.distance[k]
            for l in range(count):
                r0, r1 = S[X, s + l] - S[X, p + l], S[Y, s + l] - S[Y, p + l]
                least[l] = min(least[l], (r0 * r0 + r1 * r1) * gauge[PER_S2, p + l])
    for k in range(blocks.first_outer[n], blocks.first_outer[n + 1]):
        p = s + blocks.outer[k]
        for l in range(count):
            r0, r1 = S[X, s + l] - S[X, p + l], S[Y, s + l] - S[Y, p + l]
            apart[l] = min(apart[l], r0 * r0 + r1 * r1)
    closest = math.inf
    for l in range(count):
        gauge[NEAREST2, s + l] = least[l]
        closest = min(closest, apart[l])
    return closest


@ordered_njit
def _needs(blocks, S, gauge, closest, reach, crowded):
    """What the last look found, OUTGROWN | CROWDED."""
    found = 0
    for n in range(blocks.start.size):
        if closest[n] < reach * reach:
            found = found | OUTGROWN
        for a in range(blocks.start[n], blocks.start[n] + blocks.count[n]):
            if gauge[NEAREST2, a] < crowded * crowded and S[MOVES, a] > 0.0:
                found = found | CROWDED
    return found


@ordered_parallel_njit
def needs(blocks, S, gauge, closest, reach, crowded):
    """Look at the pairs; returns what they call for, OUTGROWN | CROWDED.

    Nearest neighbours go into `gauge`, and per block the least squared distance of a watched pair into `closest`;
    particles are crowded below the distance `crowded` over s.
    """
    for n in prange(blocks.start.size):
        closest[n] = _look(np.uint64(n), blocks, S, gauge)
    return _needs(blocks, S, gauge, closest, reach, crowded)


@ordered_parallel_njit
def steps(S, blocks, watch, kernel, held, loads, kick, numbers, corrected):
    """Take steps until the loads' shares are used up or the pairs call for something; returns the next step's number.

    `watch`: gauge, closest (blocks,), reach [m], distance over s of a pair that is crowded, which needs are heeded;
    `kernel`: code, h; `held`: slots of the fixed particles, and their places after each step (steps + 1, 2, m), m = 0
    if they stand still; `loads`: steady (2, slots), ramped (g, 2, slots), shares (steps + 1, g); `kick`: (e, τφ) of
    half a step; `numbers`: dt, α h c, material, first step to take; `corrected`: None for the quadratic gradient (the
    other branch is then not compiled), 1 for the linear, 0 for the printed one.
    """
    gauge, closest, reach, crowded, heeded = watch
    code, h = kernel
    slots, places = held
    steady, ramped, shares = loads
    dt, viscosity, material, begin = numbers
    chunks = (blocks.start.size + CHUNK - 1) // CHUNK
    for n in range(begin, shares.shape[0] - 1):
        if n > begin and n % CADENCE == 0:
            for k in prange(blocks.start.size):
                closest[k] = _look(np.uint64(k), blocks, S, gauge)
            if _needs(blocks, S, gauge, closest, reach, crowded) & heeded:
                return n
        _kicked(S, blocks, steady, ramped, shares[n], kick)
        _drifted(S, blocks, slots, places[n + 1], dt)
        if corrected is None:
            for chunk in prange(chunks):
                quadratic_stress(np.uint64(chunk), blocks, S, code, h, material, dt)
            for chunk in prange(chunks):
                quadratic_forces(np.uint64(chunk), blocks, S, code, h, viscosity)
        else:
            for chunk in prange(chunks):
                linear_stress(np.uint64(chunk), blocks, S, code, h, material, dt, corrected)
            for chunk in prange(chunks):
                linear_forces(np.uint64(chunk), blocks, S, code, h, viscosity)
        _kicked(S, blocks, steady, ramped, shares[n + 1], kick)
    return shares.shape[0] - 1
