"""`python -m coupler`: the same as `coupler`."""

from coupler.cli import main

main()
