"""Beams of the published cases as models, for the tests of model beam."""

from __future__ import annotations

import numpy as np

from solid_solver.models import make_model
from tests.solid_scenes import run, solid_scene

WATER = 1000.0 * 9.81 * 2.0


def beam(**solid):
    return make_model(solid_scene(**{"model": "beam", **solid}), False, 1)


def plate_b(**solid):
    """Case B's plate under the water's pressure and its own weight."""
    keys = {
        "dx": 0.005,
        "density": 2700.0,
        "youngs_modulus": 6.75e10,
        "poisson_ratio": 0.34,
        "damping": 1700.0,
        "bodies": [{"name": "plate", "rectangle": [0.0, 0.0, 1.0, 0.05]}],
        "clamps": [{"body": "plate", "face": "left"}, {"body": "plate", "face": "right"}],
        "loads": [{"body": "plate", "face": "top", "traction": [0.0, -WATER]}],
    }
    probe = {"name": "mid_y", "body": "plate", "point": [0.5, 0.025], "quantity": "displacement-y"}
    return beam(gravity=(0.0, -9.81), probes=[probe], **(keys | solid))


def cantilever(angle=0.0, probes=(), **solid):
    """Case C's plate, 600 Pa on its left face, turned by `angle` [degree] about the origin with its load."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    keys = {
        "dx": 2.0e-3,
        "density": 2500.0,
        "poisson_ratio": 0.0,
        "bodies": [{"name": "plate", "rectangle": [0.0, 0.0, 0.012, 0.08], "rotate": {"angle": angle}}],
        "clamps": [{"body": "plate", "face": "bottom"}],
        "loads": [{"body": "plate", "face": "left", "traction": [600.0 * c, 600.0 * s]}],
    }
    return beam(probes=list(probes), **(keys | solid))


def oscillating_plate(v_f, nu, probes=()):
    """The free oscillation of a plate 0.2 m by 0.02 m, started with the speed of its first mode."""
    tip = {"name": "tip", "body": "plate", "point": [0.2, 0.01], "quantity": "displacement-y"}
    mode = {"clamped": "left", "tip_speed_over_c0": v_f}
    keys = {
        "dx": 2.0e-3,
        "youngs_modulus": 2.0e6,
        "poisson_ratio": nu,
        "bodies": [{"name": "plate", "rectangle": [0.0, 0.0, 0.2, 0.02], "velocity_mode": mode}],
        "clamps": [{"body": "plate", "face": "left"}],
    }
    return beam(probes=[tip, *probes], **keys)


def history(model, probe, end, windows):
    return np.array([(t, model.probe_values()[probe]) for t in run(model, end, windows)]).T


def upward_crossings(t, y):
    k = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    return t[k] - y[k] * (t[k + 1] - t[k]) / (y[k + 1] - y[k])
