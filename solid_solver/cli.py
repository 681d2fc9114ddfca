"""The `solid-solver` command line."""

from __future__ import annotations

from shared.commands import run_app
from shared.solver_cli import solver_app
from solid_solver.models import make_model

app = solver_app("solid", make_model)


def main() -> None:
    """Entry point."""
    run_app(app)
