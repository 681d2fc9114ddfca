"""Whether a structure's acceleration enters the pressure of the fluid's ghosts in it (eq. 14 of Adepu & Ramachandran).

It is a force of the water of about one layer of particles, μ = ρ_f dx/(ρ_s t) of the structure's own mass. Where a
window is taken once it is a lagged one: with Q the extrapolation of order 0, 1, 2 from past windows and y one window
back, 1 + μ Q = 0 (serial) and 1 + μ Q² = 0 (parallel, where the wall's acceleration is extrapolated too), on top of
what sound sends back in a window (coupler/stability/theory.py).
"""

from __future__ import annotations

from shared.geometry.regions import own_box
from shared.schema.coupling import Coupling
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS

_LARGEST_SERIAL = (1.0, 0.33, 0.14)
"""μ up to which "auto" lets it in, by predictor order. Measured: at 0.17 and 0.5 it makes no difference to the mean of
cantilever_in_water; on a rubber floor under liquids of several densities, iterated, 0.5 and 0.8 hold, 1.3 takes twice
the evaluations, 2.3 blows up, as does light_gate with its 3.3. Lagged, on a floor under 0.2 m of water, windows of
α = 0.03: up to 1.0, 0.53, 0.27 hold, 1.2, 0.63, 0.32 blow up within 120 windows; theory 1, 1/3, 1/7."""
_LARGEST_PARALLEL = (0.7, 0.09, 0.004)
"""The same for the parallel scheme taken once: 0.74, 0.12, 0.016 hold, 0.87, 0.14, 0.019 blow up; theory at α = 0.03:
0.98, 0.15, 0.027, at α = 0.07: 0.96, 0.14, 0.006."""


def largest_inertia(coupling: Coupling) -> float:
    """Largest μ that an exchange holds."""
    if coupling.scheme.endswith("implicit"):
        return _LARGEST_SERIAL[0]
    return (_LARGEST_PARALLEL if coupling.scheme.startswith("parallel") else _LARGEST_SERIAL)[coupling.predictor]


def ghost_inertia(scene: Scene) -> float:
    """μ: ρ_f dx/(ρ_s t), t the least extent of the thinnest solid body. A structure of particles that integrates
    pressures bears it with its outermost layer alone, whose half then stands for t: of a layer's mass 0.42 holds, from
    0.62 on a rubber flap in still water ripples, 1.25 turns it inside out."""
    solid = scene.solid
    thinnest = min(float((upper - lower).min()) for lower, upper in map(own_box, solid.bodies))
    if scene.coupling.loads == "pressure" and solid.model in PARTICLE_MODELS:
        thinnest = min(thinnest, 0.5 * solid.dx)
    return scene.fluid.density * scene.fluid.dx / (solid.density * thinnest)


def ghosts_feel_acceleration(scene: Scene) -> bool:
    """As the scene says, or where no load moves the structure, or where the exchange holds that water's weight."""
    asked, solid = scene.fluid.structure_acceleration, scene.solid
    if asked != "auto":
        return asked
    driven = solid is not None and solid.model != "rigid" and solid.motion is None
    return not driven or ghost_inertia(scene) <= largest_inertia(scene.coupling)
