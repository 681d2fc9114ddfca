"""The scene's vocabulary of the fluid side: water, walls, and the models' settings."""

from __future__ import annotations

import itertools
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from shared.schema.base import Name, NonNegative, Pair, Positive, Table, key
from shared.schema.geometry import Body, Motion

PARTICLE_FLUIDS = ("ctvf", "wcsph")  # models of particles, whose walls and structures are ghosts


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


class Column(Table):
    """Model column: each fluid body is a rectangle with one face on the structure; its far end is the opposite one."""

    far_end: Literal["open", "closed"] = key("open", about="open: at no pressure; closed: a fixed wall")
    reflection: Annotated[float, Field(ge=0.0, le=1.0)] = key(
        1.0, unit="-", about="amplitude d of a sound pulse after its way to the far end and back; 0: nothing comes back"
    )
    compressible: bool = key(
        True,
        about=(
            "true: sound at fluid.sound_speed, by characteristics; false: a column moves as one, which needs "
            'far_end = "open" and reflection = 1'
        ),
    )

    @model_validator(mode="after")
    def _incompressible_is_open(self):
        if not self.compressible and (self.far_end == "closed" or self.reflection != 1.0):
            raise ValueError('compressible = false needs far_end = "open" and reflection = 1: other water cannot move')
        return self


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
            "fluid's height, and on to floors below it where the run lasts so long, from its initial speed, the speed "
            "at which walls and structures push it, and what weight along a period gives it until the end, or until "
            "what sticks to walls holds it; what is moved to and fro by a table counts as a fall at its acceleration, "
            "and sound crosses the water in 0.4 rad of it), or √(ν U/dx) if more, U the speed at which the "
            "flow starts or is driven: viscous stresses press as much"
        ),
    )
    kernel: KernelName = key("wendland-c2", about="smoothing kernel")
    h_over_dx: float = key(
        1.3,
        unit="-",
        about=(
            "smoothing length over spacing. 1.3 (21 neighbours with wendland-c2): violent flows; 1.52 (29, at the same "
            "cost, for its steps are longer): waves, for a lattice under pressure bears shear, 11 % of the pressure "
            "with 1.3, and hardly any with 1.52 or the quintic-spline's 0.95; 2.0 (50): water at rest, bodies under "
            "water, where few neighbours put pressures 1 % off; "
            "3.0 (113): viscous flows to a fraction of a percent, but not those that walls hold: in a channel 16 dx "
            "wide water is 4.7 % too slow, with 2.0 0.4 % too fast"
        ),
        ge=0.8,
        le=3.0,
    )
    courant: Annotated[float, Field(gt=0.0, le=3.0)] | Literal["auto"] = key(
        "auto",
        unit="-",
        about=(
            "time step over h/(c0 + u), u half the largest relative speed of neighbours; "
            "auto: measured to be stable and accurate, 0.9 for ctvf, 1.3 for wcsph"
        ),
    )
    initial_pressure: Literal["hydrostatic", "zero"] = key(
        "hydrostatic",
        about="hydrostatic: each body starts as settled compressible columns, at no pressure where nothing covers "
        "them; zero: at rest density",
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
    structure_acceleration: bool | Literal["auto"] = key(
        "auto",
        about=(
            "whether the structure's mean acceleration enters the ghost pressure (eq. 14); auto: where the structure "
            "outweighs one layer of fluid particles, ρ_f dx ≤ ρ_s t: a lighter one is driven by it. Exchanges that "
            "extrapolate hold less: coupling.predictor 1, 2: 0.33, 0.14 of ρ_s t; parallel-explicit: 0.7, 0.09, 0.004. "
            "With coupling.loads = pressure half of the outermost layer of particles stands for t"
        ),
    )
    column: Column = key(Column(), about="what model column is like")
    periodic: Periodic = key(Periodic(), about="{ x = [x0, x1], y = [y0, y1] }: periodic directions; absent: none")
    bodies: list[FluidBody] = key(about="regions of water", min_length=1)
