"""The `fluid-solver` command line."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from fluid_solver.bench import profile, run_benchmark
from fluid_solver.machine import copy_rate, multiply_add_rate
from fluid_solver.models import make_model
from shared.commands import run_app
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.solver_cli import solver_app

app = solver_app("fluid", make_model)
ModelName = StrEnum("ModelName", {name: name for name in PARTICLE_FLUIDS})


@app.command("bench")
def bench(
    model: Annotated[list[ModelName], typer.Option(help="Fluid model.")] = list(ModelName),  # noqa: B006
    particles: Annotated[list[int], typer.Option(help="Fluid particles.", min=1000)] = [10_000, 180_000, 1_000_000],  # noqa: B006
    threads: Annotated[list[int], typer.Option(help="Threads.", min=1)] = [1, 2],  # noqa: B006
) -> None:
    """Time whole steps of a dam break under way, walls counted; options may be given more than once."""
    table = Table("model", "fluid", "all", "threads", "million/s", "µs per dx/c0", "bytes", box=None)
    for name in model:
        for count in particles:
            for cores in threads:
                found = run_benchmark(count, name.value, cores)
                table.add_row(
                    name.value,
                    f"{found['fluid_particles']:.0f}",
                    f"{found['particles']:.0f}",
                    f"{cores}",
                    f"{found['particle_steps_per_s'] / 1e6:.2f}",
                    f"{found['interval_s'] * 1e6:.3f}",
                    f"{found['bytes_per_particle']:.0f}",
                )
    Console().print(table)
    print("million/s: particle-steps per second. µs per dx/c0: core time to advance a particle while")
    print("sound passes it. bytes: arrays of a step, per particle.")
    for name in model:
        print_profile(particles[len(particles) // 2], name.value)
    peak, copied = multiply_add_rate() / 1e9, copy_rate() / 1e9
    print(f"This machine, one core: {peak:.0f} GFLOP/s multiply-add, {copied:.0f} GB/s copy.")


def print_profile(particles: int, model: str) -> None:
    """Where a step's time goes."""
    found = profile(particles, model)
    table = Table(f"{model}, one thread", "ns per particle", "share", "GFLOP/s", box=None)
    for row in found:
        rate = f"{row['rate'] / 1e9:.1f}" if row["rate"] else ""
        table.add_row(row["stage"], f"{row['ns']:.0f}", f"{row['share']:.0%}", rate)
    Console().print(table)
    print(f"{found[0]['candidates']:.0f} candidates a particle and sweep, one square root each.\n")


def main() -> None:
    """Entry point."""
    run_app(app)
