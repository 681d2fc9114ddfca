"""Pre-flight's rules of the structure alone. See findings.py."""

from __future__ import annotations

import math

from coupler.preflight.bounds.solid import LEAST_PERIODS, PERIODS, not_bounded, periods
from coupler.preflight.finding import Finding, above, below, graded
from coupler.preflight.measures.held import damping_drag
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import of_a_body, plates_body
from coupler.preflight.measures.pressed import AT_ONCE, MOST
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS, RIGID_MODELS
from shared.solid_step import LARGEST_UPDATED_COURANT, LATTICE_LIMIT, LATTICE_SHARE, UPDATED_COURANT

SLENDER_WARN, SLENDER_REFUSE = 5.0, 3.0
CAUCHY_WARN, CAUCHY_REFUSE = 30.0, 1000.0  # dam_break_plate has 2.5, dam_break_gate 15: both bend by half their length
ACROSS_WARN, ACROSS_REFUSE = 4.0, 3.0
POISSON_WARN = 0.49  # as far as it was tried
EULER_SAID, EULER_WARN = 0.5, 0.9  # of Euler's load
DRAG_WARN = 0.1  # of a body's weight and inertia
STRAIN_SAID, STRAIN_WARN = 0.05, 0.1


def slenderness(scene: Scene, n: Numbers) -> Finding | None:
    """Length over thickness of the plate, for the model beam."""
    if n.plate is None or n.plate.model in RIGID_MODELS:
        return None
    value = n.plate.length / n.plate.thickness
    if n.plate.model != "beam":
        return Finding("slenderness", value, "ok", "particles take any shape")
    verdict = below(value, SLENDER_WARN, SLENDER_REFUSE)
    way_out = "solid.model = total-lagrangian"
    return graded("slenderness", value, verdict, f"a beam errs by about 0.25 (t/L)² = {25 / value**2:.2g} %", way_out)


def cauchy(scene: Scene, n: Numbers) -> Finding | None:
    """Deflection over length by linear bending under the scene's loads: load over stiffness."""
    if n.plate is None or n.plate.deflection is None:
        return None
    value = n.plate.deflection / n.plate.length
    reason = f"linear bending would carry the plate {value:.2g} of its length"
    verdict = above(value, CAUCHY_WARN, CAUCHY_REFUSE)
    way_out = "check the units of solid.youngs_modulus, of loads and of lengths"
    return graded("Cauchy", value, verdict, reason, way_out)


def euler(scene: Scene, n: Numbers) -> Finding | None:
    """What presses a cantilever along its length over the load that buckles it; nothing to say of less than half."""
    if n.plate is None or n.plate.squeeze <= EULER_SAID:
        return None
    value = n.plate.squeeze
    verdict = above(value, EULER_WARN)
    reason = "it buckles" if value >= 1.0 else f"errors of stiffness count {1.0 / (1.0 - value):.3g} times in bending"
    return graded("Euler", value, verdict, reason, "less load along it, or a stiffer plate")


def pressed(scene: Scene, n: Numbers) -> Finding | None:
    """What presses a body towards its clamp over its modulus, or pulls it; nothing to say of less than a twentieth."""
    if n.plate is None or abs(n.plate.strain) <= STRAIN_SAID:
        return None
    value = abs(n.plate.strain)
    pushed = "pressed" if n.plate.strain < 0.0 else "pulled"
    gives = n.plate.model == "total-lagrangian" and n.plate.strain < 0.0
    verdict = above(value, STRAIN_WARN, MOST if gives else math.inf)
    reason = f"{pushed} by {value:.2g} of its modulus along the way to its clamp, where laws of models part"
    if gives and value > STRAIN_WARN:
        reason += f"; total-lagrangian's gives way at {MOST:.2g}, at {AT_ONCE:.2g} of what comes at once"
    way_out = f"less load, or a stiffer body{'; or solid.model = ctvf' if gives else ''}"
    return graded("strain", value, verdict, reason, way_out)


def across(scene: Scene, n: Numbers) -> Finding | None:
    """Particles across the thinnest body."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    verdict = below(n.plate.fewest, ACROSS_WARN, ACROSS_REFUSE)
    way_out = f"solid.dx = {n.plate.thinnest / 6:.3g} gives 6; or solid.model = beam"
    reason = "bending is resolved" if verdict == "ok" else "too few to resolve bending"
    return graded("particles across", n.plate.fewest, verdict, reason, way_out)


def courant_solid(scene: Scene, n: Numbers) -> Finding | None:
    """The solid's step over dx/c_p, against what was measured to be stable."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    gradient = scene.solid.gradient
    value = n.plate.step * n.plate.wave_speed / scene.solid.dx
    if n.plate.model == "ctvf":
        safe, limit = UPDATED_COURANT[gradient], LARGEST_UPDATED_COURANT[gradient]
    else:
        safe, limit = LATTICE_SHARE * LATTICE_LIMIT, LATTICE_LIMIT
    verdict = above(value, safe * (1.0 + 1e-9), limit)
    way_out = "solid.courant = auto"
    return graded("Courant, solid", value, verdict, f"stable up to about {limit:g}", way_out)


def carried_along(scene: Scene, n: Numbers) -> Finding | None:
    """The drag of solid.damping on a body that its clamps carry along; nothing to say of bodies whose clamps stay."""
    value = 0.0 if n.plate is None else damping_drag(scene, plates_body(scene, n.plate))
    if value == 0.0:
        return None
    verdict = above(value, DRAG_WARN)
    reason = f"solid.damping brakes what clamps carry along, by {value:.2g} of its weight and inertia"
    return graded("damping drag", value, verdict, reason, "a smaller solid.damping, or 0")


def poisson(scene: Scene, n: Numbers) -> Finding | None:
    """Poisson's ratio near incompressible."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    value = scene.solid.poisson_ratio
    verdict = above(value, POISSON_WARN)
    if verdict == "ok":
        return Finding("Poisson's ratio", value, verdict, "tried up to 0.49")
    return Finding("Poisson's ratio", value, verdict, "pressure locks bending and shortens the step", "at most 0.49")


def printed_gradient(scene: Scene, n: Numbers) -> Finding | None:
    """The updated-Lagrangian gradient as printed is neither accurate nor whole under tension."""
    if n.plate is None or n.plate.model != "ctvf":
        return None
    order = {"printed": 0, "linear": 1, "quadratic": 2}[scene.solid.gradient]
    if order:
        return Finding("gradient order", order, "ok", f"gradient {scene.solid.gradient}")
    reason = "the printed gradient is 40 % soft at ten across and breaks under tension"
    return Finding("gradient order", order, "warn", reason, "solid.gradient = linear or quadratic")


def periods_seen(scene: Scene, n: Numbers) -> Finding | None:
    """Periods of the plate's swing until the end, where the goal is a period of it."""
    if n.plate is None or scene.goal is None or scene.goal.statistic not in PERIODS or not of_a_body(scene):
        return None
    value = periods(scene, n)
    if value is None:
        return None
    if value >= LEAST_PERIODS:
        return Finding("periods seen", value, "ok", f"two or more show a {scene.goal.statistic}")
    reason, _, way_out = not_bounded(scene, n).partition("; ")
    return Finding("periods seen", value, "refuse", reason, way_out)
