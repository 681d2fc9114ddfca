"""The scene's vocabulary of what is observed, what it is compared with, and what is good enough."""

from __future__ import annotations

from typing import Literal, NamedTuple

from pydantic import model_validator

from shared.schema.base import Name, Pair, Positive, Table, key


class Observable(NamedTuple):
    """What a quantity is: its `unit`, per metre of depth; the kinds of body that it can be `of`, and whether a `body`
    must be named; whether it is at a `point`."""

    unit: str
    of: tuple[str, ...] = ()
    body: bool = False
    point: bool = False


QUANTITIES = {
    "displacement-x": Observable("m", ("solid",), body=True, point=True),
    "displacement-y": Observable("m", ("solid",), body=True, point=True),
    "pressure": Observable("Pa", point=True),
    "velocity-x": Observable("m/s", point=True),
    "velocity-y": Observable("m/s", point=True),
    "elevation": Observable("m", point=True),
    "front-x": Observable("m", ("fluid",)),
    "level": Observable("m", ("fluid",)),
    "max-speed": Observable("m/s", ("fluid", "solid"), body=True),
    "kinetic-energy": Observable("J/m", ("fluid", "solid"), body=True),
    "total-energy": Observable("J/m", ("fluid",)),
    "clipped-impulse": Observable("N s/m"),
    "strain-energy": Observable("J/m", ("solid",), body=True),
    "external-work": Observable("J/m", ("solid",), body=True),
    "dissipated": Observable("J/m", ("solid",), body=True),
    "momentum-x": Observable("N s/m", ("solid",), body=True),
    "momentum-y": Observable("N s/m", ("solid",), body=True),
    "angular-momentum": Observable("N s", ("solid",), body=True),
    "reaction-x": Observable("N/m", ("solid",), body=True),
    "reaction-y": Observable("N/m", ("solid",), body=True),
    "stress-xx": Observable("Pa", ("solid",), body=True, point=True),
    "stress-yy": Observable("Pa", ("solid",), body=True, point=True),
    "stress-xy": Observable("Pa", ("solid",), body=True, point=True),
    "von-mises": Observable("Pa", ("solid",), body=True, point=True),
    "spacing-max": Observable("-", ("solid",), body=True),
    "force-x": Observable("N/m", ("solid", "wall"), body=True),
    "force-y": Observable("N/m", ("solid", "wall"), body=True),
    "leaked": Observable("particles"),
}
"""All that a probe can observe."""
Quantity = Literal[tuple(QUANTITIES)]
FORCES = ("force-x", "force-y")
"""Of a body of the solid, or a wall, that the fluid knows: what it does to it."""
STRESSES = ("stress-xx", "stress-yy", "stress-xy", "von-mises")
MOMENTA = ("momentum-x", "momentum-y", "angular-momentum")
REACTIONS = ("reaction-x", "reaction-y")
SOLID_ONLY = tuple(name for name, what in QUANTITIES.items() if what.of == ("solid",))
"""Quantities of solid bodies alone, which not every model can express."""


class Probe(Table):
    name: Name = key(about="name, unique in the scene")
    quantity: Quantity = key(
        about=(
            "displacement-x, -y: of a material point of a solid; pressure, velocity-x, -y: of the fluid at a "
            "point (0 out of reach of water); elevation: of the fluid's surface over a point, up to the faces of walls "
            "and structures (none behind them, nor without water); front-x, level: largest x and y of connected "
            "fluid; max-speed, kinetic-energy: of a body; total-energy: of the fluid in motion, height (zero at the "
            "origin) and compression; clipped-impulse: sum of V Δp/c over all tension Δp that "
            "fluid.negative_pressure cut off so far; strain-energy, "
            "external-work (done by loads and fluid), dissipated (work and initial energy less the energy left: by "
            "damping, viscosity and the time integration), momentum-x, -y, angular-momentum (about the origin), "
            "reaction-x, -y (force of all clamps on the body), spacing-max (largest distance to the nearest particle "
            "over the spacing): of a solid body; stress-xx, -yy, -xy, von-mises: Cauchy stress at a material point of "
            "a solid; force-x, -y: of the fluid on a solid body or wall, mean over the last window; leaked: fluid "
            "particles through walls or out of the domain"
        )
    )
    body: Name | None = key(
        None,
        about="body or wall (needed by quantities of a solid, speed, energy, force; front, level: all fluid if absent)",
    )
    point: Pair | None = key(
        None, unit="m", about="material point in the reference configuration, or place in the fluid"
    )
    extent: Positive | None = key(
        None,
        unit="m",
        about="diameter of a sensor: pressure or velocity of the fluid averaged over it; absent: the kernel's support",
    )


Statistic = Literal[
    "mean", "min", "max", "final", "t_min", "t_max", "slope", "period", "change", "decay", "wave-period", "wave-decay"
]


class Reference(Table):
    """A value or curve that a probe is compared with."""

    probe: Name = key(about="the probe compared")
    name: str = key(about="who says so")
    value: float | None = key(
        None, about="reference value, in the probe's unit (t_min, t_max, period: s; slope: unit/s; change: none)"
    )
    curve: str | None = key(
        None, about="CSV of time [s] and value, path relative to the scene file or to the shipped cases"
    )
    scale: Pair = key((1.0, 1.0), about="factors that turn the curve's two columns into s and the probe's unit")
    delay: float = key(
        0.0, unit="s", about="how much later the run's clock started than the curve's: taken off the curve's times"
    )
    statistic: Statistic = key(
        "max",
        about=(
            "what is compared; mean is over output.average_from … end; period: mean time between crossings, all "
            "the same way, of the middle between the largest and the smallest value; change: last less first, over the "
            "largest size; decay: rate of an exponential decay [1/s]; wave-period, wave-decay: of a decaying "
            "oscillation, fitted"
        ),
    )
    between: Pair | None = key(
        None, unit="s", about="interval of the statistic; absent: the whole run (mean: from average_from)"
    )

    @model_validator(mode="after")
    def _kind(self):
        if (self.value is None) == (self.curve is None):
            raise ValueError("give either value or curve")
        if self.statistic == "slope" and self.between is None:
            raise ValueError("statistic slope needs between = [t0, t1]")
        if self.between is not None and not 0.0 <= self.between[0] < self.between[1]:
            raise ValueError(f"between = [t0, t1] needs 0 <= t0 < t1; got {list(self.between)}")
        return self


class Goal(Table):
    probe: Name = key(about="probe that matters")
    statistic: Statistic = key("max", about="its statistic")
    error: Positive = key(0.05, unit="-", about="wanted relative error")
