"""Pre-flight's rules: one number of the scene each, with a verdict, a line of reason and the way out.

A rule takes the scene and its numbers and returns a Finding, or None where it has nothing to look at. A new rule is
one function beside its like (of the water, the structure, the joint of both, the size of all) and one entry of RULES.
What the limits rest on stands beside them.
"""

from __future__ import annotations

from coupler.preflight.finding import Finding, Rule
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.rules.joint import (
    density_ratio,
    drag,
    face_pressures,
    ghost_acceleration,
    helmholtz,
    mass_ratio,
    step_ratio,
    support,
    wall_ends,
    water_holds,
    window_number,
)
from coupler.preflight.rules.plate import (
    across,
    carried_along,
    cauchy,
    courant_solid,
    euler,
    periods_seen,
    poisson,
    pressed,
    printed_gradient,
    slenderness,
)
from coupler.preflight.rules.size import filled_area, filled_gaps, filled_limbs, steps
from coupler.preflight.rules.water import (
    courant_fluid,
    falls_out,
    froude,
    jolt,
    mach,
    neighbours,
    slopes,
    start_up,
    viscosity,
    water_across,
)
from shared.schema.scene import Scene

RULES: tuple[Rule, ...] = (
    mach,
    jolt,
    helmholtz,
    froude,
    slenderness,
    cauchy,
    euler,
    pressed,
    carried_along,
    density_ratio,
    mass_ratio,
    window_number,
    across,
    support,
    wall_ends,
    face_pressures,
    water_holds,
    drag,
    ghost_acceleration,
    step_ratio,
    courant_fluid,
    courant_solid,
    water_across,
    neighbours,
    viscosity,
    falls_out,
    slopes,
    start_up,
    poisson,
    printed_gradient,
    periods_seen,
    filled_area,
    filled_gaps,
    filled_limbs,
    steps,
)


def findings(scene: Scene, numbers: Numbers) -> list[Finding]:
    """What all rules say of a scene."""
    found = (rule(scene, numbers) for rule in RULES)
    return [one for one in found if one is not None]
