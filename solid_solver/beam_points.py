"""Material points of a beam: their motion from the nodes', and their forces as loads of the elements.

A point stands in element e at the fraction ξ of its length and at offset d from the axis:

    x = (1 − ξ) r1 + ξ r2 + (d + b (θ1 − θ2)) n(θ),  θ = (1 − ξ) θ1 + ξ θ2,  n = (−sin θ, cos θ),  b = h ξ (1 − ξ)/2.

Forces go to the nodes by the transpose of the same relation (in beam_element.py): their work is that of the nodes.
"""

from __future__ import annotations

import math

from shared.jit import njit
from solid_solver.beam_element import cosine_less_one

TERMS = 6  # of a section: displacement, velocity, acceleration, x and y each


@njit
def sections(q, v, a, h, element, share, axes, centre, slope):
    """Motion of the sections at fractions `share` (k,) of elements `element` (k,), in place: displacement, velocity
    and acceleration (k, 6) are centre + d · slope at offset d, turned from the beam's frame by `axes`."""
    for p in range(len(element)):
        e, xi = element[p], share[p]
        first, bulge = 1.0 - xi, 0.5 * h * xi * (1.0 - xi)
        theta = first * q[e, 2] + xi * q[e + 1, 2]
        spin = first * v[e, 2] + xi * v[e + 1, 2]
        turn = first * a[e, 2] + xi * a[e + 1, 2]
        c, s = math.cos(theta), math.sin(theta)
        fall = cosine_less_one(c, s)
        out = bulge * (q[e, 2] - q[e + 1, 2])
        rise, pull = bulge * (v[e, 2] - v[e + 1, 2]), bulge * (a[e, 2] - a[e + 1, 2])
        along, normal = out * turn + 2.0 * rise * spin, pull - out * spin * spin
        local = (
            first * q[e, 0] + xi * q[e + 1, 0] - out * s,
            first * q[e, 1] + xi * q[e + 1, 1] + out * c,
            first * v[e, 0] + xi * v[e + 1, 0] - rise * s - out * spin * c,
            first * v[e, 1] + xi * v[e + 1, 1] + rise * c - out * spin * s,
            first * a[e, 0] + xi * a[e + 1, 0] - along * c - normal * s,
            first * a[e, 1] + xi * a[e + 1, 1] - along * s + normal * c,
        )
        arm = (-s, fall, -spin * c, -spin * s, spin * spin * s - turn * c, -spin * spin * c - turn * s)
        for k in range(3):
            for i in range(2):
                centre[p, 2 * k + i] = axes[0, i] * local[2 * k] + axes[1, i] * local[2 * k + 1]
                slope[p, 2 * k + i] = axes[0, i] * arm[2 * k] + axes[1, i] * arm[2 * k + 1]


@njit
def spread(centre, slope, section, offset, out):
    """Displacement, velocity and acceleration of points at `offset` (m,) on sections (m,), into `out` (3, m, 2)."""
    for k in range(3):
        for p in range(len(section)):
            for i in range(2):
                out[k, p, i] = centre[section[p], 2 * k + i] + offset[p] * slope[section[p], 2 * k + i]


@njit
def add_forces(force, element, offset, h, axes, node, couple):
    """Add forces (m, 2) [N/m] on points at the middle of their elements to a load, in place."""
    for p in range(len(element)):
        e = element[p]
        fx = axes[0, 0] * force[p, 0] + axes[0, 1] * force[p, 1]
        fy = axes[1, 0] * force[p, 0] + axes[1, 1] * force[p, 1]
        for k in range(2):
            node[e + k, 0] += 0.5 * fx
            node[e + k, 1] += 0.5 * fy
        couple[e, 0] += offset[p] * fx
        couple[e, 1] += offset[p] * fy
        couple[e, 2] += 0.125 * h * fx
        couple[e, 3] += 0.125 * h * fy
