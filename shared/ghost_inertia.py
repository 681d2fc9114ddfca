"""Whether a structure's acceleration enters the pressure of the fluid's ghosts in it (eq. 14 of Adepu & Ramachandran).

It is a force of the water of about one layer of particles, ρ_f dx per area, against the structure's ρ_s t.
"""

from __future__ import annotations

from shared.geometry import own_box
from shared.schema import Scene

LARGEST_INERTIA = 1.0
"""ρ_f dx/(ρ_s t) up to which "auto" lets it in. Measured: at 0.17 and 0.5 it makes no difference to the mean of
cantilever_in_water; on a rubber floor under liquids of several densities, iterated, 0.5 and 0.8 hold, 1.3 takes twice
the evaluations, 2.3 blows up, as does light_gate with its 3.3."""


def ghost_inertia(scene: Scene) -> float:
    """ρ_f dx/(ρ_s t), t the least extent of the thinnest solid body."""
    thinnest = min(float((upper - lower).min()) for lower, upper in map(own_box, scene.solid.bodies))
    return scene.fluid.density * scene.fluid.dx / (scene.solid.density * thinnest)


def ghosts_feel_acceleration(scene: Scene) -> bool:
    """As the scene says, or where no load moves the structure, or where it outweighs that water."""
    asked, solid = scene.fluid.structure_acceleration, scene.solid
    if asked != "auto":
        return asked
    driven = solid is not None and solid.model != "rigid" and solid.motion is None
    return not driven or ghost_inertia(scene) <= LARGEST_INERTIA
