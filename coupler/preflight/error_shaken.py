"""Bounds of what prescribed motions of walls, structures and clamps add to the error in water of particles.

squeezed     θ²/4 of all but a mean, θ = ω L/c0 the radians of the motion in which sound crosses the water; none past a
             quarter wave
Of forces and pressures besides, and of those that water at rest presses with only by the motion's share, a/(a + g H/L):
jolt         what a jump of speed or acceleration at the motion's start or end sets ringing, for hardly anything damps
             it: Δa + Δu π c0/(2 L) over its largest a
stirred      from a way of a quarter of dx on the lattice melts, and as it does sets the water's lowest sound ringing:
             5 dx/d under a surface (found 0.1 to 0.4 at 20 across); no bound in a full box (0.15 to 0.7 at 20 and 40
             across, with any h, alpha and model)                                        a block shaken in a box
dragged      by artificial viscosity, a quarter of a period off its push: √(1 + (3 δ/L)²) − 1 by the layer δ = √(2 ν/ω)
             and the body's length L (found 2.3 and 2.8 for 3)
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.error_flow import FLOW
from coupler.preflight.finding import PUSHES, STEADY, of_particles
from coupler.preflight.numbers import Numbers
from coupler.preflight.plate import goals_probe, goals_quantity
from coupler.preflight.water import unbacked
from shared.geometry.shakers import Shaker, shakers, sound_time
from shared.schema.probes import FORCES
from shared.schema.scene import Scene

SHAKEN = "what is moved"
QUARTER_WAVE = math.pi / 2.0
MELTS = 0.25  # of dx: with it forces are 7 % off, with half of dx 75 %
LAYERS = 3.0


def shaken_error(scene: Scene, n: Numbers) -> float:
    """Bound of what they add to the goal's relative error."""
    if not of_particles(n) or scene.goal.statistic in STEADY:
        return 0.0
    theta = sound_time(scene) / n.water.sound_speed
    if theta >= QUARTER_WAVE:
        return math.inf
    error = 0.25 * theta**2
    if goals_quantity(scene) not in PUSHES:
        return error
    parts = (one.jolt(n.water.sound_speed) + _stirred(scene, n, one) + _dragged(n, one) for one in shakers(scene))
    shares = (_share(scene, n, one) for one in shakers(scene))
    return error + max((part * share for part, share in zip(parts, shares, strict=True)), default=0.0)


def why_unknown(scene: Scene, n: Numbers) -> str:
    """Why there is no bound."""
    if sound_time(scene) >= QUARTER_WAVE * n.water.sound_speed:
        return "the water is shaken faster than its sound crosses it: it is squeezed and rings; a higher sound_speed"
    if any(math.isinf(one.jolt(n.water.sound_speed)) for one in shakers(scene)):
        return "a motion that jumps to its speed sets the water ringing, and nothing else pushes it"
    return (
        "a full box rings as its lattice melts, and no surface lets it out: judge a mean or a motion, or give the "
        f"water a surface; ways below {MELTS:g} fluid.dx do not melt it"
    )


def _stirred(scene: Scene, n: Numbers, shaker: Shaker) -> float:
    carried = scene.solid is None and all(wall.motion == shaker.motion for wall in scene.walls)
    sides, top, _ = unbacked(scene)
    full = not sides and not top
    if shaker.way <= MELTS * n.water.dx or (carried and full):  # all moves as one
        return 0.0
    return math.inf if full else FLOW * n.water.dx / n.water.width


def _dragged(n: Numbers, shaker: Shaker) -> float:
    if not shaker.structure or shaker.rate == 0.0:
        return 0.0
    layer = n.water.dragged_layer(shaker.rate)
    return math.hypot(1.0, LAYERS * layer / float(np.ptp(shaker.points, axis=0).max())) - 1.0


def _share(scene: Scene, n: Numbers, shaker: Shaker) -> float:
    """Of the motion in what presses on a wall or a gauge; what rest presses on the two sides of a body cancels."""
    probe = goals_probe(scene)
    if probe.quantity in FORCES and probe.body not in [wall.name for wall in scene.walls]:
        return 1.0
    moved = shaker.rate * shaker.speed
    rest = math.hypot(*scene.gravity) * n.water.height / shaker.extent
    return moved / (moved + rest) if moved > 0.0 else 1.0
