"""Pre-flight's rules: one number of the scene each, with a verdict, a line of reason and the way out.

A rule takes the scene and its numbers and returns a Finding, or None where it has nothing to look at. A new rule is
one function and one entry of RULES. What the limits rest on stands beside them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from coupler.preflight_numbers import Numbers
from coupler.preflight_window import expected_plan, expected_window
from shared.fluid_step import COURANT, LARGEST_COURANT
from shared.schema import PARTICLE_MODELS, Domain, Scene

Verdict = Literal["ok", "warn", "refuse"]

STEADY = ("mean",)  # statistics that do not feel how fast sound crosses the water
PARTICLE_FLUIDS = ("ctvf", "wcsph")

MACH_WARN, MACH_REFUSE = 0.2, 0.5  # density varies by Ma²: 4 %, a quarter
MACH_IDLE = 0.02  # five times the usual sound speed, and as many steps, for a density that varies by 0.04 %
HELMHOLTZ_WARN, HELMHOLTZ_REFUSE = 0.8, math.pi / 2.0  # half and all of a quarter wave, where a column resonates
SLENDER_WARN, SLENDER_REFUSE = 5.0, 3.0
CAUCHY_WARN, CAUCHY_REFUSE = 10.0, 1000.0  # dam_break_plate has 2.5 and bends by half its length
MASS_RATIO_WARN = 50.0  # the heaviest water that was run explicitly over its plate: hydrostatic_plate, 15
ALPHA_WARN = 0.08  # see coupler/window.py: 0.07 decays and 0.14 grows on a reflecting column
ALPHA_REFUSE = (2.0, 1.155, 0.709)  # limits of the serial protocol on an absorbing column, by predictor order
ACROSS_WARN, ACROSS_REFUSE = 4.0, 3.0
SUPPORT_WARN, SUPPORT_REFUSE = 1.0, 0.5  # thickness over support: water sees water through the plate below 1
GHOST_INERTIA_WARN = 0.5  # ρ_f dx/(ρ_s t); water_tube bears 0.13, light_gate with 3.3 must leave the term out
STEP_RATIO_WARN = 5000.0  # sub-steps of the solid per fluid step; hydrostatic_plate has 170
SOLID_COURANT_LIMIT = {"total-lagrangian": 0.73, "ctvf": 1.0}
SOLID_COURANT_SAFE = {"total-lagrangian": 0.63, "ctvf": 0.7}
WATER_ACROSS_WARN = 8.0
POISSON_WARN = 0.49
H_OVER_DX = {"wendland-c2": (1.0, 3.0), "quintic-spline": (0.9, 1.6)}  # fewer: noise; more: pairs
H_OVER_DX_FALLING = 1.7  # dam_break_wall at 2.0: 11 to 20 particles in the walls, energy up by 0.3 to 0.9 %


@dataclass(frozen=True)
class Finding:
    """What a rule says: its `value`, the verdict, one line of reason, and the way out where there is need for one."""

    rule: str
    value: float
    verdict: Verdict
    reason: str
    way_out: str = ""


Rule = Callable[[Scene, Numbers], Finding | None]


def _above(value: float, warn: float, refuse: float = math.inf) -> Verdict:
    """Verdict on a number that should be small."""
    return "refuse" if value > refuse else "warn" if value > warn else "ok"


def _below(value: float, warn: float, refuse: float = -math.inf) -> Verdict:
    """Verdict on a number that should be large."""
    slack = 1.0 - 1e-9
    return "refuse" if value < refuse * slack else "warn" if value < warn * slack else "ok"


def _of_particles(n: Numbers) -> bool:
    return n.water is not None and n.water.model in PARTICLE_FLUIDS


def mach(scene: Scene, n: Numbers) -> Finding | None:
    """Largest expected speed over the artificial sound speed."""
    if not _of_particles(n):
        return None
    w = n.water
    if w.sound_speed == 0.0:
        reason = "nothing tells how fast the water will be: no gravity, no initial speed, no moving wall"
        return Finding("Mach", math.nan, "refuse", reason, "give fluid.sound_speed, ten times the largest speed")
    value = w.speed / w.sound_speed
    verdict = _above(value, MACH_WARN, MACH_REFUSE)
    reason = f"up to {w.speed:.3g} m/s at c0 = {w.sound_speed:.3g} m/s: density varies by {100 * value**2:.2g} %"
    if verdict != "ok":
        return Finding("Mach", value, verdict, reason, f"fluid.sound_speed = {10.0 * w.speed:.3g}, or auto")
    if 0.0 < value < MACH_IDLE:
        way_out = f"fluid.sound_speed = {10.0 * w.speed:.3g} takes {0.1 / value:.3g} times fewer steps"
        return Finding("Mach", value, "warn", reason, way_out)
    return Finding("Mach", value, "ok", reason)


def helmholtz(scene: Scene, n: Numbers) -> Finding | None:
    """Depth of the water in radians of sound at the plate's frequency in incompressible water, 2π f H/c0."""
    if n.joint is None or not _of_particles(n) or n.joint.wet_frequency is None or n.water.sound_speed == 0.0:
        return None
    j, w = n.joint, n.water
    value = 2.0 * math.pi * j.wet_frequency * j.depth / w.sound_speed
    wet = f"in incompressible water the plate swings at {j.wet_frequency:.3g} Hz"
    if value <= HELMHOLTZ_WARN:
        return Finding("Helmholtz", value, "ok", f"{wet}; sound crosses the water in time")
    why = (
        f"{wet}, but at c0 = {w.sound_speed:.3g} m/s sound needs {value / (2 * math.pi):.2g} periods to cross "
        f"{j.depth:.3g} m of water: the water takes energy away instead of moving along, and the plate rings near its "
        f"dry {n.plate.frequency:.3g} Hz"
    )
    if scene.goal is not None and scene.goal.statistic in STEADY:
        return Finding("Helmholtz", value, "ok", f"{why}; the goal's mean does not feel it, peaks and periods would")
    needed = w.sound_speed * value / HELMHOLTZ_WARN
    way_out = (
        f"judge a mean (goal.statistic), use fluid.model = column (incompressible), or fluid.sound_speed = "
        f"{needed:.3g}, at {needed / w.sound_speed:.2g} times the cost"
    )
    # Who wants nothing is not refused it; and a splash may pass without the plate's own swing.
    refuse = HELMHOLTZ_REFUSE if scene.goal is not None and w.rests else math.inf
    return Finding("Helmholtz", value, _above(value, HELMHOLTZ_WARN, refuse), why, way_out)


def froude(scene: Scene, n: Numbers) -> Finding | None:
    """Largest expected speed over √(g H): how high the water can jump, and whether the domain holds it."""
    g = math.hypot(*scene.gravity)
    if not _of_particles(n) or g == 0.0:
        return None
    w = n.water
    value = w.speed / math.sqrt(g * w.height)
    rise = w.speed**2 / (2.0 * g)
    reason = f"the fastest water can rise {rise:.3g} m"
    if isinstance(scene.domain, Domain) and scene.gravity[0] == 0.0:
        room = scene.domain.upper[1] - scene.domain.lower[1]
        if rise > room * (1.0 + 1e-9):
            return Finding("Froude", value, "warn", f"{reason}, the domain is {room:.3g} m high", 'domain = "auto"')
    return Finding("Froude", value, "ok", reason)


def slenderness(scene: Scene, n: Numbers) -> Finding | None:
    """Length over thickness of the thinnest body, for the model beam."""
    if n.plate is None or n.plate.model in ("rigid", "spring"):
        return None
    value = n.plate.length / n.plate.thickness
    if n.plate.model != "beam":
        return Finding("slenderness", value, "ok", "particles take any shape")
    verdict = _below(value, SLENDER_WARN, SLENDER_REFUSE)
    way_out = "" if verdict == "ok" else "solid.model = total-lagrangian"
    return Finding("slenderness", value, verdict, f"a beam errs by about 0.75 (t/L)² = {75 / value**2:.2g} %", way_out)


def cauchy(scene: Scene, n: Numbers) -> Finding | None:
    """Deflection over length by linear bending under the scene's loads: load over stiffness."""
    if n.plate is None or n.plate.deflection is None:
        return None
    value = n.plate.deflection / n.plate.length
    reason = f"linear bending would carry the plate {value:.2g} of its length"
    verdict = _above(value, CAUCHY_WARN, CAUCHY_REFUSE)
    way_out = "" if verdict == "ok" else "check the units of solid.youngs_modulus, of loads and of lengths"
    return Finding("Cauchy", value, verdict, reason, way_out)


def mass_ratio(scene: Scene, n: Numbers) -> Finding | None:
    """r = ρ_f H/(ρ_s t): how much water a plate moves; what a lagged exchange feels."""
    if n.joint is None or n.plate.model == "rigid":
        return None
    value, scheme = n.joint.mass_ratio, scene.coupling.scheme
    if n.water.boxed and n.joint.closes:
        limit = 1.0 / (2.0 ** (scene.coupling.predictor + 1) - 1.0)
        reason = f"the plate closes a box of water: an explicit exchange diverges above {limit:.3g}"
        if value > limit and scheme.endswith("explicit"):
            return Finding("mass ratio", value, "refuse", reason, "an implicit scheme with iqn-ils, or scheme = auto")
        return Finding("mass ratio", value, "ok", reason)
    reason = "the water over the plate's area weighs so many plates"
    if value > MASS_RATIO_WARN and scheme.endswith("explicit"):
        return Finding("mass ratio", value, "warn", reason, "an implicit scheme with iqn-ils, or scheme = auto")
    return Finding("mass ratio", value, "ok", reason)


def window_number(scene: Scene, n: Numbers) -> Finding | None:
    """α = ρ_f c0 Δt/(ρ_s t) of the coupling window: how far sound lets a lagged load run ahead."""
    window = expected_window(scene, n)
    if window is None or not _of_particles(n) or n.plate.model == "rigid":
        return None
    value = n.water.density * n.water.sound_speed * window / (n.plate.density * n.plate.thickness)
    reason = f"window {window:.3g} s"
    asked = scene.coupling.scheme if scene.coupling.window != "auto" else expected_plan(scene, n).scheme
    if asked.endswith("implicit"):
        return Finding("window α", value, "ok", f"{reason}, iterated")
    verdict = _above(value, ALPHA_WARN * (1.0 + 1e-9), ALPHA_REFUSE[scene.coupling.predictor])
    way_out = "" if verdict == "ok" else f"coupling.window = {window * ALPHA_WARN / value:.3g} or auto"
    return Finding("window α", value, verdict, f"{reason}, limit {ALPHA_REFUSE[scene.coupling.predictor]:g}", way_out)


def across(scene: Scene, n: Numbers) -> Finding | None:
    """Particles across the thinnest body."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    verdict = _below(n.plate.across, ACROSS_WARN, ACROSS_REFUSE)
    way_out = "" if verdict == "ok" else f"solid.dx = {n.plate.thickness / 6:.3g} gives 6; or solid.model = beam"
    reason = "bending is resolved" if verdict == "ok" else "too few to resolve bending"
    return Finding("particles across", n.plate.across, verdict, reason, way_out)


def support(scene: Scene, n: Numbers) -> Finding | None:
    """The plate's thickness over the fluid kernel's support."""
    if n.plate is None or not _of_particles(n):
        return None
    value = n.plate.thickness / n.water.support
    verdict = _below(value, SUPPORT_WARN, SUPPORT_REFUSE)
    reason = f"support {n.water.support:.3g} m, plate {n.plate.thickness:.3g} m"
    if verdict == "ok":
        return Finding("thickness/support", value, verdict, reason)
    finer = n.water.dx * value
    return Finding(
        "thickness/support", value, verdict, f"{reason}: water sees water through it", f"fluid.dx = {finer:.3g}"
    )


def ghost_acceleration(scene: Scene, n: Numbers) -> Finding | None:
    """ρ_f dx/(ρ_s t): mass of the water between particles and face over the structure's own."""
    if n.joint is None or not _of_particles(n) or n.plate.model == "rigid" or not scene.fluid.structure_acceleration:
        return None
    value = n.water.density * n.water.dx / (n.plate.density * n.plate.thickness)
    verdict = _above(value, GHOST_INERTIA_WARN)
    if verdict == "ok":
        return Finding("ghost acceleration", value, verdict, "the plate outweighs the water of one layer")
    reason = "pressures extrapolated with the acceleration of so light a plate drive it"
    return Finding("ghost acceleration", value, verdict, reason, "fluid.structure_acceleration = false")


def step_ratio(scene: Scene, n: Numbers) -> Finding | None:
    """Fluid step over solid step: the solid's sub-steps."""
    if n.joint is None or not _of_particles(n) or n.plate.model not in PARTICLE_MODELS:
        return None
    value = n.water.step / n.plate.step
    verdict = _above(value, STEP_RATIO_WARN)
    reason = f"{n.water.step:.3g} s over {n.plate.step:.3g} s"
    return Finding("step ratio", value, verdict, reason, "" if verdict == "ok" else "solid.model = beam is implicit")


def courant_fluid(scene: Scene, n: Numbers) -> Finding | None:
    """The fluid's step over h/(c0 + speed), against what was measured to be stable."""
    if not _of_particles(n):
        return None
    value, model = n.water.courant, n.water.model
    verdict = _above(value, COURANT[model], LARGEST_COURANT[model])
    way_out = "" if verdict == "ok" else "fluid.courant = auto"
    return Finding("Courant, fluid", value, verdict, f"up to {LARGEST_COURANT[model]:g} was seen to run", way_out)


def courant_solid(scene: Scene, n: Numbers) -> Finding | None:
    """The solid's step over dx/c_p, against what was measured to be stable."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    model = n.plate.model
    value = n.plate.step * n.plate.wave_speed / scene.solid.dx
    limit = 0.5 if (model, scene.solid.gradient) == ("ctvf", "quadratic") else SOLID_COURANT_LIMIT[model]
    verdict = _above(value, min(SOLID_COURANT_SAFE[model], limit), limit)
    way_out = "" if verdict == "ok" else "solid.courant = auto"
    return Finding("Courant, solid", value, verdict, f"stable up to about {limit:g}", way_out)


def water_across(scene: Scene, n: Numbers) -> Finding | None:
    """Particles across the smallest extent of the water."""
    if not _of_particles(n):
        return None
    value = n.water.width / n.water.dx
    verdict = _below(value, WATER_ACROSS_WARN)
    way_out = "" if verdict == "ok" else f"fluid.dx = {n.water.width / 20:.3g} gives 20"
    return Finding("water across", value, verdict, f"least extent {n.water.width:.3g} m", way_out)


def neighbours(scene: Scene, n: Numbers) -> Finding | None:
    """Smoothing length over spacing: too few neighbours are noise, too many of a spline make pairs."""
    if not _of_particles(n):
        return None
    value, kernel = scene.fluid.h_over_dx, scene.fluid.kernel
    least, most = H_OVER_DX[kernel]
    most = most if n.water.held else min(most, H_OVER_DX_FALLING)
    if least <= value <= most:
        return Finding("h/dx", value, "ok", kernel)
    if value < least:
        return Finding("h/dx", value, "warn", "too few neighbours", "fluid.h_over_dx = 1.3 (quintic-spline: 1.0)")
    pairs = "particles pair up" if kernel == "quintic-spline" else "falling water gets into walls and gains energy"
    return Finding("h/dx", value, "warn", pairs, "fluid.h_over_dx = 1.3 (quintic-spline: 1.0)")


def start_up(scene: Scene, n: Numbers) -> Finding | None:
    """Pressure that is missing at the bottom of water at rest, over what it will carry."""
    if not _of_particles(n) or not n.water.rests or not any(scene.gravity):
        return None
    if scene.fluid.initial_pressure == "hydrostatic":
        return Finding("start-up", 0.0, "ok", "the water starts settled")
    reason = "water at rest starts without its pressure: it falls, and rings between none and twice its weight"
    return Finding("start-up", 1.0, "warn", reason, "fluid.initial_pressure = hydrostatic")


def poisson(scene: Scene, n: Numbers) -> Finding | None:
    """Poisson's ratio near incompressible."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    value = scene.solid.poisson_ratio
    verdict = _above(value, POISSON_WARN)
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


RULES: tuple[Rule, ...] = (
    mach,
    helmholtz,
    froude,
    slenderness,
    cauchy,
    mass_ratio,
    window_number,
    across,
    support,
    ghost_acceleration,
    step_ratio,
    courant_fluid,
    courant_solid,
    water_across,
    neighbours,
    start_up,
    poisson,
    printed_gradient,
)


def findings(scene: Scene, numbers: Numbers) -> list[Finding]:
    """What all rules say of a scene."""
    found = (rule(scene, numbers) for rule in RULES)
    return [one for one in found if one is not None]
