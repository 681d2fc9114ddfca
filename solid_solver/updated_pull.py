"""What keeps a pulled solid whole under the quadratic gradient: more stiffness against strain that varies along a pull.

Let particles stand in a zigzag along a pull σ: at d + H d²/2, d the distance from one to its neighbours. A quadratic
velocity then has, by the distances as they are, a cubic term as well, −H u'' d³/2. The fit reads it as a slope
−T H u''/2 with

    T = Σ w d⁴ / Σ w d²

over the neighbours, and the forces, its transpose, feed the zigzag with the energy V σ T H²/4 that no strain answers
for. Only the stress that varies over a cell resists it, by V² E H²/24. So rows of particles that are pulled past
σ ≈ 0.14 E break up (the tensile instability), those beside rows pulled less a little later: at a clamp's corner first,
and the sooner the finer the rows. The cure resists by what feeds: where Z_k = V/12 C:ε,k, the forces get Z + A,

    A_k = σ₁ T N_kl N ε,l N,   N = σ₊/σ₁

with σ₊ the stress without its pressures and σ₁ its largest value (N = n ⊗ n of a pull along n, N = I of an equal pull
along all directions). Half of A would balance a zigzag's gain to first order; all of it holds a block between clamps to
σ = 0.37 E at least (ν 0 to 0.45). A has an energy of its own, A:∇ε/2. It is no stress of the material: it goes with
dx², and where nothing pulls there is none.

It does not help a free face that its own load pulls at: there the fit rests on the second row's distance alone, by
weights that vanish as it grows. With h = 1.3 dx such a face holds to 0.08 E, with h = 1.5 dx to 0.2 E.
"""

from __future__ import annotations

import math

from shared.jit import inline_njit
from solid_solver.blocks import RUN

_NOTHING = 1.0e-100
"""In place of 0 in a divisor: of a stress [Pa], or of the sums of a particle without neighbours."""


@inline_njit
def pull(xx, xy, yy):
    """σ₁, 0 if the stress has no tension, and N (00, 01, 11)."""
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    radius = math.sqrt(half * half + xy * xy)
    largest = max(0.0, mean + radius)
    share = max(0.0, mean - radius) / max(largest, _NOTHING)
    middle, turn = 0.5 * (1.0 + share), 0.5 * (1.0 - share) / max(radius, _NOTHING)
    return largest, (middle + turn * half, turn * xy, middle - turn * half)


@inline_njit
def spread(d, at, n):
    """T/h² = Σ w (d·N·d)² / Σ w d·N·d; the moments of the fit (see updated_fit.py) stand in `d` from `at` on."""
    a, b, c = n
    fourth = a * a * d[at + 7 * RUN] + 2.0 * a * b * d[at + 8 * RUN] + (4.0 * b * b + 2.0 * a * c) * d[at + 9 * RUN]
    fourth += 2.0 * b * c * d[at + 10 * RUN] + c * c * d[at + 11 * RUN]
    return 4.0 * fourth / max(a * d[at] + 2.0 * b * d[at + RUN] + c * d[at + 2 * RUN], _NOTHING)


@inline_njit
def _strain(xx, xy, yy, share):
    """2G ε of the stress C:ε."""
    of_both = share * (xx + yy)
    return xx - of_both, xy, yy - of_both


@inline_njit
def _within(n, e):
    """N e N."""
    a, b = n[0] * e[0] + n[1] * e[1], n[0] * e[1] + n[1] * e[2]
    c, d = n[1] * e[0] + n[2] * e[1], n[1] * e[1] + n[2] * e[2]
    return a * n[0] + b * n[1], c * n[0] + d * n[1], c * n[1] + d * n[2]


@inline_njit
def _product(e, f):
    return e[0] * f[0] + 2.0 * e[1] * f[1] + e[2] * f[2]


@inline_njit
def pulled(z0, z1, z2, z3, z4, z5, n, k, share):
    """A from Z with k = 12 σ₁ T/(2G V), both as xx, xy, yy of ∂0, then of ∂1; and A:(2G V/12 ∇ε)/2.

    `share`: λ/(2 (λ + G)).
    """
    e, f = _strain(z0, z1, z2, share), _strain(z3, z4, z5, share)
    p, q = _within(n, e), _within(n, f)
    energy = 0.5 * k * (n[0] * _product(p, e) + n[1] * (_product(p, f) + _product(q, e)) + n[2] * _product(q, f))
    a0, a1, a2 = k * (n[0] * p[0] + n[1] * q[0]), k * (n[0] * p[1] + n[1] * q[1]), k * (n[0] * p[2] + n[1] * q[2])
    a3, a4, a5 = k * (n[1] * p[0] + n[2] * q[0]), k * (n[1] * p[1] + n[2] * q[1]), k * (n[1] * p[2] + n[2] * q[2])
    return a0, a1, a2, a3, a4, a5, energy
