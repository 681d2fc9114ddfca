"""Bounds of the error in water of particles that flows, measured and with margins as those of error.py.

flow               where water falls and splashes 5 dx/d, d its least extent at t = 0, of its front 1.4 dx/d; 0.5
                   dx/d (ctvf), 1.5 dx/d (wcsph) where it is held and circulates     dam_break_plate, taylor_green,
                   a flap in a splash, by spacings from 3.3 to 0.6 mm: 3.2 to 4.4, scattered by 1
wave's wear        what artificial viscosity takes, at most 2 ν k² a second (wcsph; found 0.4 to 0.9 of it), 0.6 of it
                   (ctvf; 0.3 to 0.5), 0.15 more in a period where its lattice is stiff: of a height by its age, of an
                   energy twice, of a rate over 2 ν k² of the fluid's own; none of that without. (2 ν k²)²/(2 ω²) of a
                   period; at the end what its phase φ is late, φ |tan ωt| + φ²/2 of a speed, an energy twice, of an
                   elevation by the cotangent. None where it is torn (waves.py)           seiches, α 0.02 to 0.3
wave's period      0.25 % and what was found with h = 2 dx: 7.7 x^1.75 (ctvf), 18.9 x^1.94 (wcsph) too long, x =
                   dx/wavelength, with wendland-c2 as its reach squared (ctvf), to the fourth (wcsph); and too short at
                   any x by the shear that a lattice bears under pressure (lattice_shear.py), or 0.6 of what it leaves
                   its rows by either way                                                     standing_wave
                   where viscosity of its own takes less than a fifth of a wave's height in a period a lattice melts
                   late: 0.5 % (ctvf), 0.9 % (wcsph) more either way, and dx over a wave's height at the start times
                   that where it is lower than dx          seiches; waves on water λ/8 to λ/2 deep, ν 1e-3 m²/s
surface's height   besides, over its way from the gauge, the wave's height counted: the level of settled water,
                   g H²/(2 c0²) lower, and 0.2 dx
lid beside walls   0.92 (dx/width)^0.55 besides: 14, 9, 7 % at the centre of a box 25, 50, 100 dx wide (ctvf);
                   none below 25 dx or a Reynolds number of 100, nor with h = 2 dx, nor where nothing shifts particles
                   (wcsph): there water tears off the lid in the corner, and comes to rest               lid_cavity
waves' heights     as flow that is held, and 20 % more where that lattice is stiff, for it bears waves of its
                   spacing's height; at any dx                                                 a wavemaker
viscous stresses   3.6 (h/λ)², λ the shear wave's length, twice a channel's width; 0.12 (1.3 dx/h)^5 for few
                   neighbours in disorder, at any dx; artificial over own viscosity           taylor_green, Poiseuille
                   alone where its weight, or walls that slide, drive the water along a period, beside the flow's where
                   it is held; 0.3 (h/dx − 2)² dx/width more where its weight does, for the mean of many neighbours is
                   not the flow at a wall
moved through it   none with wcsph, many neighbours and a way of 2 dx           ploughed.py
past a body        d is the least extent of what stands in it; 50 % more where nothing shifts them (wcsph):
                   drag of a cylinder 4, 8, 16 dx wide 14, 2 % (ctvf), 50, 2, 17 % (wcsph) off; lift of a slanted plate
                   2 dx thick 17 % low (ctvf)
decay of vortices  the same; 50 % more where nothing shifts the particles (wcsph). What is left at the end errs by
                   e^(N times that) − 1 when it has fallen by e^−N                            taylor_green
water let go       of its speed 0.6 g H/c0 (wcsph), 0.08 g H/c0 (ctvf) over the speed at the end: what its pressure
                   gives it; twice that of its energy                                         a slab of water
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.bounds.lattice_shear import restless, stiff, too_fast
from coupler.preflight.bounds.ploughed import ploughed
from coupler.preflight.bounds.waves import Wave, torn, wave_of
from coupler.preflight.finding import STEADY
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import goals_probe, goals_quantity
from shared.expected_speed import start_speed
from shared.geometry.regions import corners_of, outline
from shared.geometry.shakers import as_one, shakers
from shared.geometry.wall_chains import segments_of
from shared.schema.fluid import Wall
from shared.schema.probes import Probe
from shared.schema.scene import Scene

SMOOTH = {"ctvf": 0.5, "wcsph": 1.5}
WAVE = {"ctvf": (7.7, 1.75, 2), "wcsph": (18.9, 1.94, 4)}  # factor, powers of dx/wavelength and of the reach over 4 dx
WAVE_MARGIN = (1.2, {"ctvf": 0.0025, "wcsph": 0.003})
LEFT = 0.6  # of what a lattice leaves its rows by
UNMELTED = {"ctvf": 0.005, "wcsph": 0.009}  # of a period, where viscosity of its own breaks no lattice
MELTING = 0.2  # of a wave's height, taken in a period: 0.35 and more breaks it (standing_wave), 0.09 does not
GAUGE = 0.2  # of dx: what particles that come and go put on a surface that moves
WAVES = 0.2  # of a height, where a lattice bears waves
FLOW, FRONT = 5.0, 1.4
VISCOUS = 3.6  # of (h/wavelength)²: the kernel smooths the stresses of a shear wave
ENOUGH = 2.0  # h/dx from which walls hold a bent profile too softly
BLURRED = 0.3  # of (h/dx − ENOUGH)² dx/width
FEW, FEW_POWER = 0.12, 5.0  # with h = 1.3 dx: stresses of a neighbourhood in disorder, whatever dx is
LID, LID_POWER = 0.92, 0.55  # of dx/width, under a lid beside walls
LID_ACROSS, LID_REYNOLDS, LID_SUPPORT = 25.0, 100.0, 1.6  # dx; h/dx: within them that was found
LOST = 1.0  # rad of a wave that swings
CLUSTERED = 0.5  # of a decay, where vortices stretch particles that nothing shifts
WEAR = {"ctvf": 0.6, "wcsph": 1.0}  # of what artificial viscosity would take off a wave if all pairs felt it
FEW_WEAR = 0.15  # of a wave's height in a period, with few neighbours: found 0.11
FALL = {"ctvf": 0.08, "wcsph": 0.6}  # of the speed that the pressure of water at rest gives it as it is let go
MOTIONS = ("max-speed", "velocity-x", "velocity-y", "kinetic-energy")
"""Quantities that are nothing in water at rest."""
TIMES = ("period", "wave-period", "t_min", "t_max")


def flow_error(scene: Scene, n: Numbers) -> float:
    """Bound of the goal's relative error."""
    water, goal = n.water, scene.goal
    probe = goals_probe(scene)
    quantity = goals_quantity(scene)
    wave = wave_of(scene, n)
    if torn(scene, n):
        return math.inf
    if goal.statistic == "wave-period":
        return _period(scene, n, wave)
    if water.free and quantity in MOTIONS and goal.statistic in ("final", "max"):
        return _let_go(scene, n) * (2.0 if quantity == "kinetic-energy" else 1.0)
    if not water.held:
        return (FRONT if quantity == "front-x" else FLOW) * water.dx / water.width
    if _vortices(scene) and scene.fluid.viscosity > 0.0 and (quantity in MOTIONS or goal.statistic == "decay"):
        return _decay(scene, n, quantity)
    thin = past(scene, n)
    driven = water.pulled and math.isinf(thin)
    if (driven or _slid(scene)) and scene.fluid.viscosity > 0.0:  # a channel's profile is half a wave
        wide = max(0.0, scene.fluid.h_over_dx - ENOUGH) if water.pulled else 0.0
        return _viscous(scene, n, 2.0 * water.width) + BLURRED * wide**2 * water.dx / water.width
    if ploughed(scene):
        return math.inf
    least = min(water.width, _wavelength(scene, n), thin)
    if n.plate is not None and n.plate.model == "spring":
        least = min(least, n.plate.thickness)
    flow = SMOOTH[water.model] * water.dx / least + (_under_a_lid(scene, n) if lids(scene) else 0.0)
    if scene.fluid.viscosity > 0.0:
        flow += VISCOUS * (water.h / (2.0 * least)) ** 2
    if math.isfinite(thin) and water.model == "wcsph":
        flow += CLUSTERED
    if quantity == "elevation":
        flow += off_level(scene, n, probe, GAUGE, wave.height if wave is not None else 0.0)
    if wave is not None:
        flow += _worn(scene, n, wave, quantity)
    return flow + (WAVES if water.waves and goal.statistic not in STEADY and stiff(scene) else 0.0)


def past(scene: Scene, n: Numbers) -> float:
    """Least extent [m] of what water flows past: a structure between two waters, a closed wall in it; infinite without
    such, or where nothing streams and nothing is moved farther than that."""
    water = corners_of(scene.fluid.bodies)
    found = [n.plate.thickness] if n.plate is not None and n.plate.wet == 2 else []
    for faces in (segments_of(wall) for wall in scene.walls if wall.closed):
        corners, along = faces[:, 0], faces[:, 1] - faces[:, 0]
        if np.all(corners > water.min(axis=0)) and np.all(corners < water.max(axis=0)):
            across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
            found.append(float(np.ptp(corners @ across.T, axis=0).min()))
    thin = min(found, default=math.inf)
    moved = any(one.span > thin and not as_one(scene, one.motion) for one in shakers(scene))
    return thin if n.water.pulled or start_speed(scene) > 0.0 or moved else math.inf


def off_level(scene: Scene, n: Numbers, probe: Probe, share: float, height: float = 0.0) -> float:
    """Of an elevation: the level of settled water, g H²/(2 c0²) lower, and a `share` of dx, over the way from the gauge
    to the surface, `height` [m] the wave's. Nothing where there is none: a gauge at the level of water at rest."""
    water, g = n.water, math.hypot(*scene.gravity)
    way = _over_gauge(scene, probe) + height
    return (g * water.height**2 / (2.0 * water.sound_speed**2) + share * water.dx) / way if way > 0.0 else 0.0


def _over_gauge(scene: Scene, probe: Probe) -> float:
    """Distance [m] of the water's level from a gauge."""
    return abs(max(float(outline(body)[..., 1].max()) for body in scene.fluid.bodies) - probe.point[1])


def _wear(scene: Scene, n: Numbers, wave: Wave) -> float:
    """Rate [1/s] at which a wave's height falls by what is not the fluid's own viscosity."""
    few = FEW_WEAR * wave.omega / (2.0 * math.pi) if stiff(scene) else 0.0
    return WEAR[n.water.model] * 2.0 * n.water.artificial * wave.k**2 + few


def _worn(scene: Scene, n: Numbers, wave: Wave, quantity: str) -> float:
    """Of what is left of a wave; infinite of how it decays, where nothing of the fluid's own lets it."""
    rate, goal = _wear(scene, n, wave), scene.goal
    if goal.statistic in ("decay", "wave-decay") or (goal.statistic, quantity) == ("change", "total-energy"):
        own = 2.0 * scene.fluid.viscosity * wave.k**2
        return rate / own if own > 0.0 else math.inf
    high = quantity == "elevation"
    if goal.statistic in TIMES or not (high or quantity in MOTIONS) or (high and goal.statistic in STEADY):
        return 0.0
    times = 2.0 if quantity == "kinetic-energy" else 1.0
    error = -math.expm1(-times * rate * wave.age)
    if wave.swings and goal.statistic == "final":
        turned = wave.omega * scene.end_time
        late = turned * _period(scene, n, wave)
        turn = abs(math.tan(turned + (0.5 * math.pi if high else 0.0)))
        error += times * late * (turn + 0.5 * late) if late < LOST else math.inf
    way = wave.height + _over_gauge(scene, goals_probe(scene)) if high else 0.0
    return error * wave.height / way if way > 0.0 else error


def _slid(scene: Scene) -> bool:
    """Whether all that moves is walls that slide along themselves, and a period."""
    fluid = scene.fluid
    along = [axis for axis, bounds in enumerate((fluid.periodic.x, fluid.periodic.y)) if bounds is not None]
    if len(along) != 1 or scene.solid is not None or start_speed(scene) > 0.0:
        return False
    faces = np.concatenate([segments_of(wall) for wall in scene.walls]) if scene.walls else np.empty((0, 2, 2))
    return not any(wall.motion for wall in scene.walls) and not np.ptp(faces[:, :, 1 - along[0]], axis=1).any()


def lids(scene: Scene) -> list[Wall]:
    """Walls that slide along water that sticks to them, beside others that stand."""
    sliding = [wall for wall in scene.walls if wall.slip == "no" and wall.surface_speed]
    round_it = len(sliding) == len(scene.walls) or any(wall.closed for wall in scene.walls)
    return [] if scene.fluid.viscosity == 0.0 or round_it else sliding


def _under_a_lid(scene: Scene, n: Numbers) -> float:
    """Of what a lid beside walls drives; infinite where it is not known."""
    fluid, water = scene.fluid, n.water
    fine = water.width >= LID_ACROSS * water.dx * (1.0 - 1e-9) and fluid.h_over_dx < LID_SUPPORT
    speed = max(abs(lid.surface_speed) for lid in lids(scene))
    known = fine and water.model == "ctvf" and speed * water.width >= LID_REYNOLDS * fluid.viscosity
    return LID * (water.dx / water.width) ** LID_POWER if known else math.inf


def _vortices(scene: Scene) -> bool:
    fields = (body.velocity_field for body in scene.fluid.bodies)
    return any(field is not None and field.kind == "taylor-green" for field in fields)


def _decay(scene: Scene, n: Numbers, quantity: str) -> float:
    """Of vortices that wear out at the rate 2 ν k² of their speed, twice that of their energy: the rate's error, which
    counts as often in what is left as it has fallen by e."""
    wavelength = _wavelength(scene, n)
    rate = _viscous(scene, n, wavelength) + (CLUSTERED if n.water.model == "wcsph" else 0.0)
    falls = 2.0 * scene.fluid.viscosity * (2.0 * math.pi / wavelength) ** 2 * scene.end_time
    falls *= 2.0 if quantity == "kinetic-energy" else 1.0
    if scene.goal.statistic in ("final", "min"):
        return math.expm1(rate * falls) if rate * falls < 1.0 else math.inf
    return rate * (min(1.0, 0.5 * falls) if scene.goal.statistic in STEADY else 1.0)


def _viscous(scene: Scene, n: Numbers, wavelength: float) -> float:
    """Of the viscous stresses of a shear wave [m]: smoothed, of few neighbours, and artificial ones beside them."""
    water, own = n.water, scene.fluid.viscosity
    few = FEW * (1.3 / scene.fluid.h_over_dx) ** FEW_POWER
    return VISCOUS * (water.h / wavelength) ** 2 + few + water.artificial / own


def _let_go(scene: Scene, n: Numbers) -> float:
    """Of the speed at the end of water that falls freely: what its pressure at rest, ρ g H, gives it in a wave of
    sound."""
    g, body = math.hypot(*scene.gravity), scene.fluid.bodies[0]
    reached = math.hypot(*(v + a * scene.end_time for v, a in zip(body.velocity, scene.gravity, strict=True)))
    pressed = scene.fluid.initial_pressure == "hydrostatic"
    return FALL[n.water.model] * g * n.water.height / (n.water.sound_speed * reached) if pressed else 1e-3


def _period(scene: Scene, n: Numbers, wave: Wave | None) -> float:
    """Of the period of a wave."""
    model = n.water.model
    (factor, power, reach), (times, more) = WAVE[model], WAVE_MARGIN
    length = 2.0 * math.pi / wave.k if wave is not None else _wavelength(scene, n)
    wide = n.water.support / (4.0 * n.water.dx) if scene.fluid.kernel == "wendland-c2" else 1.0
    slow = factor * (n.water.dx / length) ** power * wide**reach
    fast = too_fast(scene.fluid.kernel, scene.fluid.h_over_dx, 2.0 * math.pi * n.water.height / length)
    error = times * abs(slow - fast) + more[model] + LEFT * restless(scene)
    if wave is not None:
        error += 0.5 * times * (2.0 * n.water.artificial * wave.k**2 / wave.omega) ** 2
        if 4.0 * math.pi * scene.fluid.viscosity * wave.k**2 > MELTING * wave.omega:
            return error
    low = n.water.dx / wave.height if wave is not None and wave.height > 0.0 else 1.0
    return error + UNMELTED[model] * max(1.0, low)


def _wavelength(scene: Scene, n: Numbers) -> float:
    """The shortest wave's length [m] that the water starts with; without one its least extent."""
    fields = (body.velocity_field for body in scene.fluid.bodies)
    return min((field.wavelength for field in fields if field is not None), default=n.water.width)
