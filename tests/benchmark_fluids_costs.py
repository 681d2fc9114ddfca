"""Figures of cost that are no run of a case: speed, memory, start-up, and whether a long run slows down."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
import time
from functools import cache, partial

from fluid_solver.bench import run_benchmark
from fluid_solver.models import make_model
from shared.scene.reading import load_scene
from tests.benchmark_table import Measure

PARTICLES = 180_000
TIMED = 100  # steps at either end of a dam break


@cache
def _bench(particles: int, model: str, threads: int) -> dict[str, float]:
    return run_benchmark(particles, model, threads)


def _of_bench(key: str, scale: float, particles: int, model: str, threads: int) -> float:
    return _bench(particles, model, threads)[key] * scale


def _gain(model: str) -> float:
    one, two = (_bench(PARTICLES, model, threads)["particle_steps_per_s"] for threads in (1, 2))
    return two / one


def slowing(model: str) -> float:
    """Processor time of a step after 0.7 s of dam break over that of the first steps."""
    scene = load_scene("dam_break_wall", [f"fluid.model={model}", "fluid.dx=2e-3"])
    fluid = make_model(scene, False, 1)
    fluid.begin(None)
    _timed(fluid, 0.0)  # compiles
    first, t = _timed(fluid, 0.0), 0.0
    while t < scene.end_time:
        step = min(5e-3, scene.end_time - t)
        fluid.advance(t, t + step, math.ceil(step / fluid.stable_step()), None)
        t += step if step > 1e-9 else 1.0
    return _timed(fluid, t) / first


def _timed(fluid, t: float) -> float:
    dt, begun = fluid.stable_step(), time.process_time()
    fluid.advance(t, t + TIMED * dt, TIMED, None)
    return time.process_time() - begun


def start_up(cold: bool) -> float:
    """Wall time [s] of a run of one step; `cold`: with an empty cache of compiled code."""
    command = [sys.executable, "-m", "fluid_solver", "run", "dam_break", "--set", "end_time=1e-4", "--quiet"]
    command += ["--set", "output.frames=1", "--set", "output.probe_interval=1e-4", "--threads", "1"]
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | ({"NUMBA_CACHE_DIR": f"{folder}/cache"} if cold else {})
        if not cold:
            subprocess.run([*command, "--out", f"{folder}/first"], check=True, env=environment)
        begun = time.perf_counter()
        subprocess.run([*command, "--out", f"{folder}/run"], check=True, env=environment)
        return time.perf_counter() - begun


def measures() -> list[Measure]:
    """All figures of cost."""
    run = "fluid-solver run dam_break --set end_time=1e-4"
    found = []
    for model, rate, interval in (("wcsph", 16.0, 0.12), ("ctvf", 10.0, 0.25)):
        at = f"fluid-solver bench --model {model} --particles {PARTICLES} --threads"
        name = f"180 k particles, {model}"

        def of(key, scale, threads=1, model=model):
            return partial(_of_bench, key, scale, PARTICLES, model, threads)

        found += [
            Measure(f"{name}, 1 thread", f"{at} 1", of("particle_steps_per_s", 1e-6), "million/s"),
            Measure(f"{name}, 2 threads", f"{at} 2", of("particle_steps_per_s", 1e-6, 2), "million/s", least=rate),
            Measure(f"{name}, 2 threads over 1", f"{at} 1 --threads 2", partial(_gain, model), "times", least=1.7),
            Measure(f"{name}, core time per dx/c0", f"{at} 1", of("interval_s", 1e6), "µs", most=interval),
            Measure(f"{name}, memory", f"{at} 1", of("bytes_per_particle", 1.0), "bytes", most=400.0),
            Measure(
                f"{model}, step after 0.7 s of dam break over the first",
                "python -m tests.benchmark_fluids --only 'step after'",
                partial(slowing, model),
                "times",
                most=1.15,
            ),
        ]
    found += [
        Measure("start-up to the end of the first step, warm cache", run, partial(start_up, False), "s", most=3.0),
        Measure("start-up to the end of the first step, cold cache", run, partial(start_up, True), "s", most=20.0),
    ]
    return found
