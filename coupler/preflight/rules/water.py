"""Pre-flight's rules of the water alone. See findings.py."""

from __future__ import annotations

import math

from coupler.preflight.bounds.lattice_shear import LOOSEST, shear_moduli, stiff
from coupler.preflight.bounds.ploughed import ploughed
from coupler.preflight.bounds.waves import torn
from coupler.preflight.finding import PUSHES, STEADY, Finding, above, below, graded, of_particles
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import goals_quantity
from coupler.preflight.measures.swing import resounding, sounding
from coupler.preflight.measures.water import LEVEL
from coupler.preflight.rules.joint import HELMHOLTZ_WARN
from shared.expected_speed import shaken_speed, structure_speed, viscous_speed, water_speed
from shared.fluid_step import COURANT, LARGEST_COURANT
from shared.geometry.shakers import shakers
from shared.schema.geometry import Domain
from shared.schema.scene import Scene

MACH_WARN, MACH_REFUSE = 0.2, 0.5  # density varies by Ma²: 4 %, a quarter
JOLT_WARN = 0.3  # of a push
MACH_IDLE = 0.02  # five times the usual sound speed, and as many steps, for a density that varies by 0.04 %
FASTEST_SOUND = 5000.0  # m/s: no liquid's is faster, so that an artificial one above it follows from a wrong number
ARTIFICIAL = 0.05  # of the fluid's own viscosity
CREEPING = 50.0  # Reynolds number below which viscous stress is all there is: a Couette flow at h/dx 1.3 is 10 % low
WORN_OUT = 100.0  # dam_break has 450; a jet of 75 loses half of its energy on a plate
WATER_ACROSS_WARN = 8.0
H_OVER_DX = {"wendland-c2": (1.0, 3.0), "quintic-spline": (0.9, 1.6)}  # fewer: noise; more: pairs
STRESSES = 3.5  # support over dx from which viscous stresses are right in a neighbourhood in disorder
H_OVER_DX_FALLING = 1.7  # dam_break_wall at 2.0: energy up by 0.1 to 0.3 %


def mach(scene: Scene, n: Numbers) -> Finding | None:
    """Largest expected speed over the artificial sound speed, or that of viscous stresses, which press only where
    something stands in the way of the flow: no reason to refuse. Sound far faster than it and swings need is idle."""
    if not of_particles(n):
        return None
    w, viscous = n.water, viscous_speed(scene)
    fastest = max(w.speed, viscous)
    value = fastest / w.sound_speed
    verdict = "refuse" if w.speed > MACH_REFUSE * w.sound_speed else above(value, MACH_WARN)
    most = f"{'shaken as if by' if 0.0 < shaken_speed(scene) == w.speed else 'up to'} {w.speed:.3g} m/s"
    if viscous > w.speed:
        most = f"viscous stresses up to {w.density * viscous**2:.3g} Pa"
    reason = f"{most} at c0 = {w.sound_speed:.3g} m/s: density varies by {100 * value**2:.2g} %"
    if verdict != "ok":
        return Finding("Mach", value, verdict, reason, f"fluid.sound_speed = {10.0 * fastest:.3g}, or auto")
    if w.sound_speed > FASTEST_SOUND:
        why = f"{reason}; sound in water itself runs at 1480 m/s"
        return Finding("Mach", value, "warn", why, "check the units of gravity, motions, velocities and lengths")
    crossed = w.sound_speed * max(sounding(scene, n), resounding(scene, n)) / HELMHOLTZ_WARN
    enough = max(10.0 * fastest, 1.01 * crossed)
    idle = 10.0 * MACH_IDLE * w.sound_speed > enough > 0.0
    if idle and water_speed(scene) > 0.0:  # a structure's start is no bound of what water reaches
        way_out = f"fluid.sound_speed = {enough:.3g} takes {w.sound_speed / enough:.3g} times fewer steps"
        return Finding("Mach", value, "warn", reason, way_out)
    return Finding("Mach", value, "ok", reason)


def froude(scene: Scene, n: Numbers) -> Finding | None:
    """Largest expected speed over √(g H): how high the water can jump, and whether the domain holds it."""
    g = math.hypot(*scene.gravity)
    if not of_particles(n) or g == 0.0:
        return None
    w = n.water
    speed = max(water_speed(scene), structure_speed(scene))
    value = speed / math.sqrt(g * w.height)
    rise = speed**2 / (2.0 * g)
    reason = f"the fastest water can rise {rise:.3g} m"
    if isinstance(scene.domain, Domain) and scene.gravity[0] == 0.0 and not w.pulled:
        room = scene.domain.upper[1] - scene.domain.lower[1]
        if rise > room * (1.0 + 1e-9):
            return Finding("Froude", value, "warn", f"{reason}, the domain is {room:.3g} m high", 'domain = "auto"')
    return Finding("Froude", value, "ok", reason)


def courant_fluid(scene: Scene, n: Numbers) -> Finding | None:
    """The fluid's step over h/(c0 + u), against what was measured to be stable."""
    if not of_particles(n):
        return None
    value, model = n.water.courant, n.water.model
    verdict = above(value, COURANT[model], LARGEST_COURANT[model])
    way_out = "fluid.courant = auto"
    return graded("Courant, fluid", value, verdict, f"up to {LARGEST_COURANT[model]:g} was seen to run", way_out)


def water_across(scene: Scene, n: Numbers) -> Finding | None:
    """Particles across the smallest extent of the water."""
    if not of_particles(n):
        return None
    value = n.water.width / n.water.dx
    verdict = below(value, WATER_ACROSS_WARN)
    way_out = f"fluid.dx = {n.water.width / 20:.3g} gives 20"
    return graded("water across", value, verdict, f"least extent {n.water.width:.3g} m", way_out)


def neighbours(scene: Scene, n: Numbers) -> Finding | None:
    """Smoothing length over spacing: too few neighbours are noise, too many of a spline make pairs."""
    if not of_particles(n):
        return None
    value, kernel = scene.fluid.h_over_dx, scene.fluid.kernel
    least, most = H_OVER_DX[kernel]
    most = most if n.water.held else min(most, H_OVER_DX_FALLING)
    if n.water.waves and stiff(scene):
        waves = (
            f"a lattice under pressure bears shear, {100 * max(shear_moduli(kernel, value)):.2g} % of it here: waves "
            "of its spacing's height are lower by a fifth, at any dx"
        )
        return Finding("h/dx", value, "warn", waves, f"fluid.h_over_dx = {LOOSEST[kernel]} costs about as much")
    if torn(scene, n):
        pulled = "tension clumps particles at the waterline of walls, which then shoot out: the water gains energy"
        cure = "fluid.negative_pressure = none" if scene.fluid.negative_pressure != "none" else "fluid.alpha = 0.02"
        return Finding("h/dx", value, "warn", pulled, f"{cure}, or fluid.model = ctvf")
    if ploughed(scene):
        pressed = "particles that nothing shifts are pressed into what is moved through them: forces jump fivefold"
        return Finding("h/dx", value, "warn", pressed, "fluid.model = ctvf")
    if least <= value <= most:
        return Finding("h/dx", value, "ok", kernel)
    if value < least:
        return Finding("h/dx", value, "warn", "too few neighbours", "fluid.h_over_dx = 1.3 (quintic-spline: 1.0)")
    pairs = "particles pair up" if kernel == "quintic-spline" else "falling water gains energy"
    return Finding("h/dx", value, "warn", pairs, "fluid.h_over_dx = 1.3 (quintic-spline: 1.0)")


def viscosity(scene: Scene, n: Numbers) -> Finding | None:
    """Reynolds number of the flow by its own viscosity, and by the artificial one, ν = α h c0/8: where the artificial
    one counts beside the fluid's own, or wears a jet out, and where own stresses rest on too few neighbours."""
    if not of_particles(n) or n.water.rests:
        return None
    w, own, artificial = n.water, scene.fluid.viscosity, n.water.artificial
    speed = water_speed(scene)
    if speed == 0.0 or own == artificial == 0.0:
        return None
    g = math.hypot(*scene.gravity)
    speed = min(speed, g * w.width**2 / (8.0 * own)) if own > 0.0 and g > 0.0 else speed
    value = speed * w.width / max(own, artificial)
    reason = f"up to {speed:.3g} m/s, {w.width:.3g} m wide, ν = {max(own, artificial):.3g} m²/s"
    if own > 0.0 and artificial > ARTIFICIAL * own:
        why = f"{reason}: artificial viscosity, {artificial:.2g} m²/s, counts beside the fluid's own {own:.3g}"
        return Finding("Reynolds", value, "warn", why, "fluid.alpha = 0")
    if own > 0.0 and value < CREEPING and w.support < STRESSES * w.dx:
        why = f"{reason}: viscous stresses of so few neighbours are a tenth too small, at any dx"
        return Finding("Reynolds", value, "warn", why, "fluid.h_over_dx = 2.0 (1 %), 3.0 (a fraction)")
    if own == 0.0 and value < WORN_OUT:
        why = f"{reason}, all of it artificial: the flow loses its energy on a way of some widths"
        return Finding("Reynolds", value, "warn", why, f"fluid.alpha = {scene.fluid.alpha * value / 500.0:.2g}")
    return Finding("Reynolds", value, "ok", reason)


def jolt(scene: Scene, n: Numbers) -> Finding | None:
    """What a prescribed motion that starts or ends with a jump sets ringing, over its own largest push."""
    if not of_particles(n) or not shakers(scene) or goals_quantity(scene) not in PUSHES:
        return None
    value = max(one.jolt(n.water.sound_speed) for one in shakers(scene))
    reason = "the water rings on by so much of what its largest acceleration presses"
    if value <= JOLT_WARN or scene.goal.statistic in STEADY:
        return Finding("jolt", value, "ok", reason)
    why = f"a prescribed motion starts or ends with a jump of speed or acceleration: {reason}"
    return Finding("jolt", value, "warn", why, "a motion that starts and ends gently, over several crossings of sound")


def falls_out(scene: Scene, n: Numbers) -> Finding | None:
    """Share of the water's lower faces with nothing below."""
    if not of_particles(n) or n.water.bottomless == 0.0:
        return None
    reason = f"under {100 * n.water.bottomless:.0f} % of the water's lower faces there is nothing: it falls out"
    return Finding("nothing below", n.water.bottomless, "warn", reason, "a wall below; gravity points where it should?")


def slopes(scene: Scene, n: Numbers) -> Finding | None:
    """How far the surface of water that the model `still` keeps at rest is from level, over its height."""
    if n.water is None or n.water.model != "still" or not any(scene.gravity):
        return None
    value = n.water.slope / n.water.height
    if n.water.slope <= LEVEL * n.water.dx:
        return Finding("level", value, "ok", "its surface is level")
    reason = f"its surface slopes by {n.water.slope:.3g} m against gravity: water that rests is level"
    return Finding("level", value, "refuse", reason, "a body whose top is level; or fluid.model = wcsph or ctvf")


def start_up(scene: Scene, n: Numbers) -> Finding | None:
    """Pressure that is missing at the bottom of water at rest, over what it will carry."""
    if not of_particles(n) or not n.water.rests or not any(scene.gravity):
        return None
    if scene.fluid.initial_pressure == "hydrostatic":
        return Finding("start-up", 0.0, "ok", "the water starts settled")
    reason = "water at rest starts without its pressure: it falls, and rings between none and twice its weight"
    return Finding("start-up", 1.0, "warn", reason, "fluid.initial_pressure = hydrostatic")
