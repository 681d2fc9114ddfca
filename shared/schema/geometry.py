"""The scene's vocabulary of places: shapes, named regions of them, and prescribed motion."""

from __future__ import annotations

from typing import Literal

from pydantic import field_validator, model_validator

from shared.schema.base import Name, Pair, Positive, Table, key


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


class Body(Shape):
    """A named region filled with particles at the side's dx."""

    name: Name = key(about="name, unique in the scene")
    velocity: Pair = key((0.0, 0.0), unit="m/s", about="initial velocity, uniform")


FaceName = Literal["left", "right", "bottom", "top"]


class Motion(Table):
    """Prescribed motion by a time table, held after its last time. Between the times a cubic, which rises and falls
    only where the table does, but turns smoothly where the table shows how, by two steps or more on either side of a
    turning point: 20 points a period of a sine make accelerations 2 % off, 40 make 0.3 %."""

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


class Domain(Table):
    lower: Pair = key(unit="m", about="lower left corner")
    upper: Pair = key(unit="m", about="upper right corner")
