"""Bounds of the error that a choice of models and resolution makes in the scene's goal, relative, and what they add.

Each part is measured on cases with a known answer (cases/results and README.md), with a margin of 1.2 to 2.5 over the
worst found; dx spacing of the fluid. The structure's part, and what its swing adds: solid.py.

    still              0.1 %; its level keeps the water's volume
                       (neither this nor a column bears a body that floats, this none without weight)
    column             0.1 % of a mean, and a plate's sag over the depth, for columns do not level out; beside an
                       upright plate what the levels take off its way (upright.py: 3.9 % between two waters); 30 % of
                       the swing of a plate that bends, whose water flows sideways too (share of the first mode,
                       numbers.py); no bound of that of an upright one, whose water gives way upward    a sprung gate
                       none where lagged exchange makes a swing grow a hundred times until the end      piston
    sound              of water that carries it θ²/4 of a swing, θ the depth in radians of sound, or L/π of a plate that
                       does not close its water, whose mass counts tan θ/θ times
                                                                            a tank on springs, a floor under 5 cm
    points, its and the plate's   points.py; corners with walls   corners.py
    water at rest      dx/H (ctvf), 3 dx/H (wcsph), a tenth with h = 2 dx  still_tank, soft_plate, hydrostatic_plate
                       times buoyancy over what it leaves of the weight of a plate under water; all of this of a level
                       plate times the push over what weight and loads leave of it     a heavy roof that water lifts
                       and all errors of another so many times                     a gate pressed from its dry side
    its surface        besides, over its height above the gauge: g H²/(2 c0²), and 0.05 dx; no bound for a gauge at it
    its push on walls  besides, what settled water that walls cover has too much of mass, g z/c0²  a tank that narrows
    its push sideways  besides, 2 g H/(3 c0²): settled water stands lower at the same pressure below
    its pressure at z  besides, over z: the level of settled water, g (H² − z²)/(2 c0²) lower, 0.05 dx more with less
                       than h = 2 dx, and 0.09 R (1 − z/R)² of a sensor of reach R > z
                                                                       at 2.5 to 40 cm in half a metre, dx 1 to 4 cm
    its motion         no bound: it has none
    rows that do not fit between two faces: no bound but of a mean, for water at rest is stirred     a submerged block
    a body afloat      a waterline within 0.4 dx besides, 0.1 dx of a raft whose faces lie between whole rows (found
                       0.34 and 0.005 to 0.042): over its way to equilibrium where the goal is a displacement along
                       gravity, else over its thickness  rafts of 0.3 to 0.85 of water's density, 2 mm to 20 cm wide
    a body that swings in water of particles 1.5 dx/d (wcsph), 0.5 dx/d (ctvf), d its thickness if that is less; the
                       depth where it spans the water, which then moves as it does                a sprung floor
    a plate that swings in water of particles: the layer δ that artificial viscosity drags along, δ/L of a time and
                       2 δ/L of a peak, L the plate's length: found 0.5 to 0.7, and a damping ratio of δ/L; of a sprung
                       body by the water's share of what swings, and no bound of a period where it comes to rest before
                       the end                    a cantilever on a floor, a sprung block 10 dx wide, α 0.01 and 0.1
                       of a sprung body also the water's own sound: 1.5 times the body's share of the water, a/A, by
                       x²/(1 − x²), x its swing over that of a standing wave of sound, 15 a/A near it and from there
                       on: found 0.1, 0.7 and 5 times a/A at 0.5, 0.6 and 0.97      a sprung disc in a full box
    a body under water that nothing holds: none of its motion, for it is a matter of drag, which artificial viscosity
                       makes: after 0.4 s of sinking 49 % (α 0.1), 30 % (0.01) short of potential flow's way; or of
                       nothing, where it rests                                  a disc of twice water's density
    pressures over faces (coupling.loads = pressure): no bound of a body with water of particles on two sides, whose net
                       is a small difference of them: where it has moved out of the water's lattice, 1 to 6 % off that
                       of the forces with h = 2 dx, 5 to 8 % with 1.3 dx, 50 to 80 % at a depth of nine thicknesses; on
                       a floor, and of water at rest, they are right     sprung blocks, a floor under 20 cm
    a wall that stops at a body's corner with nothing behind: no bound, for water leaks there   measures/wall_ends.py
    a body that moves under water at rest   lattice.py
    water that flows   flow.py
    water that is moved in by a table  shaken.py
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.bounds.corners import CORNERS, corner_strips
from coupler.preflight.bounds.flow import MOTIONS, SMOOTH, flow_error, off_level
from coupler.preflight.bounds.lattice import HELD, lattice_hold
from coupler.preflight.bounds.points import SPREAD_OUT, at_points, spread_out
from coupler.preflight.bounds.resonance import RESONANCE, resonance
from coupler.preflight.bounds.shaken import SHAKEN, shaken_error
from coupler.preflight.bounds.solid import TIMES, UNKNOWN, of_structure, periods
from coupler.preflight.bounds.swings import PHASE, SWING, swing_at_the_end, swing_in_a_mean
from coupler.preflight.finding import COLUMN, STEADY, of_particles
from coupler.preflight.measures.afloat import adrift, afloat, to_equilibrium
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import counts_of_water, goals_probe, goals_quantity, of_a_body, plates_body
from coupler.preflight.measures.shapes import CROWDED, area, crowding
from coupler.preflight.measures.swing import RADIATES, carries_sound, dragged, late, radiates, resounding
from coupler.preflight.measures.upright import levels_pull, opposed
from coupler.preflight.measures.wall_ends import open_ends
from coupler.preflight.measures.water import covered
from coupler.preflight.measures.window import GROWTH_WARN, lag_growth
from shared.geometry.regions import corners_of
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.probes import FORCES, REACTIONS, Probe
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS

Parts = dict[str, float]

STILL = 1e-3
REST = {"ctvf": 1.0, "wcsph": 3.0}
CROWD, EASED = 2.0, 0.1  # from this h/dx on a lattice of particles bears hardly any shear, and rest is as much better
SAG = 0.05  # of dx: what a lattice that bears shear takes off a level
SENSOR = 0.09  # of a sensor's reach by (1 − depth/reach)²: what it feels too much where it reaches out of the water
WATERLINE, ON_ROWS, ROWS = 0.4, 0.1, 1e-3  # of dx; where a raft's faces lie between whole rows of water, to a share
DRAGGED, DAMPED = 1.0, 2.0
ECHOED, NARROW = 1.5, 0.1  # of the body's share of the water; how near its sound's own swing nothing more is known
FACES = "pressures over faces"


def error_parts(scene: Scene, n: Numbers) -> Parts:
    """The bounds by source; their sum bounds the error of the goal. Empty without a goal."""
    if scene.goal is None:
        return {}
    parts = {}
    if n.plate is not None:
        parts[scene.solid.model] = of_structure(scene, n) * _felt(scene, n)
    if n.water is not None:
        away = of_particles(n) and (n.water.bottomless > 0.0 or any(open_ends(scene)))
        parts[f"fluid {scene.fluid.model}"] = UNKNOWN if away else _fluid(scene, n)
        if shaken := shaken_error(scene, n):
            parts[SHAKEN] = shaken
    if spread := spread_out(scene, n):
        parts[SPREAD_OUT] = spread * _left_of_water(scene, n)
    if strips := corner_strips(scene, n):
        parts[CORNERS] = strips
    if over_faces := _over_faces(scene, n):
        parts[FACES] = over_faces
    if hold := lattice_hold(scene, n):
        parts[HELD] = hold * (0.5 if scene.goal.statistic in TIMES else 1.0)
    if n.joint is not None and of_a_body(scene) and n.water.rests and goals_quantity(scene) not in REACTIONS:
        much = opposed(scene, n.plate)
        parts = {name: much * part if part else part for name, part in parts.items()}
    error = sum(parts.values())
    swings = {SWING: swing_in_a_mean(scene, n), PHASE: swing_at_the_end(scene, n, error)}
    swings[RESONANCE] = resonance(scene, n, error) if scene.solid is not None else 0.0
    return parts | {name: part for name, part in swings.items() if part > 0.0}


def error_bound(scene: Scene, n: Numbers) -> float | None:
    """Bound of the goal's relative error; None without a goal, infinite where the choice cannot do it."""
    parts = error_parts(scene, n)
    return sum(parts.values()) if parts else None


def _felt(scene: Scene, n: Numbers) -> float:
    """Share of the structure's error that the goal feels: of a mean force of water at rest what moves its level."""
    steady = scene.goal.statistic in STEADY and n.water is not None and n.water.rests and not n.water.boxed
    if not steady or goals_quantity(scene) not in FORCES or n.plate.deflection is None:
        return 1.0
    return min(2.0 * n.plate.deflection / n.water.height, 1.0)


def _fluid(scene: Scene, n: Numbers) -> float:
    water, steady = n.water, scene.goal.statistic in STEADY
    closed = water.boxed and n.joint is not None and n.joint.closes
    floats = n.plate is not None and afloat(scene, plates_body(scene, n.plate))
    if drifting(scene, n):
        return UNKNOWN
    if water.model == "still":
        weighs = any(scene.gravity)
        known = water.rests and steady and weighs and not closed and not floats
        return (STILL + at_points(scene, n)) * _left_of_water(scene, n) if known else UNKNOWN
    if water.model not in PARTICLE_FLUIDS:
        bends = n.plate is not None and n.plate.model not in RIGID_MODELS
        if not water.rests or floats or (closed and scene.fluid.column.far_end == "open"):
            return UNKNOWN
        if lag_growth(scene, n) > math.log(GROWTH_WARN):
            return UNKNOWN
        if steady:
            return (STILL + _off_columns_level(scene, n) + at_points(scene, n)) * _left_of_water(scene, n)
        if n.joint.parts:  # that water gives way upward, and not along them
            return UNKNOWN
        return (COLUMN if bends else STILL) + _sounding(scene, n)
    return _at_rest(scene, n, floats) if water.rests else flow_error(scene, n)


def drifting(scene: Scene, n: Numbers) -> bool:
    """Whether the goal is how a body moves that the water goes round and nothing holds."""
    if n.joint is None or n.joint.closes or n.plate.wet < 1 or not of_a_body(scene):
        return False
    return adrift(scene, plates_body(scene, n.plate), goals_quantity(scene))


def _off_columns_level(scene: Scene, n: Numbers) -> float:
    """Of a mean under columns: they do not level out beside an upright plate; another's tops sag with their feet."""
    if n.joint.parts:
        return levels_pull(scene, n.plate, n.joint.parts)
    bends = n.plate.model not in RIGID_MODELS
    return (n.plate.deflection or 0.0) / n.water.height if bends else 0.0


def _at_rest(scene: Scene, n: Numbers, floats: bool) -> float:
    """Of water of particles that rests, or moves along with a structure alone."""
    water, probe, steady = n.water, goals_probe(scene), scene.goal.statistic in STEADY
    if goals_quantity(scene) in MOTIONS and not of_a_body(scene):
        return UNKNOWN
    if (not steady and radiates(scene, n)) or stirred(scene, n):
        return UNKNOWN
    if not steady and n.plate is not None and n.plate.model == "spring":
        smooth = SMOOTH[water.model] * water.dx
        if n.joint.closes:  # it carries all the water along, and none flows round it
            return smooth / n.joint.depth * (0.5 if scene.goal.statistic in TIMES else 1.0) + _sounding(scene, n)
        if scene.goal.statistic == "period" and _dies(scene, n):
            return UNKNOWN
        return smooth / min(water.width, n.plate.thickness) + _slowed(scene, n) + _resounded(scene, n)
    crowded = EASED if scene.fluid.h_over_dx >= CROWD else 1.0
    closes = n.joint is not None and n.joint.closes  # it bears the water's weight, whatever the pressures
    error = REST[water.model] * water.dx / water.height * crowded * (1.0 if closes else _left_of_water(scene, n))
    if probe is not None and probe.quantity == "pressure":
        error += _near_surface(scene, n, probe)
    if probe is not None and probe.quantity == "elevation":
        error += off_level(scene, n, probe, SAG) or UNKNOWN
    if goals_quantity(scene) in FORCES and probe.body in [wall.name for wall in scene.walls]:
        error += math.hypot(*scene.gravity) * covered(scene) / water.sound_speed**2
    if _across(scene):
        error += 2.0 * math.hypot(*scene.gravity) * water.height / (3.0 * water.sound_speed**2)
    if not steady:
        error += _sounding(scene, n) + _slowed(scene, n)
    return error + (_waterline(scene, n, probe) if floats else 0.0)


def _slowed(scene: Scene, n: Numbers) -> float:
    """Of a swing by what artificial viscosity drags along with it."""
    return (DRAGGED if scene.goal.statistic in TIMES else DAMPED) * dragged(scene, n)


def _resounded(scene: Scene, n: Numbers) -> float:
    """Of a sprung body's swing by the water's own sound, which swings along."""
    near = min(resounding(scene, n) / RADIATES, 1.0) ** 2
    share = area(plates_body(scene, n.plate)) / sum(area(body) for body in scene.fluid.bodies)
    return ECHOED * share * near / max(1.0 - near, NARROW)


def _dies(scene: Scene, n: Numbers) -> bool:
    """Whether what drags and holds a sprung body ends its swing before the run, within the middle of its extremes,
    (1 − e^(−πζ))/2 of the first; then crossings of the middle are no period."""
    damping = 2.0 * math.pi * (dragged(scene, n) + lattice_hold(scene, n))
    seen = periods(scene, n)
    return seen is not None and math.exp(-damping * seen) < -0.5 * math.expm1(-0.5 * damping)


def stirred(scene: Scene, n: Numbers) -> bool:
    """Whether the goal is no mean, of water at rest that rows too many or too few between two faces stir."""
    crowded = max(crowding(body, n.water.dx) for body in scene.fluid.bodies) > CROWDED
    return crowded and n.water.rests and of_particles(n) and scene.goal.statistic not in STEADY


def _over_faces(scene: Scene, n: Numbers) -> float:
    """What pressures that a structure integrates over its faces add to what it does; 0 where it takes forces."""
    if n.joint is None or scene.coupling.loads != "pressure" or not of_a_body(scene):
        return 0.0
    round_it = n.plate.wet >= 2 or afloat(scene, plates_body(scene, n.plate))
    return UNKNOWN if round_it and of_particles(n) else 0.0


def _across(scene: Scene) -> bool:
    """Whether the goal is of a force across gravity."""
    axis = {"force-x": 0, "force-y": 1}.get(goals_quantity(scene))
    return axis is not None and any(scene.gravity) and scene.gravity[axis] == 0.0


def _near_surface(scene: Scene, n: Numbers, probe: Probe) -> float:
    """Of a pressure at a depth: the level of settled water is g H²/(2 c0²) lower, less the deeper; and a sensor that
    reaches out of the water feels less of its gradient there."""
    water, g = n.water, math.hypot(*scene.gravity)
    corners = corners_of(scene.fluid.bodies)
    depth = float(np.asarray(probe.point) @ scene.gravity - np.min(corners @ scene.gravity)) / g if g else math.inf
    if depth <= 0.0:
        return UNKNOWN
    level = g * max(water.height**2 - depth**2, 0.0) / (2.0 * water.sound_speed**2)
    level += SAG * water.dx if scene.fluid.h_over_dx < CROWD else 0.0
    reach = 0.5 * probe.extent if probe.extent is not None else water.support
    return (level + SENSOR * reach * max(1.0 - depth / reach, 0.0) ** 2) / depth


def _waterline(scene: Scene, n: Numbers, probe: Probe | None) -> float:
    """Of a body afloat: a waterline within a share of dx, of the way to its equilibrium where that is the goal, else
    of its thickness."""
    upright = dict(zip(("displacement-x", "displacement-y"), scene.gravity, strict=True))
    waters, raft = scene.fluid.bodies, plates_body(scene, n.plate)
    fits = raft.rectangle is not None and not any(one.rotate for one in (raft, *waters))
    fits = fits and max(crowding(body, n.water.dx) for body in waters) < ROWS
    off = (ON_ROWS if fits else WATERLINE) * n.water.dx
    if probe is not None and upright.get(probe.quantity):
        way = to_equilibrium(scene, raft)
        return off / way if 0.0 < way < math.inf else UNKNOWN
    return off / n.plate.thickness


def _sounding(scene: Scene, n: Numbers) -> float:
    """Error of a swing by the sound that crosses the water late."""
    if n.joint is None or n.plate.frequency is None or not carries_sound(scene):
        return 0.0
    theta = late(scene, n)
    return 0.25 * theta**2 if theta < RADIATES else UNKNOWN


def _left_of_water(scene: Scene, n: Numbers) -> float:
    """Push of water at rest over what is left of it: so many times its error counts in bending. Of a plate under water
    buoyancy over what it leaves of the weight; of a level one with water on one side by its weight and loads."""
    if n.plate is None or goals_quantity(scene) in FORCES:
        return 1.0
    if n.plate.wet < 2:
        return counts_of_water(scene, n.plate, n.water) if n.plate.clamps and of_a_body(scene) else 1.0
    if not scene.solid.gravity or scene.solid.loads:
        return 1.0
    left = abs(n.plate.density - n.water.density)
    return max(1.0, n.water.density / left) if left > 0.0 else UNKNOWN
