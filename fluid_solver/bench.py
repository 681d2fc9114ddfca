"""How fast is the fluid? A benchmark on a developed dam break.

python -m fluid_solver.bench [particles] [model] [threads]
"""

from __future__ import annotations

import math
import sys
import time

from fluid_solver.models import make_model
from shared.schema import Scene

COLUMN = 0.146  # m, width of the column; twice as high (Martin & Moyce's larger one, Koshizuka & Oka)
DEVELOPED = 0.05  # s; the column has begun to run, cells and order are those of a flow


def dam_break(particles: int, model: str) -> Scene:
    """A 2:1 column of about `particles` particles in a tank of four widths."""
    dx = COLUMN * math.sqrt(2.0 / particles)
    return Scene.model_validate(
        {
            "schema": 1,
            "title": "dam break",
            "end_time": 1.0,
            "gravity": (0.0, -9.81),
            "fluid": {
                "model": model,
                "dx": dx,
                "bodies": [{"name": "water", "rectangle": (0.0, 0.0, COLUMN, 2.0 * COLUMN)}],
            },
            "walls": [{"name": "tank", "polyline": [(0.0, 0.45), (0.0, 0.0), (0.584, 0.0), (0.584, 0.45)]}],
        }
    )


def run_benchmark(particles: int = 180_000, model: str = "ctvf", threads: int = 2, steps: int = 60) -> dict[str, float]:
    """Particle-steps per second of whole steps, all particles (fluid, walls) counted; warmed up beforehand.

    The start is developed at a quarter of the steps first, so that particles are disordered and sorting is paid.
    """
    fluid = make_model(dam_break(particles, model), False, threads)
    fluid.begin(None)
    dt = fluid.stable_step()
    warm = max(steps, 10)
    fluid.advance(0.0, warm * dt, warm, None)
    begun = time.perf_counter()
    fluid.advance(warm * dt, (warm + steps) * dt, steps, None)
    wall = time.perf_counter() - begun
    fluid.check()
    done = steps * fluid.particles()
    return {
        "particles": float(fluid.particles()),
        "fluid_particles": float(fluid.fluid_count),
        "steps": float(steps),
        "wall_s": wall,
        "particle_steps_per_s": done / wall,
    }


def main() -> None:
    """Print the benchmark."""
    given = sys.argv[1:]
    particles = int(float(given[0])) if given else 180_000
    model = given[1] if len(given) > 1 else "ctvf"
    threads = int(given[2]) if len(given) > 2 else 2
    result = run_benchmark(particles, model, threads)
    print(f"{model}, {result['particles']:.0f} particles, {threads} threads, {result['steps']:.0f} whole steps: "
          f"{result['particle_steps_per_s'] / 1e6:.2f} million particle-steps/s")  # fmt: skip


if __name__ == "__main__":
    main()
