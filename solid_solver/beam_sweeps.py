"""One implicit step of a beam whose elements are those of beam_element.py.

Time: with ¯ the mean of a step's ends, Δ their difference and δ² the difference to the last step's Δ,

    Δq/Δt = v̄ + D δ²v,   M Δv/Δt + η M Δq/Δt + Σ (ε̄ + D δ²ε)·C Δε/Δq = f·Δx/Δq,

Δε/Δq being difference quotients, Δε = (Δε/Δq) Δq to rounding, not derivatives. So energy, raised by
D/2 (Δv·M Δv + Δε·C Δε), changes in each step by the work of loads on their points, less that of η and less
D/2 (δ²v·M δ²v + δ²ε·C δ²ε): no step can blow up, however long. Second order; on a linear mode it is the two-step method
of characteristic polynomials λ² − λ and λ(λ + 1)/2 + D (λ − 1)², which loses π D (ωΔt)³ of its amplitude per period.

Symbols: `q`, `v` as there, `a` (n + 1, 3) the last step's Δv/Δt, `rate` (n, 3) the last step's Δε/Δt. A load is a pair:
forces at the nodes (n + 1, 2) and `couple` (n, 4) of the elements.
"""

from __future__ import annotations

import math

import numpy as np

from shared.jit import njit
from solid_solver.beam_element import DISSIPATION, element_forces, scatter, strains

MOST_ITERATIONS = 30
TOLERANCE = 1.0e-6  # of the thickness: the last Newton correction; what is left is about its square


@njit
def _inverse(m, out):
    """Inverse of a 3 × 3 matrix."""
    a = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    b = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    c = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    over = 1.0 / (m[0, 0] * a + m[0, 1] * b + m[0, 2] * c)
    out[0, 0], out[1, 0], out[2, 0] = a * over, b * over, c * over
    out[0, 1] = (m[0, 2] * m[2, 1] - m[0, 1] * m[2, 2]) * over
    out[1, 1] = (m[0, 0] * m[2, 2] - m[0, 2] * m[2, 0]) * over
    out[2, 1] = (m[0, 1] * m[2, 0] - m[0, 0] * m[2, 1]) * over
    out[0, 2] = (m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]) * over
    out[1, 2] = (m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]) * over
    out[2, 2] = (m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]) * over


@njit
def _dot(row, vector):
    return row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2]


@njit
def solve(diagonal, upper, lower, right):
    """Solve a block-tridiagonal system in place of `right` (n, 3); all arrays are used up."""
    inverse, block, part = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for k in range(len(right)):
        if k > 0:
            for i in range(3):
                for j in range(3):
                    diagonal[k, i, j] -= _dot(lower[k, i], upper[k - 1, :, j])
                right[k, i] -= _dot(lower[k, i], right[k - 1])
        _inverse(diagonal[k], inverse)
        for i in range(3):
            part[i] = _dot(inverse[i], right[k])
            for j in range(3):
                block[i, j] = _dot(inverse[i], upper[k, :, j])
        for i in range(3):
            right[k, i] = part[i]
            for j in range(3):
                upper[k, i, j] = block[i, j]
    for k in range(len(right) - 2, -1, -1):
        for i in range(3):
            part[i] = _dot(upper[k, i], right[k + 1])
        for i in range(3):
            right[k, i] -= part[i]


@njit
def _assemble(q0, q1, v, a, strain0, rate, free, mass, h, stiffness, eta, dt, node, couple, system):
    """Residual and tangent of a step's equations at the trial end `q1`, into `system`; clamped nodes stay."""
    residual, diagonal, upper, lower = system
    force, tangent = np.zeros(4), np.zeros((4, 4))
    blend = 0.5 + DISSIPATION
    upper[...] = 0.0
    lower[...] = 0.0
    diagonal[...] = 0.0
    for k in range(len(q0)):
        for i in range(3):
            step = (q1[k, i] - q0[k, i]) / dt
            gain = (step - v[k, i] + DISSIPATION * dt * a[k, i]) / blend
            residual[k, i] = mass[k, i] * (gain / dt + eta * step)
            diagonal[k, i, i] = mass[k, i] * (1.0 / (blend * dt) + eta) / dt
        residual[k, 0] -= node[k, 0]
        residual[k, 1] -= node[k, 1]
    for e in range(len(strain0)):
        element_forces(q0, q1, e, strain0, rate, dt, h, stiffness, couple[e], force, tangent)
        scatter(e, force, tangent, residual, diagonal, upper, lower)
    for k in range(len(q0)):
        if not free[k]:
            residual[k] = 0.0
            diagonal[k] = np.eye(3)
            upper[k] = 0.0
            lower[k] = 0.0


@njit
def _one_step(state, free, mass, h, stiffness, eta, dt, load, work):
    """Advance q, v, a, rate by `dt` under a constant load; the number of Newton iterations, or 0 on failure."""
    q, v, a, rate = state
    node, couple = load
    q1, strain0, strain1, system = work
    strains(q, h, strain0)
    for k in range(len(q)):
        for i in range(3):
            q1[k, i] = q[k, i] + dt * (v[k, i] + 0.5 * dt * a[k, i]) if free[k] else q[k, i]
    length, thickness = h * len(strain0), math.sqrt(12.0 * stiffness[2] / stiffness[0])
    iterations = 0
    for _ in range(MOST_ITERATIONS):
        _assemble(q, q1, v, a, strain0, rate, free, mass, h, stiffness, eta, dt, node, couple, system)
        correction = system[0]
        solve(system[1], system[2], system[3], correction)
        largest = 0.0
        for k in range(len(q)):
            for i in range(3):
                q1[k, i] -= correction[k, i]
            largest = max(largest, abs(correction[k, 0]), abs(correction[k, 1]), abs(length * correction[k, 2]))
        iterations += 1
        if largest < TOLERANCE * thickness:
            break
        if not math.isfinite(largest) or iterations == MOST_ITERATIONS:
            return 0
    for k in range(len(q)):
        for i in range(3):
            gain = ((q1[k, i] - q[k, i]) / dt - v[k, i] + DISSIPATION * dt * a[k, i]) / (0.5 + DISSIPATION)
            v[k, i] += gain
            a[k, i] = gain / dt
            q[k, i] = q1[k, i]
    strains(q, h, strain1)
    for e in range(len(rate)):
        for i in range(3):
            rate[e, i] = (strain1[e, i] - strain0[e, i]) / dt
    return iterations


@njit
def steps(state, free, mass, h, stiffness, eta, dt, steady, ramped, shares):
    """Take one step of `dt` [s] per row of `shares` (m, g), each under steady + Σ share · ramped loads.

    Returns the number of Newton iterations, or 0 where one did not converge.
    """
    count = len(state[0])
    work = (
        np.empty((count, 3)),
        np.empty((count - 1, 3)),
        np.empty((count - 1, 3)),
        (np.empty((count, 3)), np.empty((count, 3, 3)), np.empty((count, 3, 3)), np.empty((count, 3, 3))),
    )
    node, couple = steady[0].copy(), steady[1].copy()
    total = 0
    for m in range(len(shares)):
        node[...] = steady[0]
        couple[...] = steady[1]
        for g in range(shares.shape[1]):
            node += shares[m, g] * ramped[0][g]
            couple += shares[m, g] * ramped[1][g]
        iterations = _one_step(state, free, mass, h, stiffness, eta, dt, (node, couple), work)
        if iterations == 0:
            return 0
        total += iterations
    return total
