"""The `solid-solver` command line."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from shared.commands import default_threads, run_app
from shared.schema.solid import Solid
from shared.solver_cli import solver_app
from solid_solver.bench import run_benchmark
from solid_solver.models import make_model
from solid_solver.updated_start import ORDERS

app = solver_app("solid", make_model)
ModelName = StrEnum("ModelName", {name: name for name in ("total-lagrangian", "ctvf", "beam")})
GradientName = StrEnum("GradientName", {name: name for name in ORDERS})
DEFAULT_MODEL = ModelName("total-lagrangian")
DEFAULT_GRADIENT = GradientName(Solid.model_fields["gradient"].default)


@app.command("bench")
def bench(
    model: Annotated[ModelName, typer.Option(help="Structure's model.")] = DEFAULT_MODEL,
    gradient: Annotated[GradientName, typer.Option(help="Gradient of model ctvf.")] = DEFAULT_GRADIENT,
    particles: Annotated[int, typer.Option(help="Particles.", min=200)] = 4000,
    threads: Annotated[int, typer.Option(help="Threads.", min=1)] = default_threads(),
    steps: Annotated[int, typer.Option(help="Steps timed.", min=1)] = 2000,
) -> None:
    """Time whole steps of a clamped beam: particle-steps per second."""
    found = run_benchmark(particles, model.value, gradient.value, threads, steps)
    speed = found["particle_steps_per_s"] / 1e6
    name = f"ctvf ({gradient.value})" if model.value == "ctvf" else model.value
    print(
        f"{name}, {found['particles']:.0f} particles of {found['bytes_per_particle']:.0f} bytes of state, "
        f"{threads} thread(s): {steps} steps in {found['wall_s']:.2f} s, {speed:.2f} million particle-steps per second"
    )


def main() -> None:
    """Entry point."""
    run_app(app)
