"""Bounds of what points tell of a load on a plate that bends, relative: those where water presses, and the plate's own.

still, column      n along the plate: 3/n⁴ under columns on a cantilever, of a plate between two clamps 6/n⁴ (still),
                   15/n⁴ (column); less than four links, or five columns, do not tell its curvature: 1.2/n²,
                   1.2/n⁴                                              a dam of steel before 10 cm of mercury
the plate's        4.5/n², n along what is wet of it, where the fluid's do not coincide with them: the map spreads
                   loads over two rings of points; found 2.6/n² (10), 3.7/n² (80) of a cantilever, 4.2/n² (20)
                   where it is half wet, 3.3/n² (10), 1.6/n² (40) between two clamps    beams with two points across
"""

from __future__ import annotations

import numpy as np

from coupler.preflight.bounds.solid import TIMES
from coupler.preflight.finding import of_particles
from coupler.preflight.measures.held import lengthwise
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import of_a_body, plates_body
from shared.geometry.regions import axes_of, corners_of
from shared.geometry.wetted_faces import load_spacing
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS

AT_POINTS = {"still": (0.0, 6.0), "column": (3.0, 15.0)}  # over n⁴, of a cantilever and between two clamps
ENOUGH = {"still": 4, "column": 5}  # points of a face that tell how it is curved
AT_FEW = ((1.2, 2), (1.2, 4))  # over a power of fewer
SPREAD_OUT, SPREAD = "loads spread over the plate's points", 4.5  # over n²
_COINCIDE = 1e-9  # of dx: lattices of both sides


def at_points(scene: Scene, n: Numbers) -> float:
    """Of what a plate bends under pressures at points: those of its columns, or of its side in `still`."""
    if n.plate is None or n.plate.model in RIGID_MODELS or not of_a_body(scene):
        return 0.0
    body, model = plates_body(scene, n.plate), n.water.model
    axis, _, length = lengthwise(body)
    if model == "column":
        along = corners_of(scene.fluid.bodies)
        length = min(length, float(np.ptp(along @ axes_of(body.rotate)[axis])))
    points, two = max(1, round(length / load_spacing(scene))), int(n.plate.clamps == 2)
    times, power = (AT_POINTS[model][two], 4) if points >= ENOUGH[model] else AT_FEW[two]
    return times / points**power


def spread_out(scene: Scene, n: Numbers) -> float:
    """Of a plate that bends by the map, which spreads the loads of points of the fluid that are none of its own."""
    if n.joint is None or n.plate.model in RIGID_MODELS or not of_a_body(scene):
        return 0.0
    if of_particles(n) and abs(n.water.dx / scene.solid.dx - 1.0) < _COINCIDE:
        return 0.0
    return SPREAD * (scene.solid.dx / n.plate.bent) ** 2 * (0.5 if scene.goal.statistic in TIMES else 1.0)
