"""What the structures' benchmark measures without a case's probes: invariance, tracers, what steps and answers cost."""

from __future__ import annotations

import time
from functools import partial

from shared.commands import default_threads
from shared.scene.reading import load_scene
from solid_solver.bench import run_benchmark
from solid_solver.models import make_model
from tests.benchmark_table import Measure
from tests.structures_invariance import VIEWS, changed_answer, tracer_error

SETTLED = 0.06  # s, when the damped beam of case A is at rest to 0.3 %


def rate(particles: int, model: str, gradient: str, threads: int, steps: int) -> float:
    """Million particle-steps per second."""
    return run_benchmark(particles, model, gradient, threads, steps)["particle_steps_per_s"] / 1e6


def bytes_of_state(particles: int, model: str, gradient: str) -> float:
    """Bytes of state per particle."""
    return run_benchmark(particles, model, gradient, 1, 1)["bytes_per_particle"]


def answer_time() -> float:
    """Seconds of processor time that model beam steps until case A's static answer; compiling and start left out."""
    model = make_model(load_scene("udl_beam", ["solid.model=beam"]), False, 1)
    model.begin(None)
    substeps = round(SETTLED / model.stable_step())
    begun = time.process_time()
    model.advance(0.0, SETTLED, substeps, None)
    return time.process_time() - begun


def _speeds() -> list[Measure]:
    two, result = default_threads(), []
    for name, particles, model, gradient, least in (
        ("total-lagrangian, 4,000 particles", 4000, "total-lagrangian", "linear", 15.0),
        ("total-lagrangian, 20,000 particles", 20000, "total-lagrangian", "linear", None),
        ("ctvf linear, 4,000 particles", 4000, "ctvf", "linear", 4.0),
        ("ctvf quadratic, 4,000 particles", 4000, "ctvf", "quadratic", None),
    ):
        command = f"solid-solver bench --particles {particles} --model {model} --gradient {gradient} --threads {two}"
        find = partial(rate, particles, model, gradient, two, 1000)
        result.append(Measure(f"speed, {name}, {two} threads", command, find, "M particle-steps/s", least=least))
    state = partial(bytes_of_state, 20000, "total-lagrangian", "linear")
    command = "solid-solver bench --particles 20000"
    return [*result, Measure("state, total-lagrangian, 20,000 particles", command, state, "bytes per particle")]


def measures() -> list[Measure]:
    """All rows of the table that are no run of a case."""
    invariance = "pytest tests/test_solid_ladder.py -k turned"
    result = [
        Measure(f"cantilever, {view}, {model}", invariance, partial(changed_answer, model, view), "relative", most=1e-8)
        for model in ("total-lagrangian", "ctvf")
        for view in VIEWS
    ]
    tracer = "pytest tests/test_solid_updated_runs.py -k tracers"
    result.append(
        Measure("tracers off the material while particles shift, ctvf", tracer, tracer_error, "dx", most=0.01)
    )
    solving = "pytest tests/test_solid_bench.py -k answer"
    result.append(Measure("beam, case A's static answer, stepping", solving, answer_time, "s", most=0.1))
    return [*result, *_speeds()]
