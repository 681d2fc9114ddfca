"""The four sweeps over pairs that a step is made of, compiled of the terms that a scene uses."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fluid_solver.forces import make_forces
from fluid_solver.rates import make_rates
from fluid_solver.walls import make_ghost_velocity, make_ghosts


class Sweeps(NamedTuple):
    """In the order in which a step calls them."""

    ghost_velocity: Callable[..., None]
    rates: Callable[..., None]
    ghosts: Callable[..., None]
    forces: Callable[..., None]


def make_sweeps(kernel: int, viscous: bool, transported: bool) -> Sweeps:
    """For a kernel code; `viscous`: with viscosity of the fluid's own; `transported`: EDAC pressure, transport velocity
    and shifting (ctvf)."""
    return Sweeps(
        make_ghost_velocity(kernel, viscous),
        make_rates(kernel, transported),
        make_ghosts(kernel, viscous),
        make_forces(kernel, viscous, transported),
    )
