"""One implicit step of a beam whose elements are those of beam_element.py.

Time: with ¯ the mean of a step's ends, Δ their difference and δ² the difference to the last step's Δ,

    Δq/Δt = v̄ + D δ²v,   M Δv/Δt + η M Δq/Δt + Σ (ε̄ + D δ²ε)·C Δε/Δq = f·Δx/Δq,

Δε/Δq being difference quotients, Δε = (Δε/Δq) Δq to rounding, not derivatives. So energy, raised by
D/2 (Δv·M Δv + Δε·C Δε), changes in each step by the work of loads on their points, less that of η and less
D/2 (δ²v·M δ²v + δ²ε·C δ²ε): no step can blow up, however long. Second order; on a linear mode it is the two-step method
of characteristic polynomials λ² − λ and λ(λ + 1)/2 + D (λ − 1)², which loses π D (ωΔt)³ of its amplitude per period.

Symbols: `q`, `v` as there, `a` (n + 1, 3) the last step's Δv/Δt, `rate` (n, 3) the last step's Δε/Δt, `book` (3,) the
work of the loads so far, and the clamps' force in the last step, M Δv/Δt + η M Δq/Δt less the loads. A load is a pair:
forces at the nodes (n + 1, 2) and `couple` (n, 4) of the elements. Clamped nodes go where `ends` has them: (2, 2, 3), q
and v of the first and the last node after the step.
"""

from __future__ import annotations

import math

import numpy as np

from shared.jit import njit
from solid_solver.beam_element import DISSIPATION, cosine_less_one, element_forces, scatter, strains

MOST_ITERATIONS = 60
LARGEST_STRAIN = 0.9  # along and across the axis, past which there is no beam left
LARGEST_TURN = 0.3  # radian: Newton corrections that turn a section farther are shortened
TOLERANCE = 1.0e-6  # of the thickness: the last Newton correction; what is left is about its square


@njit
def _invert(blocks, k, out):
    """Inverse of the 3 × 3 matrix blocks[k, 1] into `out`."""
    m00, m01, m02 = blocks[k, 1, 0, 0], blocks[k, 1, 0, 1], blocks[k, 1, 0, 2]
    m10, m11, m12 = blocks[k, 1, 1, 0], blocks[k, 1, 1, 1], blocks[k, 1, 1, 2]
    m20, m21, m22 = blocks[k, 1, 2, 0], blocks[k, 1, 2, 1], blocks[k, 1, 2, 2]
    a, b, c = m11 * m22 - m12 * m21, m12 * m20 - m10 * m22, m10 * m21 - m11 * m20
    over = 1.0 / (m00 * a + m01 * b + m02 * c)
    out[0, 0], out[1, 0], out[2, 0] = a * over, b * over, c * over
    out[0, 1], out[0, 2] = (m02 * m21 - m01 * m22) * over, (m01 * m12 - m02 * m11) * over
    out[1, 1], out[1, 2] = (m00 * m22 - m02 * m20) * over, (m02 * m10 - m00 * m12) * over
    out[2, 1], out[2, 2] = (m01 * m20 - m00 * m21) * over, (m00 * m11 - m01 * m10) * over


@njit
def solve(blocks, right):
    """Solve the block-tridiagonal system of `scatter` in place of `right` (n, 3); the blocks are used up."""
    inverse, block, part = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for k in range(len(right)):
        if k > 0:
            for i in range(3):
                for m in range(3):
                    below = blocks[k, 0, i, m]
                    right[k, i] -= below * right[k - 1, m]
                    for j in range(3):
                        blocks[k, 1, i, j] -= below * blocks[k - 1, 2, m, j]
        _invert(blocks, k, inverse)
        for i in range(3):
            part[i] = inverse[i, 0] * right[k, 0] + inverse[i, 1] * right[k, 1] + inverse[i, 2] * right[k, 2]
            for j in range(3):
                block[i, j] = 0.0
                for m in range(3):
                    block[i, j] += inverse[i, m] * blocks[k, 2, m, j]
        for i in range(3):
            right[k, i] = part[i]
            for j in range(3):
                blocks[k, 2, i, j] = block[i, j]
    for k in range(len(right) - 2, -1, -1):
        for i in range(3):
            for m in range(3):
                right[k, i] -= blocks[k, 2, i, m] * right[k + 1, m]


@njit
def _assemble(q0, q1, v, a, strain0, rate, free, mass, h, stiffness, eta, dt, node, couple, system):
    """Residual and tangent of a step's equations at the trial end `q1`, into `system`; clamped nodes stay in it."""
    residual, blocks = system
    force, tangent = np.zeros(4), np.zeros((4, 4))
    blend = 0.5 + DISSIPATION
    blocks[...] = 0.0
    for k in range(len(q0)):
        for i in range(3):
            step = (q1[k, i] - q0[k, i]) / dt
            gain = (step - v[k, i] + DISSIPATION * dt * a[k, i]) / blend
            residual[k, i] = mass[k, i] * (gain / dt + eta * step)
            blocks[k, 1, i, i] = mass[k, i] * (1.0 / (blend * dt) + eta) / dt
        residual[k, 0] -= node[k, 0]
        residual[k, 1] -= node[k, 1]
    for e in range(len(strain0)):
        element_forces(q0, q1, e, strain0, rate, dt, h, stiffness, couple, force, tangent)
        scatter(e, force, tangent, residual, blocks)
    for k in range(len(q0)):
        if not free[k]:
            residual[k] = 0.0
            blocks[k] = 0.0
            for i in range(3):
                blocks[k, 1, i, i] = 1.0


@njit
def _keep_book(q, q1, a, dt, mass, eta, node, couple, book):
    """Add the loads' work over a step to book[0]; the clamps' mean force in it into book[1:]. `a`: the step's Δv/Δt."""
    book[1:] = 0.0
    for k in range(len(q)):
        for i in range(2):
            book[0] += node[k, i] * (q1[k, i] - q[k, i])
            book[1 + i] += mass[k, i] * (a[k, i] + eta * (q1[k, i] - q[k, i]) / dt) - node[k, i]
    for e in range(len(couple)):
        for after in range(2):
            at, sign = (q1, 1.0) if after else (q, -1.0)
            theta, bulge = 0.5 * (at[e, 2] + at[e + 1, 2]), at[e, 2] - at[e + 1, 2]
            x, y = couple[e, 0] + bulge * couple[e, 2], couple[e, 1] + bulge * couple[e, 3]
            c, s = math.cos(theta), math.sin(theta)
            fall = cosine_less_one(c, s)
            book[0] += sign * (y * fall - x * s + bulge * couple[e, 3])


@njit
def _one_step(state, free, ends, mass, h, stiffness, eta, dt, load, work):
    """Advance q, v, a, rate, book by `dt` under a constant load; the number of Newton iterations, or 0 where they
    do not converge, or only to a beam torn or crushed."""
    q, v, a, rate, book = state
    node, couple = load
    q1, strain0, strain1, system = work
    strains(q, h, strain0)
    for k in range(len(q)):
        for i in range(3):
            q1[k, i] = q[k, i] + dt * (v[k, i] + 0.5 * dt * a[k, i]) if free[k] else ends[min(k, 1), 0, i]
    length, thickness = h * len(strain0), math.sqrt(12.0 * stiffness[2] / stiffness[0])
    iterations = 0
    for _ in range(MOST_ITERATIONS):
        _assemble(q, q1, v, a, strain0, rate, free, mass, h, stiffness, eta, dt, node, couple, system)
        correction = system[0]
        solve(system[1], correction)
        largest, turn = 0.0, 0.0
        for k in range(len(q)):
            turn = max(turn, abs(correction[k, 2]))
            largest = max(largest, abs(correction[k, 0]), abs(correction[k, 1]), abs(length * correction[k, 2]))
        part = min(1.0, LARGEST_TURN / turn) if turn > 0.0 else 1.0
        for k in range(len(q)):
            for i in range(3):
                q1[k, i] -= part * correction[k, i]
        iterations += 1
        if largest < TOLERANCE * thickness:
            break
        if not math.isfinite(largest) or iterations == MOST_ITERATIONS:
            return 0
    for k in range(len(q)):
        for i in range(3):
            gain = ((q1[k, i] - q[k, i]) / dt - v[k, i] + DISSIPATION * dt * a[k, i]) / (0.5 + DISSIPATION)
            if not free[k]:
                gain = ends[min(k, 1), 1, i] - v[k, i]
            v[k, i] += gain
            a[k, i] = gain / dt
    _keep_book(q, q1, a, dt, mass, eta, node, couple, book)
    for k in range(len(q)):
        for i in range(3):
            q[k, i] = q1[k, i]
    strains(q, h, strain1)
    for e in range(len(rate)):
        if not max(abs(strain1[e, 0]), abs(strain1[e, 1])) < LARGEST_STRAIN:
            return 0
        for i in range(3):
            rate[e, i] = (strain1[e, i] - strain0[e, i]) / dt
    return iterations


@njit
def _sum_loads(load, steady, share, ramped):
    """`load` = `steady` + Σ `share` · `ramped`."""
    for k in range(len(load)):
        for i in range(load.shape[1]):
            total = steady[k, i]
            for g in range(share.size):
                total += share[g] * ramped[g, k, i]
            load[k, i] = total


@njit
def steps(state, clamps, mass, h, stiffness, eta, dt, steady, ramped, shares):
    """Take one step of `dt` [s] per row of `shares` (m, g), each under steady + Σ share · ramped loads.

    `clamps`: which nodes are free (n + 1,), and where the others are after each step (m, 2, 2, 3).

    Returns the number of Newton iterations, or 0 where a step failed.
    """
    free, ends = clamps
    count = len(state[0])
    work = (
        np.empty((count, 3)),
        np.empty((count - 1, 3)),
        np.empty((count - 1, 3)),
        (np.empty((count, 3)), np.empty((count, 3, 3, 3))),
    )
    node, couple = steady[0].copy(), steady[1].copy()
    total = 0
    for m in range(len(shares)):
        _sum_loads(node, steady[0], shares[m], ramped[0])
        _sum_loads(couple, steady[1], shares[m], ramped[1])
        iterations = _one_step(state, free, ends[m], mass, h, stiffness, eta, dt, (node, couple), work)
        if iterations == 0:
            return 0
        total += iterations
    return total
