"""Pre-flight's rules of how much there is of a scene: area in particles, time in steps. See findings.py."""

from __future__ import annotations

import math

from coupler.preflight.finding import Finding, above, graded, of_particles
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.shapes import CROWDED, cells, crowding, excess
from shared.geometry.limbs import bearing, fitting
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS

AREA_WARN = 0.02  # of a body's area that its particles hold too much or too little
AREA_EXACT = 5e-5  # of it, below which nothing is said of the difference
LIMB_WARN = 0.1  # of the bending compliance of a body's limbs
STEPS_WARN, STEPS_REFUSE = 1e9, 1e13  # hours of the smallest scene; years
MOST_FILLED = 2e5  # cells of a body that pre-flight fills: with more, the error is far below AREA_WARN


def filled_area(scene: Scene, n: Numbers) -> Finding | None:
    """What the particles of a body hold beyond its area, over the area: of the body where it is most. A rectangle's
    particles always fit."""
    sides = [("fluid", scene.fluid)] if of_particles(n) else []
    sides += [("solid", scene.solid)] if n.plate is not None and n.plate.model != "beam" else []
    shapes = [(side, body, one.dx) for side, one in sides for body in one.bodies if body.rectangle is None]
    small = [(side, body, dx) for side, body, dx in shapes if cells(body, dx) <= MOST_FILLED]
    if not small:
        return None
    value, side, name = max(
        ((excess(body, dx, MOST_FILLED), side, body.name) for side, body, dx in small), key=lambda one: abs(one[0])
    )
    verdict = above(abs(value), AREA_WARN)
    if abs(value) < AREA_EXACT:
        return Finding("filled area", value, "ok", "particles hold the areas of their bodies")
    reason = f"particles of '{name}' hold {100 * abs(value):.2g} % {'more' if value > 0.0 else 'less'} than its area"
    return graded("filled area", value, verdict, reason, f"a smaller {side}.dx")


def filled_limbs(scene: Scene, n: Numbers) -> Finding | None:
    """What a lattice that does not fit a body's limbs makes of their bending: of the body where it is most; nothing to
    say of little."""
    if n.plate is None or n.plate.model not in PARTICLE_MODELS:
        return None
    dx = scene.solid.dx
    body = max(scene.solid.bodies, key=lambda one: abs(bearing(one, dx)))
    value = bearing(body, dx)
    verdict, fits = above(abs(value), LIMB_WARN), fitting(body, dx)
    if verdict == "ok":
        return None
    reason = f"a limb of '{body.name}' is {(1.0 + value) ** (-1.0 / 3.0):.3g} times as thick in particles as it is"
    return Finding(
        "filled limbs", value, verdict, reason, f"solid.dx = {fits:.4g} fits" if fits else "a smaller solid.dx"
    )


def filled_gaps(scene: Scene, n: Numbers) -> Finding | None:
    """By how much rows of fluid particles between two faces are too many or too few; nothing to say of little."""
    if not of_particles(n):
        return None
    dx, bodies = scene.fluid.dx, scene.fluid.bodies
    value = max(crowding(body, dx) for body in bodies)
    if value <= CROWDED:
        return None
    finer = (dx * (1.0 - 0.005 * k) for k in range(1, 120))
    fits = next((one for one in finer if max(crowding(body, one) for body in bodies) < 0.1 * CROWDED), None)
    reason = (
        f"between two faces there are {100.0 * value:.2g} % too many or too few rows of particles: crowded so, water "
        "is stirred even at rest, and gets into walls"
    )
    way_out = f"fluid.dx = {fits:.4g} fits" if fits else "a smaller fluid.dx, or one that divides what is between faces"
    return Finding("filled gaps", value, "warn", reason, way_out)


def steps(scene: Scene, n: Numbers) -> Finding | None:
    """Steps to the end, of the side that takes more of them; nothing to say of fewer than any machine takes."""
    shortest = [side.step for side in (n.water, n.plate) if side is not None and side.step > 0.0]
    value = scene.end_time / min(shortest, default=math.inf)
    verdict = above(value, STEPS_WARN, STEPS_REFUSE)
    if verdict == "ok":
        return None
    reason = f"{value:.2g} steps of {min(shortest):.2g} s to end_time = {scene.end_time:g} s"
    way_out = (
        "check the units of end_time, dx, gravity, motions, stiffness and solid.alpha; larger spacings take fewer steps"
    )
    return Finding("steps", value, verdict, reason, way_out)
