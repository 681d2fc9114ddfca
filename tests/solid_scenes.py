"""Scenes of elastic bodies for the tests of the solid solver."""

from __future__ import annotations

import math

from shared.schema.scene import Scene


def solid_scene(*, gravity=(0.0, 0.0), probes=(), end_time=1.0, **solid) -> Scene:
    """A scene of a solid alone; keys of `solid` override a free unit square at ten particles across."""
    table = {
        "model": "total-lagrangian",
        "dx": 0.1,
        "density": 1000.0,
        "youngs_modulus": 1.0e6,
        "poisson_ratio": 0.3,
        "bodies": [{"name": "block", "rectangle": [0.0, 0.0, 1.0, 1.0], "free": True}],
    }
    return Scene.model_validate(
        {
            "schema": 1,
            "title": "test",
            "end_time": end_time,
            "gravity": gravity,
            "solid": table | solid,
            "probes": list(probes),
        }
    )


def beam_scene(across: int, **solid) -> Scene:
    """Case A, the beam clamped at both ends under 20 N/m, at `across` particles through its thickness."""
    probe = {"name": "mid_y", "body": "beam", "point": [0.1, 0.006], "quantity": "displacement-y"}
    beam = {
        "dx": 0.012 / across,
        "youngs_modulus": 1.0e7,
        "poisson_ratio": 0.0,
        "bodies": [{"name": "beam", "rectangle": [0.0, 0.0, 0.2, 0.012]}],
        "clamps": [{"body": "beam", "face": "left"}, {"body": "beam", "face": "right"}],
        "loads": [{"body": "beam", "face": "top", "traction": [0.0, -20.0]}],
    }
    return solid_scene(probes=[probe], **(beam | solid))


def run(model, end: float, windows: int, boundary=None):
    """Step a model to `end` [s] in equal windows; yields after each."""
    model.begin(None)
    for w in range(windows):
        t0, t1 = end * w / windows, end * (w + 1) / windows
        substeps = math.ceil((t1 - t0) / model.stable_step())
        model.advance(t0, t1, substeps, boundary)
        model.check()
        yield t1
