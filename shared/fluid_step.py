"""The time step of a fluid of particles: its limits, and the Courant numbers that were measured.

Least of the acoustic limit C h/(c0 + speed), the viscous C_ν h²/ν and that of forces C_a √(h/|a|).

Measured on the dam break against a wall (dam_break_wall, h = 1.3 dx, α 0.1) to 0.7 s, wcsph with dx 4 mm, starts that
differ by 1e-6 dx: front at 0.19 s, impulse on the far wall to 0.3, 0.5 and 0.7 s [N s/m], energy left of the first.

    C            0.225          0.9            1.2            1.3            1.4
    front [m]    0.4168         0.4167         0.4168         0.4169         0.4169
    to 0.3 s     8.12, 8.12     8.17 – 8.28    8.10 – 8.18    8.15, 8.22     8.18, 8.20
    to 0.5 s     36.7, 36.7     36.6 – 37.0    36.7 – 36.8    36.8, 36.9     36.8, 36.8
    to 0.7 s     56.4, 56.6     56.2 – 56.7    56.5 – 56.6    56.5, 56.8     56.7, 56.9
    energy       0.856, 0.853   0.856 – 0.857  0.851 – 0.861  0.856, 0.861   0.861, 0.865

Starts spread as far as steps do: the splash is chaotic, the step is not to blame. wcsph at 1.3 also ran with dx 8 and
2 mm, with α 0, 0.02 (energy rises by 0.05 % at most) and 0.5, and with the quintic spline at h = dx; past 1.5 it failed
at dx 2 mm. ctvf, dx 4 mm, C = 0.2 and 1.0: front 0.4166 and 0.4166 m, impulse to 0.3 s 8.44 and 8.44, to 0.4 s 26.64
and 26.63, to 0.5 s 37.94 and 37.90 N s/m, energy left then 0.920 and 0.919; past 1.2 energy rises by up to 0.5 %.
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
VISCOUS_STEP = 0.125  # of h²/ν


def fluid_step(courant: float, h: float, signal: float, viscosity: float, acceleration: float) -> float:
    """Largest stable step [s] for smoothing length `h` [m], `signal` = c0 + speed [m/s], `viscosity` [m²/s] and the
    largest `acceleration` [m/s²]."""
    step = courant * h / signal if signal > 0.0 else math.inf
    if viscosity > 0.0:
        step = min(step, VISCOUS_STEP * h**2 / viscosity)
    if acceleration > 0.0:
        step = min(step, FORCE_STEP * math.sqrt(h / acceleration))
    return step
