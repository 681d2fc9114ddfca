"""`python -m solid_solver`: the same as `solid-solver`."""

from solid_solver.cli import main

main()
