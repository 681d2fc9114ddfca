"""The `fluid-solver` command line."""

from __future__ import annotations

from fluid_solver.models import make_model
from shared.commands import run_app
from shared.solver_cli import solver_app

app = solver_app("fluid", make_model)


def main() -> None:
    """Entry point."""
    run_app(app)
