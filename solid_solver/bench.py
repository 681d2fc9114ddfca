"""How fast is the structure? A benchmark on the beam of case A.

solid-solver bench [--particles N] [--model NAME] [--gradient NAME] [--threads N] [--steps N]
"""

from __future__ import annotations

import math
import time

from shared.schema.scene import Scene
from solid_solver.models import make_model

LENGTH, THICKNESS = 0.2, 0.012  # m
LOAD = 20.0  # Pa, on the top face
WARM = 20  # steps before the clock starts


def beam(particles: int, model: str, gradient: str) -> Scene:
    """Case A's beam, clamped at both ends, of about `particles` particles."""
    bodies = [{"name": "beam", "rectangle": (0.0, 0.0, LENGTH, THICKNESS)}]
    solid = {
        "model": model,
        "dx": math.sqrt(LENGTH * THICKNESS / particles),
        "density": 1000.0,
        "youngs_modulus": 1.0e7,
        "gradient": gradient,
        "bodies": bodies,
        "clamps": [{"body": "beam", "face": "left"}, {"body": "beam", "face": "right"}],
        "loads": [{"body": "beam", "face": "top", "traction": (0.0, -LOAD)}],
    }
    return Scene.model_validate({"schema": 1, "title": "beam", "end_time": 1.0, "solid": solid})


def state_bytes(model) -> int:
    """Bytes of state per particle, empty slots left out."""
    return round(sum(array.nbytes for array in model.state().values()) / model.particles())


def run_benchmark(particles: int, model: str, gradient: str, threads: int, steps: int) -> dict[str, float]:
    """Particle-steps per second of whole steps; all particles, fixed ones included, compiling left out."""
    solid = make_model(beam(particles, model, gradient), False, threads)
    solid.begin(None)
    dt = solid.stable_step()
    solid.advance(0.0, WARM * dt, WARM, None)
    begun = time.perf_counter()
    solid.advance(WARM * dt, (WARM + steps) * dt, steps, None)
    wall = time.perf_counter() - begun
    solid.check()
    return {
        "particles": float(solid.particles()),
        "wall_s": wall,
        "particle_steps_per_s": steps * solid.particles() / wall,
        "bytes_per_particle": float(state_bytes(solid)),
    }
