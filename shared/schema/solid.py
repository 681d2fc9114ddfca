"""The scene's vocabulary of the solid side: bodies, clamps, loads, springs, and the models' settings."""

from __future__ import annotations

import itertools
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from shared.schema.base import Name, NonNegative, Pair, Positive, Table, key
from shared.schema.fluid import KernelName
from shared.schema.geometry import Body, FaceName, Motion

RIGID_MODELS = ("rigid", "spring")

PARTICLE_MODELS = ("total-lagrangian", "ctvf")

MOST_PRESTRAIN = 0.3  # past it the models' laws, and what the word strain means, part ways


class VelocityMode(Table):
    """Initial velocity of a slender rectangle in the shape of a bending mode of the thin cantilever.

    Across the length, v = V F(x)/F(L) with F the mode's shape from the clamped face to the tip, towards a quarter turn
    counter-clockwise from the way to the tip.
    """

    clamped: FaceName = key(about="short face that holds the cantilever, in the body's own frame before rotation")
    mode: Annotated[int, Field(ge=1, le=4)] = key(1, about="number of the bending mode")
    tip_speed: float | None = key(None, unit="m/s", about="speed V of the tip")
    tip_speed_over_c0: float | None = key(
        None, unit="-", about="speed V of the tip over c0 = √(K/ρ), K the bulk modulus; V_f of the oscillating plate"
    )

    @model_validator(mode="after")
    def _one_speed(self):
        if (self.tip_speed is None) == (self.tip_speed_over_c0 is None):
            raise ValueError("give either tip_speed or tip_speed_over_c0")
        return self


class SolidBody(Body):
    """A named elastic region."""

    free: bool = key(False, about="true: the body is meant to have no clamp and moves freely")
    velocity_mode: VelocityMode | None = key(None, about="initial velocity by bending mode, added to velocity")
    spin: float = key(
        0.0, unit="rad/s", about="initial rotation about the body's centre, counter-clockwise, added to velocity"
    )
    prestrain: tuple[float, float, float] = key(
        (0.0, 0.0, 0.0),
        unit="-",
        about="uniform stretch ε_xx, ε_yy, ε_xy of the body about its centre at t = 0, in the scene's axes",
    )

    @field_validator("prestrain")
    @classmethod
    def _prestrain_is_elastic(cls, strain):
        if max(map(abs, strain)) > MOST_PRESTRAIN:
            raise ValueError(f"{list(strain)}: no component may exceed {MOST_PRESTRAIN:g}")
        return strain


class Clamp(Table):
    body: Name = key(about="a body of the solid")
    face: str = key(
        about=("left, right, bottom, top (in the body's own frame before rotation), or edge-N of a polygon (N from 0)")
    )
    motion: Motion | None = key(None, about="prescribed motion of the held face, from rest in its place; absent: fixed")


class TimeTable(Table):
    """A factor against time, linear between the times, held before the first and after the last."""

    times: list[float] = key(unit="s", about="increasing times", min_length=2)
    factors: list[float] = key(unit="-", about="the load's factor at each time", min_length=2)

    @model_validator(mode="after")
    def _lengths(self):
        if any(b <= a for a, b in itertools.pairwise(self.times)):
            raise ValueError(f"times must increase; got {self.times}")
        if len(self.factors) != len(self.times):
            raise ValueError(f"factors has {len(self.factors)} entries for {len(self.times)} times")
        return self


class Load(Table):
    """A traction on a face or an acceleration of a whole body, switched on at t = 0, ramped, or by a time table."""

    body: Name = key(about="a body of the solid")
    face: str | None = key(None, about="face that carries the traction")
    traction: Pair | None = key(
        None, unit="Pa", about="force per area of the undeformed face, direction kept (dead load)"
    )
    acceleration: Pair | None = key(None, unit="m/s²", about="body force per mass")
    ramp: NonNegative = key(0.0, unit="s", about="the load grows smoothly (half cosine) from zero over this time")
    table: TimeTable | None = key(None, about="{ times, factors }: the load follows this table instead of a ramp")
    following: bool = key(
        False,
        about=(
            "true: the traction turns with its face and acts per deformed area, as a pressure does; false: dead load"
        ),
    )

    @model_validator(mode="after")
    def _kind(self):
        if self.table is not None and self.ramp > 0.0:
            raise ValueError("give either ramp or table")
        if self.following and self.traction is None:
            raise ValueError("following = true needs face and traction")
        if (self.traction is None) == (self.acceleration is None):
            raise ValueError("give either face and traction, or acceleration")
        if (self.traction is None) != (self.face is None):
            raise ValueError("face and traction belong together")
        return self


Springs = tuple[NonNegative, NonNegative, NonNegative]


class Spring(Table):
    """What holds each body of model spring: to the place and angle where it stands at t = 0."""

    stiffness: Springs = key(
        (0.0, 0.0, 0.0),
        unit="N/m, N/m, N m",
        about="per metre of depth: against the centre of mass moving along x, y, and against rotation; none negative",
    )
    damping: Springs = key(
        (0.0, 0.0, 0.0),
        unit="N s/m, N s/m, N m s",
        about="per metre of depth: against the rates of the same motions; none negative",
    )


class Solid(Table):
    model: Literal["total-lagrangian", "ctvf", "beam", "rigid", "spring"] = key(
        about=(
            "total-lagrangian: fixed neighbours, quadratic fit; ctvf: updated Lagrangian with iterative shifting; "
            "beam: slender rectangles as Timoshenko beams; rigid: fixed, or moved by solid.motion; "
            "spring: rigid bodies on springs and dampers, or free"
        )
    )
    dx: Positive = key(unit="m", about="particle spacing; each body fits it per axis")
    density: Positive = key(unit="kg/m³", about="reference density")
    youngs_modulus: Positive | None = key(
        None, unit="Pa", about="Young's modulus; needed by all models but rigid and spring"
    )
    poisson_ratio: float = key(0.0, unit="-", about="Poisson's ratio, plane strain", ge=0.0, lt=0.5)
    damping: NonNegative = key(
        0.0,
        unit="1/s",
        about="rate η of the damping force −η m u, u the velocity in the scene: it brakes what clamps carry along",
    )
    alpha: NonNegative = key(
        1.0,
        unit="-",
        about="artificial viscosity (Monaghan's α): damps the lattice's own highest modes, which a fluid could feed",
    )
    kernel: KernelName = key("wendland-c2", about="smoothing kernel")
    h_over_dx: float = key(1.3, unit="-", about="smoothing length over spacing", ge=0.8, le=3.0)
    gradient: Literal["printed", "linear", "quadratic"] = key(
        "quadratic",
        about=(
            "velocity gradient of model ctvf: as printed, or corrected to be exact for linear or quadratic fields. "
            "A clamped beam 10 particles across is 40 %, 4.2 %, 0.7 % too soft, a coupled one 6 across 13 % (linear), "
            "1.5 % (quadratic), at two to three times linear's work: quadratic is cheapest for a wanted error, and "
            "bears more bending (case plate_step_load: 1500 Pa; linear tears at 1000 Pa)"
        ),
    )
    shifting: bool = key(
        True,
        about="particle shifting of model ctvf, evens out spacing: keeps a strip pulled under gradient printed whole",
    )
    courant: Annotated[float, Field(gt=0.0, le=1.0)] | Literal["auto"] = key(
        "auto",
        unit="-",
        about="time step over dx/c_p (P-wave speed); auto: measured to be stable for the model",
    )
    gravity: bool = key(True, about="the scene's gravity acts on the solid too")
    bodies: list[SolidBody] = key(about="elastic bodies", min_length=1)
    motion: Motion | None = key(
        None,
        about=(
            "prescribed motion of all bodies: of model rigid, or of total-lagrangian and ctvf without clamps, whose "
            "particles are then carried rigidly from their prestrained places; absent: rigid bodies stand still"
        ),
    )
    spring: Spring = key(Spring(), about="springs and dampers of model spring; as it stands, its bodies are free")
    clamps: list[Clamp] = key([], about="faces held fixed")
    loads: list[Load] = key([], about="tractions and accelerations")

    @model_validator(mode="after")
    def _elastic(self):
        if self.youngs_modulus is None and self.model not in RIGID_MODELS:
            raise ValueError(f"youngs_modulus is missing; Young's modulus [Pa] is needed by model {self.model}")
        return self
