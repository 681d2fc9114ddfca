"""The scene's vocabulary: one class per table of the TOML file, one field per key.

Every field carries its meaning, unit, range and default here and nowhere else: `cases/SCENE.md`, the error
messages and the checks are made from it. All quantities SI, two dimensions, plane strain, per metre of depth.
"""

from __future__ import annotations

import itertools
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from shared.schema_base import Name, NonNegative, Pair, Positive, Table, key
from shared.schema_coupling import Column, Coupling

# ---- geometry --------------------------------------------------------------------------------------------


class Rotation(Table):
    angle: float = key(unit="degree", about="counter-clockwise angle")
    about: Pair = key((0.0, 0.0), unit="m", about="point that stays where it is")


class Circle(Table):
    centre: Pair = key(unit="m", about="centre")
    radius: Positive = key(unit="m", about="radius")


SHAPE_KINDS = ("rectangle", "circle", "polygon", "union", "difference")


class Shape(Table):
    """A region of the plane: exactly one of rectangle, circle, polygon, union, difference; then rotated."""

    rectangle: tuple[float, float, float, float] | None = key(
        None, unit="m", about="x0, y0, x1, y1 with x0 < x1, y0 < y1"
    )
    circle: Circle | None = key(None, about="{ centre = [x, y], radius = r }")
    polygon: list[Pair] | None = key(None, unit="m", about="three or more corners in order, not self-crossing")
    union: list[Shape] | None = key(None, about="shapes whose regions are joined")
    difference: list[Shape] | None = key(None, about="first shape less all the others")
    rotate: Rotation | None = key(None, about="{ angle, about }: turns the shape and its particle lattice")

    @field_validator("rectangle")
    @classmethod
    def _rectangle_has_area(cls, corners):
        if corners is not None and not (corners[0] < corners[2] and corners[1] < corners[3]):
            raise ValueError("[x0, y0, x1, y1] needs x0 < x1 and y0 < y1")
        return corners

    @field_validator("polygon")
    @classmethod
    def _polygon_has_corners(cls, corners):
        if corners is not None and len(set(corners)) < max(3, len(corners)):
            raise ValueError("needs three or more corners, each once")
        return corners

    @field_validator("difference")
    @classmethod
    def _difference_takes_away(cls, parts):
        if parts is not None and len(parts) < 2:
            raise ValueError("needs a shape and at least one to take away")
        return parts

    @field_validator("union")
    @classmethod
    def _union_has_parts(cls, parts):
        if parts is not None and len(parts) < 1:
            raise ValueError("needs at least one shape")
        return parts

    @model_validator(mode="after")
    def _exactly_one_kind(self):
        given = [kind for kind in SHAPE_KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            raise ValueError(f"give exactly one of {', '.join(SHAPE_KINDS)}; found {', '.join(given) or 'none'}")
        return self


MOST_PRESTRAIN = 0.3  # past it the models' laws, and what the word strain means, part ways


class Body(Shape):
    """A named region filled with particles at the side's dx."""

    name: Name = key(about="name, unique in the scene")
    velocity: Pair = key((0.0, 0.0), unit="m/s", about="initial velocity, uniform")


FaceName = Literal["left", "right", "bottom", "top"]


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


class Motion(Table):
    """Prescribed motion by a time table, interpolated by a monotone cubic, held after its last time."""

    times: list[float] = key(unit="s", about="increasing times, the first 0", min_length=2)
    translation: list[Pair] | None = key(None, unit="m", about="displacement at each time")
    rotation: list[float] | None = key(None, unit="degree", about="counter-clockwise angle at each time")
    about: Pair = key((0.0, 0.0), unit="m", about="centre of the rotation, in the reference position")

    @model_validator(mode="after")
    def _lengths(self):
        if self.times[0] != 0.0 or any(b <= a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise ValueError(f"times must start at 0 and increase; got {self.times}")
        for k in ("translation", "rotation"):
            column = getattr(self, k)
            if column is not None and len(column) != len(self.times):
                raise ValueError(f"{k} has {len(column)} entries for {len(self.times)} times")
        if self.translation is None and self.rotation is None:
            raise ValueError("give translation, rotation or both")
        return self


class Wall(Table):
    """A wall of ghost particles behind a polyline; the fluid is on the polyline's left."""

    name: Name = key(about="name, unique in the scene")
    polyline: list[Pair] = key(
        unit="m", about="corners of the wetted face, walked with the fluid on the left", min_length=2
    )
    closed: bool = key(False, about="join the last corner to the first")
    slip: Literal["free", "no"] = key(
        "free", about="free: no friction; no: the fluid sticks to the wall (needs viscosity)"
    )
    motion: Motion | None = key(None, about="prescribed motion; absent: fixed")
    surface_speed: float = key(
        0.0,
        unit="m/s",
        about="speed of the wall's face along its polyline while the wall stays: a sliding lid, a belt, a drum",
    )

    @field_validator("polyline")
    @classmethod
    def _polyline_moves_on(cls, corners):
        if any(a == b for a, b in itertools.pairwise(corners)):
            raise ValueError("has the same corner twice in a row")
        return corners

    @model_validator(mode="after")
    def _closes_once(self):
        if self.closed and self.polyline[0] == self.polyline[-1]:
            raise ValueError("closed = true joins the last corner to the first; leave the repeated corner out")
        return self

    @model_validator(mode="after")
    def _face_slides(self):
        if self.surface_speed and self.slip == "free":
            raise ValueError('surface_speed drags the fluid only with slip = "no"')
        if self.surface_speed and self.motion is not None:
            raise ValueError("give either motion or surface_speed")
        return self


# ---- the two sides ---------------------------------------------------------------------------------------

KernelName = Literal["wendland-c2", "quintic-spline"]


class VelocityField(Table):
    """Initial velocity of a body of water, added to its uniform one.

    With k = 2π/wavelength and speed U: taylor-green: u = U sin kx cos ky, v = −U cos kx sin ky, and its pressure
    ρU²/4 (cos 2kx + cos 2ky) on top of the initial one; standing-wave: the wave as its surface passes through level,
    u = −U sin kx cosh kz / sinh kH, v = U cos kx sinh kz / sinh kH, z from the body's bottom, H its height. Then the
    surface rises to U/ω in its crests.
    """

    kind: Literal["taylor-green", "standing-wave"] = key(about="which field")
    speed: float = key(unit="m/s", about="U: largest speed, of the standing wave that of the surface's crests")
    wavelength: Positive = key(unit="m", about="wavelength of the field; x = y = 0 is a corner of a vortex or a crest")


class FluidBody(Body):
    """A named region of water."""

    velocity_field: VelocityField | None = key(None, about="initial velocity that varies in space, added to velocity")


class Periodic(Table):
    """What leaves the interval on one side comes in on the other; walls and bodies lie inside."""

    x: Pair | None = key(None, unit="m", about="x0, x1 with x0 < x1; absent: not periodic along x")
    y: Pair | None = key(None, unit="m", about="y0, y1 with y0 < y1; absent: not periodic along y")

    @field_validator("x", "y")
    @classmethod
    def _has_length(cls, bounds):
        if bounds is not None and not bounds[0] < bounds[1]:
            raise ValueError("[from, to] needs from < to")
        return bounds


class Fluid(Table):
    model: Literal["ctvf", "wcsph", "still", "column"] = key(
        about=(
            "ctvf: EDAC pressure, transport velocity, shifting; wcsph: equation of state, no shifting; "
            "still: water at rest, its weight on the structure's faces; "
            "column: one-dimensional columns standing side by side on the wetted faces (sound or added mass, no flow)"
        )
    )
    dx: Positive = key(unit="m", about="particle spacing; each body fits it per axis, n = round(L/dx)")
    density: Positive = key(1000.0, unit="kg/m³", about="reference density")
    viscosity: NonNegative = key(0.0, unit="m²/s", about="kinematic laminar viscosity")
    alpha: NonNegative = key(0.1, unit="-", about="artificial viscosity coefficient (Monaghan's α)")
    sound_speed: Positive | Literal["auto"] = key(
        "auto",
        unit="m/s",
        about=(
            "artificial sound speed; auto: 10 times the largest speed expected (free fall over the "
            "fluid's height, and initial or wall speeds)"
        ),
    )
    kernel: KernelName = key("wendland-c2", about="smoothing kernel")
    h_over_dx: float = key(
        1.3,
        unit="-",
        about=(
            "smoothing length over spacing. 1.3 (21 neighbours with wendland-c2): violent flows; 2.0 (50): water at "
            "rest, waves, bodies under water, where a lattice of few neighbours bears shear and pressures are 1 % off; "
            "3.0 (113): viscous flows to a fraction of a percent"
        ),
        ge=0.8,
        le=3.0,
    )
    courant: Annotated[float, Field(gt=0.0, le=3.0)] | Literal["auto"] = key(
        "auto",
        unit="-",
        about="time step over h/(c0 + speed); auto: measured to be stable and accurate, 0.9 for ctvf, 1.3 for wcsph",
    )
    initial_pressure: Literal["hydrostatic", "zero"] = key(
        "hydrostatic",
        about="hydrostatic: each body starts as a settled compressible column; zero: at rest density",
    )
    negative_pressure: Literal["limited", "none", "free"] = key(
        "limited",
        about=(
            "tension in the fluid. limited: down to 1 % of ρ c², twice the dynamic pressure of the fastest flow "
            "expected; none: cut at zero; free: as it comes, particles may clump. Probe clipped-impulse: what was cut"
        ),
    )
    shake: float = key(
        0.0,
        unit="dx",
        about=(
            "random displacement of every particle at t = 0, so that no lattice has to break up first: flows that "
            "stretch water all over want 0.2"
        ),
        ge=0.0,
        le=0.3,
    )
    structure_acceleration: bool = key(
        True, about="the structure's mean acceleration enters the ghost pressure (eq. 14)"
    )
    column: Column = key(Column(), about="what model column is like")
    periodic: Periodic = key(Periodic(), about="{ x = [x0, x1], y = [y0, y1] }: periodic directions; absent: none")
    bodies: list[FluidBody] = key(about="regions of water", min_length=1)


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


RIGID_MODELS = ("rigid", "spring")
PARTICLE_MODELS = ("total-lagrangian", "ctvf")


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
    damping: NonNegative = key(0.0, unit="1/s", about="rate η of the damping force −η m u")
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
            "1.5 % (quadratic), at two to three times linear's work: quadratic is cheapest for a wanted error"
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


# ---- what is observed ------------------------------------------------------------------------------------

Quantity = Literal[
    "displacement-x",
    "displacement-y",
    "pressure",
    "velocity-x",
    "velocity-y",
    "elevation",
    "front-x",
    "level",
    "max-speed",
    "kinetic-energy",
    "total-energy",
    "clipped-impulse",
    "strain-energy",
    "external-work",
    "dissipated",
    "momentum-x",
    "momentum-y",
    "angular-momentum",
    "reaction-x",
    "reaction-y",
    "stress-xx",
    "stress-yy",
    "stress-xy",
    "von-mises",
    "spacing-max",
    "force-x",
    "force-y",
    "leaked",
]


class Probe(Table):
    name: Name = key(about="name, unique in the scene")
    quantity: Quantity = key(
        about=(
            "displacement-x, -y: of a material point of a solid; pressure, velocity-x, -y: of the fluid at a "
            "point; elevation: of the fluid's surface over a point; front-x, level: largest x and y of connected "
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


class Output(Table):
    frames: int = key(50, about="frames written per side, evenly over the run, besides the first", ge=1, le=10000)
    probe_interval: Positive | Literal["auto"] = key(
        "auto", unit="s", about="time between probe rows; auto: end_time/1000"
    )
    average_from: NonNegative = key(0.0, unit="s", about="start of the means")
    exchange: bool = key(
        False, about="whether a coupled run records what either side is told, for --replay (large: all windows)"
    )
    checkpoint_every: NonNegative = key(
        60.0, unit="s", about="wall time between checkpoints, from which `coupler resume` goes on; 0: none"
    )


class Domain(Table):
    lower: Pair = key(unit="m", about="lower left corner")
    upper: Pair = key(unit="m", about="upper right corner")


class Family(Table):
    """Variants of one kind, a line on the chart: every combination of one setting of each axis."""

    name: str = key(about="what the line is called")
    sets: list[str] = key([], about="what all its variants change, each path.to.key=value as after --set")
    vary: list[list[list[str]]] = key(
        [], about="axes; an axis is a list of settings; a setting is a list of path.to.key=value"
    )


class Study(Table):
    """What `coupler chart` runs: variants of the scene, judged by the goal's probe and statistic."""

    truth: str | None = key(
        None, about="name of the reference that errors are measured against; absent: the finest variant that was run"
    )
    sets: list[str] = key([], about="what all variants change, each path.to.key=value as after --set")
    families: list[Family] = key(about="kinds of variants", min_length=1)


class Scene(Table):
    """A whole scene file."""

    schema_version: Literal[1] = Field(alias="schema", description="version of this vocabulary: 1")
    title: str = key(about="one line")
    description: str = key("", about="what the case shows")
    end_time: Positive = key(unit="s", about="simulated time")
    gravity: Pair = key((0.0, 0.0), unit="m/s²", about="gravitational acceleration")
    domain: Domain | Literal["auto"] = key(
        "auto",
        about=(
            "{ lower, upper }: fluid that leaves it is taken out and counted; auto: everything in the "
            "scene, with three times its height above"
        ),
    )
    fluid: Fluid | None = key(None, about="the fluid side; absent: solid alone")
    walls: list[Wall] = key([], about="walls of the fluid")
    solid: Solid | None = key(None, about="the solid side; absent: fluid alone")
    coupling: Coupling = key(Coupling(), about="how the two sides are coupled")
    probes: list[Probe] = key([], about="time histories")
    references: list[Reference] = key([], about="what probes are compared with")
    goal: Goal | None = key(None, about="what is accurate enough")
    output: Output = key(Output(), about="what is written")
    study: Study | None = key(None, about="variants for `coupler chart`; not used by a run")

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True)
