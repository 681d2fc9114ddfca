"""One implicit step of a Timoshenko beam in its own frame (axis along x), for any size of rotation.

Two-node elements; the frame of each turns with its mean section angle θ. With X, Y the nodes' differences in position
and h the element's length (Reissner, J. Appl. Math. Phys. 23 (1972) 795, at the element's middle)

    γ1 = (X cos θ + Y sin θ)/h − 1,  γ2 = (−X sin θ + Y cos θ)/h,  κ = (θ2 − θ1)/h,
    energy h/2 (EA γ1² + GA* γ2² + EI κ²),  1/GA* = 1/(κs GA) + h²/(12 EI),

where GA* (MacNeal, Computers & Structures 8 (1978) 175) makes the linear element that of the exact Timoshenko solution:
nodes are exact in statics, whatever h. Inside an element the centreline bulges by h ξ(1 − ξ)(θ1 − θ2)/2 along the normal.

Time: with ¯ the mean of a step's ends, Δ their difference and δ² the difference to the last step's Δ,

    Δq/Δt = v̄ + D δ²v,   M Δv/Δt + η M Δq/Δt + Σ (ε̄ + D δ²ε)·C Δε/Δq = f·Δx/Δq,

Δε/Δq being difference quotients with Δε = (Δε/Δq) Δq to rounding, not derivatives. So energy, raised by
D/2 (Δv·M Δv + Δε·C Δε), changes in each step by the work of loads on their points, less η and less
D/2 (δ²v·M δ²v + δ²ε·C δ²ε): the step cannot blow up, however long. Second order; on a linear mode it is the two-step method of
characteristic polynomials λ² − λ and λ(λ + 1)/2 + D (λ − 1)², which loses the fraction π D (ωΔt)³ of amplitude per period.

Symbols: `q` (n + 1, 3) displacement and section angle at the nodes, `v` their rates, `a` the last step's Δv/Δt, `rate` (n, 3)
the last step's Δε/Δt. A load is (`node` (n + 1, 2): forces at nodes; `couple` (n, 4): G = Σ F d and B = Σ F b of an element's forces
F at offset d from its axis, b the bulge's share: h/8 at the middle, h/12 spread evenly).
"""

from __future__ import annotations

import math

import numpy as np

from shared.jit import njit

DISSIPATION = 0.05
"""D. Modes too fast for the step shrink to 0.57 per step; a mode of 100 steps per period loses 4e-5 per period."""

MOST_ITERATIONS = 30
TOLERANCE = 1.0e-6  # of the thickness: the last Newton correction; what is left is about its square

_SERIES = 1.0e-2  # angle below which sin(x)/x is summed by its series


@njit
def strains(q, h, out):
    """γ1, γ2, κ of all elements into `out` (n, 3)."""
    for e in range(len(out)):
        theta = 0.5 * (q[e, 2] + q[e + 1, 2])
        c, s = math.cos(theta), math.sin(theta)
        fall = -s * s / (1.0 + c) if c > 0.0 else c - 1.0  # cos θ − 1 without cancellation
        du, y = q[e + 1, 0] - q[e, 0], q[e + 1, 1] - q[e, 1]
        out[e, 0] = fall + (c * du + s * y) / h
        out[e, 1] = (c * y - s * du) / h - s
        out[e, 2] = (q[e + 1, 2] - q[e, 2]) / h


@njit
def strain_rates(q, v, h, out):
    """Rates of `strains` under the nodes' velocities `v`."""
    for e in range(len(out)):
        theta, spin = 0.5 * (q[e, 2] + q[e + 1, 2]), 0.5 * (v[e, 2] + v[e + 1, 2])
        c, s = math.cos(theta), math.sin(theta)
        x, y = h + q[e + 1, 0] - q[e, 0], q[e + 1, 1] - q[e, 1]
        dx, dy = v[e + 1, 0] - v[e, 0], v[e + 1, 1] - v[e, 1]
        out[e, 0] = (c * dx + s * dy + spin * (c * y - s * x)) / h
        out[e, 1] = (c * dy - s * dx - spin * (c * x + s * y)) / h
        out[e, 2] = (v[e + 1, 2] - v[e, 2]) / h


@njit
def _quotients(before, after):
    """cos and sin of the new angle, their means, their difference quotients, and those quotients' derivatives."""
    mean, half = 0.5 * (before + after), 0.5 * (after - before)
    c, s, ch, sh = math.cos(mean), math.sin(mean), math.cos(half), math.sin(half)
    if abs(half) < _SERIES:
        square = half * half
        ratio = 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
        slope = -half / 3.0 * (1.0 - square / 10.0 * (1.0 - square / 28.0))
    else:
        ratio = sh / half
        slope = (ch - ratio) / half
    quotient = (-s * ratio, c * ratio)
    derivative = (-0.5 * (c * ratio + s * slope), 0.5 * (c * slope - s * ratio))
    return (c * ch - s * sh, s * ch + c * sh), (c * ch, s * ch), quotient, derivative


@njit
def _element(q0, q1, e, strain0, rate, dt, h, stiffness, couple, force, tangent):
    """Force (4,) on (X, Y, θ, θ2 − θ1) of element `e`, internal less external, and its tangent (4, 4)."""
    blend = 0.5 + DISSIPATION
    before, after = 0.5 * (q0[e, 2] + q0[e + 1, 2]), 0.5 * (q1[e, 2] + q1[e + 1, 2])
    (c, s), (cm, sm), (dc, ds), (ddc, dds) = _quotients(before, after)
    u0, y0 = q0[e + 1, 0] - q0[e, 0], q0[e + 1, 1] - q0[e, 1]
    u1, y1 = q1[e + 1, 0] - q1[e, 0], q1[e + 1, 1] - q1[e, 1]
    phi0, phi1 = q0[e + 1, 2] - q0[e, 2], q1[e + 1, 2] - q1[e, 2]
    x, y = h + 0.5 * (u0 + u1), 0.5 * (y0 + y1)
    fall = -s * s / (1.0 + c) if c > 0.0 else c - 1.0
    stretch = fall + (c * u1 + s * y1) / h
    shear = (c * y1 - s * u1) / h - s
    ea, ga, ei = stiffness
    keep, past = 0.5 - DISSIPATION, DISSIPATION * dt
    normal = ea * (blend * stretch + keep * strain0[e, 0] - past * rate[e, 0])
    across = ga * (blend * shear + keep * strain0[e, 1] - past * rate[e, 1])
    moment = ei * (blend * phi1 / h + keep * strain0[e, 2] - past * rate[e, 2])
    n_x, n_y, n_t = ea * blend * c / h, ea * blend * s / h, ea * blend * shear
    q_x, q_y, q_t = -ga * blend * s / h, ga * blend * c / h, -ga * blend * (1.0 + stretch)
    arm1, arm2 = dc * x + ds * y, dc * y - ds * x
    lever_x, lever_y = couple[0] - 0.5 * (phi0 + phi1) * couple[2], couple[1] - 0.5 * (phi0 + phi1) * couple[3]
    force[0] = cm * normal - sm * across
    force[1] = sm * normal + cm * across
    force[2] = arm1 * normal + arm2 * across + ds * lever_x - dc * lever_y
    force[3] = moment - sm * couple[2] + cm * couple[3]
    tangent[0, 0], tangent[0, 1] = cm * n_x - sm * q_x, cm * n_y - sm * q_y
    tangent[1, 0], tangent[1, 1] = sm * n_x + cm * q_x, sm * n_y + cm * q_y
    tangent[0, 2] = cm * n_t - sm * q_t - 0.5 * (s * normal + c * across)
    tangent[1, 2] = sm * n_t + cm * q_t + 0.5 * (c * normal - s * across)
    tangent[2, 0] = arm1 * n_x + arm2 * q_x + 0.5 * (dc * normal - ds * across)
    tangent[2, 1] = arm1 * n_y + arm2 * q_y + 0.5 * (ds * normal + dc * across)
    tangent[2, 2] = (
        arm1 * n_t + arm2 * q_t + (ddc * x + dds * y) * normal + (ddc * y - dds * x) * across + dds * lever_x - ddc * lever_y
    )
    tangent[2, 3] = 0.5 * (dc * couple[3] - ds * couple[2])
    tangent[3, 2] = -0.5 * (c * couple[2] + s * couple[3])
    tangent[3, 3] = ei * blend / h


@njit
def _scatter(e, force, tangent, residual, diagonal, upper, lower):
    """Add one element's force and tangent to the nodes' residual (n + 1, 3) and its block-tridiagonal matrix."""
    for a in range(2):
        sa = 2.0 * a - 1.0
        residual[e + a, 0] += sa * force[0]
        residual[e + a, 1] += sa * force[1]
        residual[e + a, 2] += 0.5 * force[2] + sa * force[3]
        for b in range(2):
            sb = 2.0 * b - 1.0
            block = diagonal[e + a] if a == b else (upper[e] if a == 0 else lower[e + 1])
            for i in range(2):
                for j in range(2):
                    block[i, j] += sa * sb * tangent[i, j]
                block[i, 2] += 0.5 * sa * tangent[i, 2]
                block[2, i] += 0.5 * sb * tangent[2, i]
            block[2, 2] += (
                0.25 * tangent[2, 2] + 0.5 * (sa * tangent[3, 2] + sb * tangent[2, 3]) + sa * sb * tangent[3, 3]
            )


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
def solve(diagonal, upper, lower, right):
    """Solve a block-tridiagonal system in place of `right` (n, 3); all arrays are used up."""
    inverse, copy = np.empty((3, 3)), np.empty((3, 3))
    turned = np.empty(3)
    for k in range(len(right)):
        if k > 0:
            for i in range(3):
                for j in range(3):
                    part = 0.0
                    for m in range(3):
                        part += lower[k, i, m] * upper[k - 1, m, j]
                    diagonal[k, i, j] -= part
                right[k, i] -= lower[k, i, 0] * right[k - 1, 0] + lower[k, i, 1] * right[k - 1, 1] + lower[k, i, 2] * right[k - 1, 2]
        _inverse(diagonal[k], inverse)
        for i in range(3):
            turned[i] = inverse[i, 0] * right[k, 0] + inverse[i, 1] * right[k, 1] + inverse[i, 2] * right[k, 2]
            for j in range(3):
                copy[i, j] = inverse[i, 0] * upper[k, 0, j] + inverse[i, 1] * upper[k, 1, j] + inverse[i, 2] * upper[k, 2, j]
        upper[k] = copy
        right[k] = turned
    for k in range(len(right) - 2, -1, -1):
        for i in range(3):
            right[k, i] -= upper[k, i, 0] * right[k + 1, 0] + upper[k, i, 1] * right[k + 1, 1] + upper[k, i, 2] * right[k + 1, 2]


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
        _element(q0, q1, e, strain0, rate, dt, h, stiffness, couple[e], force, tangent)
        _scatter(e, force, tangent, residual, diagonal, upper, lower)
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


@njit
def energies(q, v, mass, h, stiffness):
    """Kinetic and strain energy [J/m]."""
    strain = np.empty((len(q) - 1, 3))
    strains(q, h, strain)
    kinetic = 0.0
    for k in range(len(q)):
        for i in range(3):
            kinetic += 0.5 * mass[k, i] * v[k, i] ** 2
    elastic = 0.0
    for e in range(len(strain)):
        for i in range(3):
            elastic += 0.5 * h * stiffness[i] * strain[e, i] ** 2
    return kinetic, elastic
