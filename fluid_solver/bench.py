"""How fast is the fluid? A benchmark on a developed dam break.

fluid-solver bench [--model NAME]... [--particles N]... [--threads N]...
"""

from __future__ import annotations

import math
import time

import numpy as np

from fluid_solver.fields import FLUID, U, V, X, Y
from fluid_solver.models import make_model
from fluid_solver.stages import OPERATIONS, candidates, stages
from shared.schema.scene import Scene

COLUMN = 0.146  # m, width of the column; twice as high (Martin & Moyce's larger one, Koshizuka & Oka)
STRETCHING = 8.0  # 1/s; the column's top falls at 2.3 m/s
SHAKEN = 0.1  # of dx
WARM = 10  # steps before the clock starts
FEWEST = 20  # steps timed
WORK = 12_000_000  # particle-steps timed, if that is more


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


def developed(particles: int, model: str, threads: int):
    """A fluid set flowing and disordered as in a dam break under way, and its step [s].

    u = k (x, −y) keeps volume and follows both walls; places are shaken by a tenth of dx. So cells are sorted as often
    as in a run.
    """
    fluid = make_model(dam_break(particles, model), False, threads)
    S, water = fluid.store.S, fluid.store.kind == FLUID
    S[np.ix_([X, Y], water)] += np.random.default_rng(0).uniform(-SHAKEN, SHAKEN, (2, water.sum())) * fluid.c.dx
    S[U, water], S[V, water] = STRETCHING * S[X, water], -STRETCHING * S[Y, water]
    fluid.begin(None)
    dt = fluid.stable_step()
    fluid.advance(0.0, WARM * dt, WARM, None)
    return fluid, dt


def run_benchmark(particles: int, model: str, threads: int) -> dict[str, float]:
    """Times whole steps; all particles (fluid, walls) counted, compiling left out.

    Returns `particles`, `fluid_particles`, `steps`, `wall_s`, `core_s` of all threads, `particle_steps_per_s` (by the
    wall's clock); `bytes_per_particle` of the arrays that the step works on; `interval_s`, core seconds to advance a
    particle by dx/c0, the time sound needs to the next.
    """
    fluid, dt = developed(particles, model, threads)
    count = fluid.particles()
    steps = max(FEWEST, WORK // count)
    begun, core = time.perf_counter(), time.process_time()
    fluid.advance(0.0, steps * dt, steps, None)
    wall, core = time.perf_counter() - begun, time.process_time() - core
    fluid.check()
    return {
        "particles": float(count),
        "fluid_particles": float(fluid.fluid_count),
        "steps": float(steps),
        "wall_s": wall,
        "core_s": core,
        "particle_steps_per_s": steps * count / wall,
        "bytes_per_particle": fluid.store.nbytes() / count,
        "interval_s": core / (steps * count) * fluid.c.dx / (fluid.c.c0 * dt),
    }


def profile(particles: int, model: str) -> list[dict[str, float | str]]:
    """The stages of a step on one thread: `stage`, nanoseconds per particle `ns`, `share` of the step, and of the two
    sweeps over the fluid the `rate` of floating-point operations [1/s]."""
    fluid, dt = developed(particles, model, 1)
    found = stages(fluid, dt, max(FEWEST, WORK // (4 * fluid.particles())))
    visits = candidates(fluid.store) * fluid.fluid_count
    return [
        {
            "stage": stage,
            "ns": 1e9 * seconds / fluid.particles(),
            "share": seconds / sum(found.values()),
            "rate": OPERATIONS[model].get(stage, 0.0) * visits / seconds if seconds else 0.0,
            "candidates": visits / fluid.fluid_count,
        }
        for stage, seconds in found.items()
    ]
