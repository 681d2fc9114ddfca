"""Pre-flight's rules of what water and structure are to each other. See findings.py."""

from __future__ import annotations

import math

from coupler.preflight.bounds.lattice import MANY_NEIGHBOURS, lattice_hold
from coupler.preflight.finding import COLUMN, STEADY, Finding, above, below, graded, of_particles
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.swing import RADIATES, carries_sound, dragged, resounding, sounding
from coupler.preflight.measures.wall_ends import open_ends
from coupler.preflight.measures.window import GROWTH_WARN, expected_plan, expected_window, lag_growth, window_alpha
from coupler.stability.theory import incompressible, largest_stable
from coupler.window import largest_alpha
from shared.geometry.thin_bodies import thin_bodies
from shared.ghost_inertia import ghost_inertia, ghosts_feel_acceleration, largest_inertia
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS

HELMHOLTZ_WARN, HELMHOLTZ_REFUSE = 0.8, RADIATES  # half and all of a quarter wave, where a column resonates
DENSITY_RATIO = (0.009, 100.0)  # polystyrene foam in water 0.015, tungsten in it 19
MASS_RATIO_WARN = 50.0  # the heaviest water that was run explicitly over its plate: hydrostatic_plate, 15
ALPHA_WARN = 8.0 / 7.0  # of the largest of automatic windows; 0.07 decays and 0.14 grows on a reflecting column
ALPHA_REFUSE = {"serial": (2.0, 1.155, 0.709), "parallel": (0.667, 0.252, 0.078)}
"""Limits on an absorbing column, by predictor order: coupler/stability/theory.py."""
GROWTH_REFUSE = 1e16  # times that lag makes a swing on a column grow: rounding becomes all there is
LEAST_WINDOWS = 10.0
"""Iterated windows in a swing; refused below one: a peak is 1 % off at 6, a mean 4 % at a third of one (floors)."""
SUPPORT_WARN, SUPPORT_REFUSE = 1.0, 0.5  # thickness over support: water sees water through the plate below 1
DRAG_WARN = 0.05  # damping ratio; a peak is 8 % low
HELD_WARN = 0.05  # cantilever_in_water is bound by 0.03
STEP_RATIO_WARN = 5000.0  # sub-steps of the solid per fluid step; hydrostatic_plate has 170


def helmholtz(scene: Scene, n: Numbers) -> Finding | None:
    """Depth of the water in radians of sound at the plate's frequency in incompressible water, 2π f H/c0."""
    if n.joint is None or not of_particles(n) or n.joint.wet_frequency is None:
        return _resounds(scene, n)
    j, w = n.joint, n.water
    value = sounding(scene, n)
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
    # Columns are offered where their bound can reach the goal.
    column = scene.goal is None or (w.rests and scene.goal.error >= COLUMN)
    ways = ["judge a mean (goal.statistic)", *(["use fluid.model = column (incompressible)"] if column else [])]
    way_out = ", ".join(ways) + f", or {_faster_sound(w.sound_speed, value / HELMHOLTZ_WARN)}"
    # Who wants nothing is not refused it; and a splash may pass without the plate's own swing.
    refuse = HELMHOLTZ_REFUSE if scene.goal is not None and w.rests else math.inf
    return Finding("Helmholtz", value, above(value, HELMHOLTZ_WARN, refuse), why, way_out)


def _resounds(scene: Scene, n: Numbers) -> Finding | None:
    """The same of a sprung body that water flows round, in water whose own sound may swing along."""
    value = resounding(scene, n)
    if value <= HELMHOLTZ_WARN or scene.goal is None or scene.goal.statistic in STEADY:
        return None
    reason = f"the {n.plate.name} swings nearly as slowly as the water's own sound, c0 = {n.water.sound_speed:.3g} m/s"
    return Finding("Helmholtz", value, "warn", reason, _faster_sound(n.water.sound_speed, value / HELMHOLTZ_WARN))


def _faster_sound(now: float, times: float) -> str:
    """The way out that sound `times` as fast is, rounded up, and what it costs."""
    digit = 10.0 ** (math.floor(math.log10(now * times)) - 2)
    needed = digit * math.ceil(now * times / digit)
    more = f"{needed / now:.2g} times" if needed > 1.2 * now else f"{100.0 * (needed / now - 1.0):.1g} % more than"
    return f"fluid.sound_speed = {needed:.3g} (now {now:.4g}; limit {HELMHOLTZ_WARN:g}), at {more} the cost"


def mass_ratio(scene: Scene, n: Numbers) -> Finding | None:
    """r = ρ_f H/(ρ_s t): how much water a plate moves; what a lagged exchange feels, but of water at rest, which has
    no mass."""
    if n.joint is None or n.plate.model == "rigid":
        return None
    value, scheme = n.joint.mass_ratio, scene.coupling.scheme
    column = n.water.model == "column" and not scene.fluid.column.compressible
    if column or (n.water.boxed and n.joint.closes):
        protocol = scheme if scheme.endswith("explicit") else "serial-explicit"
        limit = largest_stable(lambda r: incompressible(r, scene.coupling.predictor, protocol), 4.0)
        what = "a column moves as one" if column else "the plate closes a box of water"
        reason = f"{what}: an explicit exchange diverges above {limit:.3g}"
        if value > limit and scheme.endswith("explicit"):
            return Finding("mass ratio", value, "refuse", reason, "an implicit scheme with iqn-ils, or scheme = auto")
        return Finding("mass ratio", value, "ok", reason)
    reason = "the water over the plate's area weighs so many plates"
    if value > MASS_RATIO_WARN and scheme.endswith("explicit") and n.water.model != "still":
        return Finding("mass ratio", value, "warn", reason, "an implicit scheme with iqn-ils, or scheme = auto")
    return Finding("mass ratio", value, "ok", reason)


def density_ratio(scene: Scene, n: Numbers) -> Finding | None:
    """Structure's density over the fluid's, where it counts: far from that of any solid in a liquid is a wrong unit."""
    if n.joint is None or n.plate.model == "rigid":
        return None
    value, (least, most) = n.plate.density / n.water.density, DENSITY_RATIO
    reason = f"{n.plate.density:g} over {n.water.density:g} kg/m³"
    if least <= value <= most:
        return Finding("density ratio", value, "ok", reason)
    way_out = "check the units of both densities: water has 1000 kg/m³, steel 7850"
    return Finding("density ratio", value, "warn", f"{reason}: no solid in a liquid has such a one", way_out)


def window_number(scene: Scene, n: Numbers) -> Finding | None:
    """α = ρ_f c0 Δt/(ρ_s t) of the coupling window: how far sound lets a lagged load run ahead."""
    window = expected_window(scene, n)
    if window is None or not carries_sound(scene) or n.plate.model == "rigid":
        return None
    value = window_alpha(n, window)
    reason = f"window {window:.3g} s"
    asked = expected_plan(scene, n).scheme
    if asked.endswith("implicit"):
        held = scene.coupling.window != "auto" and n.plate.frequency is not None
        seen = 1.0 / (n.plate.frequency * window) if held else math.inf
        if seen >= LEAST_WINDOWS:
            return Finding("window α", value, "ok", f"{reason}, iterated")
        few = f"{reason}, iterated: {seen:.2g} windows in a swing of the {n.plate.name}"
        way_out = f"coupling.window = {window * seen / LEAST_WINDOWS:.3g} or auto"
        return Finding("window α", value, below(seen, LEAST_WINDOWS, 1.0), few, way_out)
    if n.water.model == "column":
        return _lagged_on_column(scene, n, value, reason)
    limit = ALPHA_REFUSE["parallel" if asked.startswith("parallel") else "serial"][scene.coupling.predictor]
    most = min(ALPHA_WARN * largest_alpha(asked, scene.coupling.predictor), 0.9 * limit)
    verdict = above(value, most * (1.0 + 1e-9), limit)
    way_out = f"coupling.window = {window * most / value:.3g} or auto"
    return graded("window α", value, verdict, f"{reason}, limit {limit:g}", way_out)


def _lagged_on_column(scene: Scene, n: Numbers, value: float, reason: str) -> Finding:
    """What is known of columns: by how much lag makes a swing grow until the end."""
    grown = lag_growth(scene, n)
    verdict = above(grown, math.log(GROWTH_WARN), math.log(GROWTH_REFUSE))
    if verdict == "refuse" and scene.coupling.scheme == "auto":
        verdict = "warn"  # which leaves it when it sees it
    often = "without end" if grown == math.inf else f"10^{grown / math.log(10.0):.2g} times until the end"
    way_out = "coupling.scheme = serial-implicit, or a much shorter coupling.window"
    return graded("window α", value, verdict, f"{reason}: lag makes a swing on the column grow {often}", way_out)


def support(scene: Scene, n: Numbers) -> Finding | None:
    """The thinnest body's thickness over the fluid kernel's support; of one between two waters, and of pressures over
    faces, which columns and water at rest tell at points dx apart, that of the run's own refusal."""
    faced = n.joint is not None and scene.coupling.loads == "pressure"  # over faces that feel their own side alone
    if n.plate is None or not (of_particles(n) or faced):
        return None
    reach = n.water.support if of_particles(n) else n.water.dx
    for name, thickness, both in thin_bodies(scene) if of_particles(n) else ():
        if both:
            reason = f"{name!r} is {thickness:.3g} m thick, water on both faces: the net load is up to a quarter off"
            way_out = f"fluid.dx = {0.5 * thickness:.3g}"
            return Finding("thickness/support", thickness / reach, "refuse", reason, way_out)
    value = n.plate.thinnest / reach
    verdict = below(value, SUPPORT_WARN, SUPPORT_WARN if faced else SUPPORT_REFUSE)
    reason = f"support {reach:.3g} m, plate {n.plate.thinnest:.3g} m"
    if verdict == "ok":
        return Finding("thickness/support", value, verdict, reason)
    finer = n.water.dx * value
    way_out = f"fluid.dx = {finer:.3g}" + (", or coupling.loads = force" if faced else "")
    return Finding("thickness/support", value, verdict, f"{reason}: water sees water through it", way_out)


def wall_ends(scene: Scene, n: Numbers) -> Finding | None:
    """Walls that stop at a body's corner with nothing behind it."""
    found = list(open_ends(scene))
    if not found:
        return None
    wall, body, (x, y) = found[0]
    reason = f"{wall!r} stops at {body!r} near ({x:.4g}, {y:.4g}), nothing is behind: water is stirred there, and leaks"
    way_out = f"let the wall run on behind {body!r} by {n.water.support:.3g} m"
    return Finding("open wall ends", len(found), "warn", reason, way_out)


def face_pressures(scene: Scene, n: Numbers) -> Finding | None:
    """Sides with water of a structure that integrates pressures of particles over its faces."""
    if n.joint is None or not of_particles(n) or scene.coupling.loads != "pressure" or n.plate.model == "rigid":
        return None
    value = float(n.plate.wet)
    if value < 2.0:
        return Finding("face pressures", value, "ok", "sides with water: pressures are integrated over one")
    reason = "sides with water: the net of pressures beside particles is a small difference, and may be nothing like it"
    return Finding("face pressures", value, "warn", reason, "coupling.loads = force")


def water_holds(scene: Scene, n: Numbers) -> Finding | None:
    """What a lattice of particles under pressure may hold of what moves a body in it (bounds/lattice.py)."""
    value = lattice_hold(scene, n)
    if not value:
        return None
    reason = f"of what moves the {n.plate.name}, water under pressure may hold: its lattice bears shear until it slips"
    if value <= HELD_WARN:
        return Finding("water's hold", value, "ok", reason)
    still = scene.goal is None or scene.goal.statistic in STEADY
    ways = ["fluid.model = still where it comes to rest"] if still else []
    ways += ["fluid.h_over_dx = 2.0"] if scene.fluid.h_over_dx < MANY_NEIGHBOURS else []
    return Finding("water's hold", value, "warn", reason, ", ".join([*ways, "a smaller fluid.dx"]))


def drag(scene: Scene, n: Numbers) -> Finding | None:
    """Layer of water that artificial viscosity drags along with a plate that swings, over the plate's length."""
    value = dragged(scene, n)
    if not value or scene.goal is None or scene.goal.statistic in STEADY:
        return None
    reason = "layer that artificial viscosity drags along, over the plate: so much longer is its period, and so damped"
    verdict = above(value, DRAG_WARN)
    way_out = f"fluid.alpha = {scene.fluid.alpha * (0.5 * DRAG_WARN / value) ** 2:.1g}"
    return graded("drag", value, verdict, reason, way_out)


def ghost_acceleration(scene: Scene, n: Numbers) -> Finding | None:
    """ρ_f dx/(ρ_s t): mass of the water between particles and face over the structure's own."""
    if n.joint is None or not of_particles(n) or n.plate.model == "rigid" or not scene.fluid.structure_acceleration:
        return None
    value, limit = ghost_inertia(scene), largest_inertia(scene.coupling)
    if not ghosts_feel_acceleration(scene):
        return Finding("ghost acceleration", value, "ok", f"left out: past {limit:g} it would drive the plate")
    verdict = above(value, limit)
    if verdict == "ok":
        return Finding("ghost acceleration", value, verdict, f"water of one layer over the plate, limit {limit:g}")
    reason = f"pressures extrapolated with the acceleration of a plate past {limit:g} drive it"
    return Finding("ghost acceleration", value, verdict, reason, "fluid.structure_acceleration = auto")


def step_ratio(scene: Scene, n: Numbers) -> Finding | None:
    """Fluid step over solid step: the solid's sub-steps."""
    if n.joint is None or not of_particles(n) or n.plate.model not in PARTICLE_MODELS:
        return None
    value = n.water.step / n.plate.step
    verdict = above(value, STEP_RATIO_WARN)
    reason = f"{n.water.step:.3g} s over {n.plate.step:.3g} s"
    return graded("step ratio", value, verdict, reason, "solid.model = beam is implicit")
