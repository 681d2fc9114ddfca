"""Bounds of what prescribed motions of walls, structures and clamps add to the error in water of particles.

squeezed     θ²/4 of all but a mean, θ = ω L/c0 the radians of the motion in which sound crosses the water; none past a
             quarter wave
Of forces and pressures besides, and of those that water at rest presses with only by the motion's share, a/(a + g H/L):
jolt         what a jump of speed or acceleration at the motion's start or end sets ringing, for hardly anything damps
             it: Δa + Δu π c0/(2 L) over its largest a
stirred      from a way of a quarter of dx on the lattice melts, and as it does sets the water's lowest sound ringing:
             5 dx/d under a surface (found 0.1 to 0.4 at 20 across); no bound in a full box (0.15 to 0.7 at 20 and 40
             across, with any h, alpha and model)                                        a block shaken in a box
             nor in one that a wall squeezes, from a fiftieth of dx on: nothing presses on it, so half of the time it is
             under tension, which pulls a lattice apart (0.1 to 2.4 too large at 0.1 to 0.2 dx, with any h and model)
                                                                        a piston on a closed column
dragged      by artificial viscosity, with its push and a quarter of a period off it: √((1 + (δ/L)²)² + (2.7 δ/L)²) − 1
             by the layer δ = √(2 ν/ω) and the body's length L (found 0 to 3 for 1, 2.3 to 2.8)
held         by a lattice under pressure (lattice.py), over the push, ρ a by the disc across the way, half as
             much again of a square: a block 10 spacings wide, 20 deep, moved by half a spacing at 1 Hz, 2.6 times its
             push with h = 1.3 dx, with 2 dx 0.4
             neither where walls and structure are moved as one, and the water goes along
carried      of a mean of the force on a body that goes on: along its way the drag of artificial viscosity, 8 ρ ν u
             (found 7 to 8), and that hold, across it 0.7 of the hold (found 0.1 to 0.65), over its buoyancy; no bound
             of it across gravity, where nothing is beside it; nothing where all is carried as one and a quarter of its
             weight is left                      blocks moved at 0.03 to 0.2 m/s in a tank; a tank and a block that fall
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.bounds.flow import FLOW
from coupler.preflight.bounds.lattice import hold_of_moved
from coupler.preflight.finding import PUSHES, STEADY, of_particles
from coupler.preflight.measures.gravity import across_and_up
from coupler.preflight.measures.numbers import ROUND, Numbers
from coupler.preflight.measures.plate import goals_probe, goals_quantity, plates_body
from coupler.preflight.measures.shapes import area
from coupler.preflight.measures.water import unbacked
from shared.geometry.motion_table import MotionTable
from shared.geometry.regions import outline
from shared.geometry.shakers import Shaker, as_one, shakers, sound_time
from shared.schema.probes import FORCES
from shared.schema.scene import Scene

SHAKEN = "what is moved"
QUARTER_WAVE = math.pi / 2.0
MELTS = 0.25  # of dx: with it forces are 7 % off, with half of dx 75 %
SQUEEZED = 0.02  # of dx, by a wall of a full box: with it pressures are 10 % off, with 0.2 22 to 240 %
BESIDE = 2.7  # of δ/L: what artificial viscosity drags along a quarter of a period off the push
STOKES, ACROSS = 8.0, 0.7
LEAST_WEIGHT = 0.25  # of g, that a motion leaves of what it carries as one: found 0.5, 0.1 % off


def shaken_error(scene: Scene, n: Numbers) -> float:
    """Bound of what they add to the goal's relative error."""
    if not of_particles(n):
        return 0.0
    if scene.goal.statistic in STEADY:
        return _carried(scene, n)
    theta = sound_time(scene) / n.water.sound_speed
    if theta >= QUARTER_WAVE:
        return math.inf
    error = 0.25 * theta**2
    if goals_quantity(scene) not in PUSHES:
        return error
    sound = n.water.sound_speed
    parts = (
        one.jolt(sound) + _stirred(scene, n, one) + _dragged(scene, n, one) + _held(scene, n, one)
        for one in shakers(scene)
    )
    shares = (_share(scene, n, one) for one in shakers(scene))
    return error + max((part * share for part, share in zip(parts, shares, strict=True)), default=0.0)


def why_unknown(scene: Scene, n: Numbers) -> str:
    """Why there is no bound."""
    if scene.goal.statistic in STEADY:
        if scene.solid.motion is not None and as_one(scene, scene.solid.motion):
            return "all is carried as one, and in the mean next to no weight is left along the goal's force"
        return "water without viscosity does not drag what goes on in it: all of the force is artificial"
    if sound_time(scene) >= QUARTER_WAVE * n.water.sound_speed:
        return "the water is shaken faster than its sound crosses it: it is squeezed and rings; a higher sound_speed"
    if any(math.isinf(one.jolt(n.water.sound_speed)) for one in shakers(scene)):
        return "a motion that jumps to its speed sets the water ringing, and nothing else pushes it"
    if any(not one.structure and one.way <= MELTS * n.water.dx for one in shakers(scene)):
        return (
            "a full box that a wall squeezes is under tension half of the time, which pulls its particles apart: give "
            "the water a surface, or judge a mean or a motion"
        )
    return (
        "a full box rings as its lattice melts, and no surface lets it out: judge a mean or a motion, or give the "
        f"water a surface; ways below {MELTS:g} fluid.dx do not melt it"
    )


def _stirred(scene: Scene, n: Numbers, shaker: Shaker) -> float:
    sides, top, _ = unbacked(scene)
    full = not sides and not top
    least = SQUEEZED if full and not shaker.structure else MELTS
    if shaker.way <= least * n.water.dx or (full and as_one(scene, shaker.motion)):
        return 0.0
    return math.inf if full else FLOW * n.water.dx / n.water.width


def _dragged(scene: Scene, n: Numbers, shaker: Shaker) -> float:
    if not shaker.structure or shaker.rate == 0.0 or as_one(scene, shaker.motion):
        return 0.0
    layer = n.water.dragged_layer(shaker.rate)
    layer /= float(np.ptp(shaker.points, axis=0).max())
    return math.hypot(1.0 + layer**2, BESIDE * layer) - 1.0


def _held(scene: Scene, n: Numbers, shaker: Shaker) -> float:
    if not shaker.structure or shaker.motion is not scene.solid.motion or shaker.acceleration == 0.0:
        return 0.0
    if as_one(scene, shaker.motion):
        return 0.0
    table, body = MotionTable(shaker.motion), plates_body(scene, n.plate)
    ways = table.displacements(np.asarray(shaker.motion.times), 0)[:, :2]
    farthest = ways[np.argmax(np.hypot(*ways.T))]
    if not farthest.any():
        return 0.0
    sides = outline(body).reshape(-1, 2) @ across_and_up(farthest / np.hypot(*farthest))
    front, along = (float(side) for side in np.ptp(sides, axis=0))
    disc = 0.25 * math.pi * front**2 * (1.0 + (ROUND - 1.0) * min(along / front, 1.0))
    return hold_of_moved(scene, n, shaker.way) / (n.water.density * disc * shaker.acceleration)


def _carried(scene: Scene, n: Numbers) -> float:
    """Of a mean of the force on a body that its table carries on."""
    axis, g = {"force-x": 0, "force-y": 1}.get(goals_quantity(scene)), np.asarray(scene.gravity)
    moved = scene.solid.motion if scene.solid is not None else None
    if axis is None or moved is None or n.plate.wet < 2 or goals_probe(scene).body != n.plate.name:
        return 0.0
    table, ends = MotionTable(moved), np.array([scene.output.average_from, scene.end_time])
    if as_one(scene, moved):
        gained = np.diff(table.displacements(ends, 1)[:, axis])[0] / np.ptp(ends)
        return 0.0 if abs(g[axis] - gained) >= LEAST_WEIGHT * np.hypot(*g) > 0.0 else math.inf
    way = np.abs(np.diff(table.displacements(ends, 0)[:, :2], axis=0)[0])
    far = float(np.hypot(*way))
    if far == 0.0:
        return 0.0
    along = float(way[axis]) / far
    drag = along * STOKES * n.water.density * n.water.artificial * far / float(np.ptp(ends))
    drag += max(along, ACROSS) * hold_of_moved(scene, n, far)
    lift = n.water.density * abs(float(g[axis])) * area(plates_body(scene, n.plate))
    return drag / lift if lift > 0.0 else math.inf


def _share(scene: Scene, n: Numbers, shaker: Shaker) -> float:
    """Of the motion in what presses on a wall or a gauge; what rest presses on the two sides of a body cancels."""
    probe = goals_probe(scene)
    if probe.quantity in FORCES and probe.body not in [wall.name for wall in scene.walls]:
        return 1.0
    moved = shaker.rate * shaker.speed
    rest = math.hypot(*scene.gravity) * n.water.height / shaker.extent
    return moved / (moved + rest) if moved > 0.0 else 1.0
