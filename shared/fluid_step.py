"""The time step of a fluid of particles: its limits, and the Courant numbers that were measured.

Least of the acoustic limit C h/(c0 + u), that of sound in a viscous fluid and that of forces C_a √(h/|a|).

Viscous forces are of the velocities half a step before, which makes Euler's forward rule of them: sound of frequency ω
that wears out at the rate λ is stable while (ω Δt/2)² + λ Δt/2 ≤ 1. Hence (Δt/Δt_s)² + Δt/Δt_ν ≤ 1, with Δt_s = C_s
h/(c0 + u) that sound alone bears (map courant: 1.57 ctvf, 1.64 wcsph) and Δt_ν = C_ν h²/ν. λ is at most 8 ν Σ V_b |F|:
C_ν is 0.107, 0.085 and 0.077 or more on a lattice of wendland-c2 with h = 1.3, 2 and 3 dx, and more with
quintic-spline; a checkerboard grows from 0.113 on. Couette flows with Reynolds numbers of 1 and 0.01, shaken at the
start, ran with 0.105 and blew up with 0.125.

u is half the largest relative speed of any two particles in reach of each other, mirrored ones in walls included: the
speed at which they meet, about their mean. Particles move with the flow, so a speed that all share changes nothing: a
jet, or a drop in flight, costs no shorter steps before it strikes. Measured on dam_break_plate, dx 2 mm, after the jet
struck the far wall: largest speed 0.17 to 0.42 c0, u 0.05 to 0.17 c0.

Measured on the dam break against a wall (dam_break_wall, h = 1.3 dx, α 0.1) to 0.7 s, wcsph with dx 4 mm, starts that
differ by 1e-6 dx, u the largest speed: front at 0.19 s, impulse on the far wall to 0.3, 0.5 and 0.7 s [N s/m], energy
left of the first.

    C            0.225          0.9            1.2            1.3            1.4
    front [m]    0.4168         0.4167         0.4168         0.4169         0.4169
    to 0.3 s     8.12, 8.12     8.17 – 8.28    8.10 – 8.18    8.15, 8.22     8.18, 8.20
    to 0.5 s     36.7, 36.7     36.6 – 37.0    36.7 – 36.8    36.8, 36.9     36.8, 36.8
    to 0.7 s     56.4, 56.6     56.2 – 56.7    56.5 – 56.6    56.5, 56.8     56.7, 56.9
    energy       0.856, 0.853   0.856 – 0.857  0.851 – 0.861  0.856, 0.861   0.861, 0.865

Starts spread as far as steps do: the splash is chaotic, the step is not to blame. With u as above, C = 1.3: front
0.4169 m, 7.95, 36.5 and 56.4 N s/m, 0.854; dx 8 and 2 mm run too, and 2 mm with α 0.02 and 0, where energy rises by
0.001 and 0.14 % at most. The map courant_impact finds the same limits with either u.

ctvf, dx 4 mm, C = 0.3 and 0.9, u the largest speed: front 0.4166 m both, impulse to 0.3 s 8.17 both, to 0.5 s 37.3
both, energy left then 0.916 and 0.920; past 1.2 energy rises by up to 0.5 %. With u as above, C = 0.9 and 1.1: 8.15 and
8.18, 37.3 both, 0.919 and 0.917; energy rises by 0.006 % at 1.1.
The lid-driven cavity (50 × 50) is within 0.019 of the lid's speed at 0.8 and 0.9; at 1.0 two runs of three tore off the
lid, 0.05 and 0.23. So 0.9.
"""

from __future__ import annotations

import math

COURANT = {"ctvf": 0.9, "wcsph": 1.3}
"""C that "auto" takes, by model: as right as steps a quarter as long."""
LARGEST_COURANT = {"ctvf": 1.1, "wcsph": 1.4}
"""C up to which dam breaks ran through their impact without gain of energy."""
FORCE_STEP = 0.25  # of √(h/|a|)
VISCOUS_STEP = 0.075  # C_ν, of h²/ν
BORNE = 1.55  # C_s, of h/(c0 + u)


def fluid_step(courant: float, h: float, signal: float, viscosity: float, acceleration: float) -> float:
    """Largest stable step [s] for smoothing length `h` [m], `signal` = c0 + u [m/s], `viscosity` [m²/s] and the
    largest `acceleration` [m/s²]."""
    step = courant * h / signal if signal > 0.0 else math.inf
    if viscosity > 0.0:
        viscous = VISCOUS_STEP * h**2 / viscosity
        sound = max(courant, BORNE) * h / signal if signal > 0.0 else math.inf
        step = min(step, 2.0 * viscous / (1.0 + math.hypot(1.0, 2.0 * viscous / sound)))
    if acceleration > 0.0:
        step = min(step, FORCE_STEP * math.sqrt(h / acceleration))
    return step
