"""Material points of a beam: their motion from the nodes', and their forces as loads of the elements.

A point stands in element e at the fraction ξ of its length and at offset d from the axis:

    x = (1 − ξ) r1 + ξ r2 + (d + b (θ1 − θ2)) n(θ),  θ = (1 − ξ) θ1 + ξ θ2,  n = (−sin θ, cos θ),  b = h ξ (1 − ξ)/2.

Forces go to the nodes by the transpose of the same relation (in beam_sweeps.py), so that their work is that of the nodes.
"""

from __future__ import annotations

import math

from shared.jit import njit


@njit
def motion(q, v, a, h, element, share, offset, axes, displacement, velocity, acceleration):
    """Displacement, velocity and acceleration (m, 2) of points, in place, turned from the beam's frame by `axes`."""
    for p in range(len(element)):
        e, xi, d = element[p], share[p], offset[p]
        first, bulge = 1.0 - xi, 0.5 * h * xi * (1.0 - xi)
        theta = first * q[e, 2] + xi * q[e + 1, 2]
        spin = first * v[e, 2] + xi * v[e + 1, 2]
        turn = first * a[e, 2] + xi * a[e + 1, 2]
        c, s = math.cos(theta), math.sin(theta)
        fall = -s * s / (1.0 + c) if c > 0.0 else c - 1.0
        out = bulge * (q[e, 2] - q[e + 1, 2])
        rise, pull = bulge * (v[e, 2] - v[e + 1, 2]), bulge * (a[e, 2] - a[e + 1, 2])
        arm = d + out
        along, normal = arm * turn + 2.0 * rise * spin, pull - arm * spin * spin
        ux = first * q[e, 0] + xi * q[e + 1, 0] - arm * s
        uy = first * q[e, 1] + xi * q[e + 1, 1] + d * fall + out * c
        vx = first * v[e, 0] + xi * v[e + 1, 0] - rise * s - arm * spin * c
        vy = first * v[e, 1] + xi * v[e + 1, 1] + rise * c - arm * spin * s
        ax = first * a[e, 0] + xi * a[e + 1, 0] - along * c - normal * s
        ay = first * a[e, 1] + xi * a[e + 1, 1] - along * s + normal * c
        for i in range(2):
            displacement[p, i] = axes[0, i] * ux + axes[1, i] * uy
            velocity[p, i] = axes[0, i] * vx + axes[1, i] * vy
            acceleration[p, i] = axes[0, i] * ax + axes[1, i] * ay


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
