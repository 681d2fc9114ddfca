"""The element of a Timoshenko beam in the beam's own frame (axis along x), for any size of rotation.

Two nodes; the element's frame turns with its mean section angle θ. With X, Y the nodes' differences in position and h
the element's length (Reissner, J. Appl. Math. Phys. 23 (1972) 795, at the element's middle)

    γ1 = (X cos θ + Y sin θ)/h − 1,  γ2 = (−X sin θ + Y cos θ)/h,  κ = (θ2 − θ1)/h,
    energy h/2 (EA γ1² + GA* γ2² + EI κ²),  1/GA* = 1/(κs GA) + h²/(12 EI),

where GA* (MacNeal, Computers & Structures 8 (1978) 175) makes the linear element that of the exact Timoshenko solution:
nodes are exact in statics, whatever h. Inside, the centreline bulges by h ξ(1 − ξ)(θ1 − θ2)/2 along its normal.

Symbols: `q` (n + 1, 3) displacement and section angle at the nodes, `v` their rates. An element's external forces F,
at offset d from its axis, count by `couple` (4,): G = Σ F d and B = Σ F b, b the bulge's share: h/8 for a force at the
middle, h/12 for one spread evenly.
"""

from __future__ import annotations

import math

import numpy as np

from shared.jit import inline_njit, njit

DISSIPATION = 0.05
"""D of beam_sweeps.py. Modes too fast for the step shrink to 0.57 per step; one of 100 steps per period loses 4e-5
of its amplitude per period."""

_SERIES = 1.0e-2  # angle below which sin(x)/x is summed by its series


@inline_njit
def cosine_less_one(c, s):
    """cos θ − 1 without cancellation, from cos θ and sin θ."""
    return -s * s / (1.0 + c) if c > 0.0 else c - 1.0


@njit
def strains(q, h, out):
    """γ1, γ2, κ of all elements into `out` (n, 3)."""
    for e in range(len(out)):
        theta = 0.5 * (q[e, 2] + q[e + 1, 2])
        c, s = math.cos(theta), math.sin(theta)
        fall = cosine_less_one(c, s)
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
def element_forces(q0, q1, e, strain0, rate, dt, h, stiffness, couple, force, tangent):
    """Force (4,) on (X, Y, θ, θ2 − θ1) of element `e`, internal less external, and its tangent (4, 4)."""
    blend = 0.5 + DISSIPATION
    before, after = 0.5 * (q0[e, 2] + q0[e + 1, 2]), 0.5 * (q1[e, 2] + q1[e + 1, 2])
    (c, s), (cm, sm), (dc, ds), (ddc, dds) = _quotients(before, after)
    u0, y0 = q0[e + 1, 0] - q0[e, 0], q0[e + 1, 1] - q0[e, 1]
    u1, y1 = q1[e + 1, 0] - q1[e, 0], q1[e + 1, 1] - q1[e, 1]
    phi0, phi1 = q0[e + 1, 2] - q0[e, 2], q1[e + 1, 2] - q1[e, 2]
    x, y = h + 0.5 * (u0 + u1), 0.5 * (y0 + y1)
    fall = cosine_less_one(c, s)
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
    lever_x, lever_y = (
        couple[e, 0] - 0.5 * (phi0 + phi1) * couple[e, 2],
        couple[e, 1] - 0.5 * (phi0 + phi1) * couple[e, 3],
    )
    force[0] = cm * normal - sm * across
    force[1] = sm * normal + cm * across
    force[2] = arm1 * normal + arm2 * across + ds * lever_x - dc * lever_y
    force[3] = moment - sm * couple[e, 2] + cm * couple[e, 3]
    tangent[0, 0], tangent[0, 1] = cm * n_x - sm * q_x, cm * n_y - sm * q_y
    tangent[1, 0], tangent[1, 1] = sm * n_x + cm * q_x, sm * n_y + cm * q_y
    tangent[0, 2] = cm * n_t - sm * q_t - 0.5 * (s * normal + c * across)
    tangent[1, 2] = sm * n_t + cm * q_t + 0.5 * (c * normal - s * across)
    tangent[2, 0] = arm1 * n_x + arm2 * q_x + 0.5 * (dc * normal - ds * across)
    tangent[2, 1] = arm1 * n_y + arm2 * q_y + 0.5 * (ds * normal + dc * across)
    tangent[2, 2] = arm1 * n_t + arm2 * q_t + (ddc * x + dds * y) * normal + (ddc * y - dds * x) * across
    tangent[2, 2] += dds * lever_x - ddc * lever_y
    tangent[2, 3] = 0.5 * (dc * couple[e, 3] - ds * couple[e, 2])
    tangent[3, 2] = -0.5 * (c * couple[e, 2] + s * couple[e, 3])
    tangent[3, 3] = ei * blend / h


@njit
def scatter(e, force, tangent, residual, blocks):
    """Add one element's force and tangent to the nodes' `residual` (n + 1, 3) and their matrix: `blocks`
    (n + 1, 3, 3, 3) of node k with nodes k − 1, k, k + 1."""
    for a in range(2):
        sa = 2.0 * a - 1.0
        residual[e + a, 0] += sa * force[0]
        residual[e + a, 1] += sa * force[1]
        residual[e + a, 2] += 0.5 * force[2] + sa * force[3]
        for b in range(2):
            sb, at = 2.0 * b - 1.0, 1 + b - a
            for i in range(2):
                for j in range(2):
                    blocks[e + a, at, i, j] += sa * sb * tangent[i, j]
                blocks[e + a, at, i, 2] += 0.5 * sa * tangent[i, 2]
                blocks[e + a, at, 2, i] += 0.5 * sb * tangent[2, i]
            corner = 0.25 * tangent[2, 2] + sa * sb * tangent[3, 3]
            blocks[e + a, at, 2, 2] += corner + 0.5 * (sa * tangent[3, 2] + sb * tangent[2, 3])


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
