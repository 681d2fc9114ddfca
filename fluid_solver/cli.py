"""The `fluid-solver` command line."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from fluid_solver.bench import run_benchmark
from fluid_solver.models import MODELS, make_model
from shared.commands import default_threads, run_app
from shared.solver_cli import solver_app

app = solver_app("fluid", make_model)
ModelName = StrEnum("ModelName", {name: name for name in MODELS})
DEFAULT_MODEL = ModelName("ctvf")


@app.command("bench")
def bench(
    model: Annotated[ModelName, typer.Option(help="Fluid model.")] = DEFAULT_MODEL,
    particles: Annotated[int, typer.Option(help="Fluid particles.", min=1000)] = 180_000,
    threads: Annotated[int, typer.Option(help="Threads.", min=1)] = default_threads(),
    steps: Annotated[int, typer.Option(help="Steps timed.", min=1)] = 60,
) -> None:
    """Time whole steps of a dam break: particle-steps per second, walls counted."""
    found = run_benchmark(particles, model.value, threads, steps)
    speed = found["particle_steps_per_s"] / 1e6
    print(
        f"{model.value}, {found['fluid_particles']:.0f} fluid particles ({found['particles']:.0f} with walls), "
        f"{threads} thread(s): {steps} steps in {found['wall_s']:.2f} s, {speed:.2f} million particle-steps per second"
    )


def main() -> None:
    """Entry point."""
    run_app(app)
