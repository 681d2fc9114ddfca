"""Structures too thin for their two sides to be told apart are refused."""

from __future__ import annotations

import logging

from shared.contract import BadInput
from shared.geometry.thin_bodies import thin_bodies
from shared.geometry.thin_walls import THINNEST
from shared.schema.scene import Scene

log = logging.getLogger("shearwater")


def refuse_thin(scene: Scene) -> None:
    """Raise BadInput for a solid body thinner than `THINNEST` dx that stands in water on both faces; warn of others."""
    for name, thickness, both in thin_bodies(scene):
        thin = f"body {name!r} is {thickness:.3g} m thick, less than {THINNEST:g} fluid.dx"
        if both:
            raise BadInput(
                f"solid {thin}, and stands in water on both faces: its ghosts would average the two pressures and the "
                f"net load be up to a quarter off. Make fluid.dx at most {0.5 * thickness:.3g} m, half the thickness, "
                "or the body thicker."
            )
        log.warning("%s: where water comes to both faces, the net load will be up to a quarter off", thin)
