"""The ends of a beam: which are clamped, and how a clamp's motion table moves its section."""

from __future__ import annotations

import numpy as np

from shared.geometry.motion_table import MotionTable
from solid_solver.beam_geometry import Beam
from solid_solver.rigid_points import moved

ENDS = 2


class BeamEnds:
    """Displacement and section angle of a beam's first and last node as their clamps prescribe them."""

    def __init__(self, beam: Beam):
        self._axes = beam.axes
        self._nodes = [beam.origin, beam.origin + beam.length * beam.axes[0]]
        self._tables = [MotionTable(motion) if motion else None for motion in beam.motions]

    def at(self, times: np.ndarray) -> np.ndarray:
        """q and v at `times` (m,) [s] in the beam's frame, (m, 2, 2, 3): time, end, q or v; zero where none moves."""
        result = np.zeros((len(times), ENDS, 2, 3))
        for end, (table, node) in enumerate(zip(self._tables, self._nodes, strict=True)):
            if table is None:
                continue
            for m, time in enumerate(times):
                pose = table.at(time)
                result[m, end, :, :2] = moved((node - table.about)[None], pose)[:2, 0] @ self._axes.T
                result[m, end, :, 2] = pose[:2, 2]
        return result
