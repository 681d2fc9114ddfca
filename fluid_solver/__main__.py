"""`python -m fluid_solver`: the same as `fluid-solver`."""

from fluid_solver.cli import main

main()
