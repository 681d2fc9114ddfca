"""What every table of the scene's vocabulary is made of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, field_validator

Pair = tuple[float, float]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,99}$")]  # pictures are called by it


def key(default: Any = ..., *, unit: str = "", about: str, **limits: Any) -> Any:
    """A scene key: default, unit, meaning and range."""
    extra = {"unit": unit} if unit else None
    return Field(default, description=about, json_schema_extra=extra, **limits)


_SMALLEST, _LARGEST = 1e-35, 1e35
"""Sizes that a scene's numbers may have, so that products of several, and what is divided by one, are numbers still;
those in a list, places and histories, may be as small as they like."""


class Table(BaseModel):
    """A TOML table: unknown keys are refused, values are finite and of a size that can be computed with, nothing
    changes after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @field_validator("*")
    @classmethod
    def _computable(cls, value: Any) -> Any:
        if any(abs(number) > _LARGEST for number in _numbers(value)):
            raise ValueError(f"must be at most {_LARGEST:g} in size")
        if isinstance(value, float) and 0.0 < abs(value) < _SMALLEST:
            raise ValueError(f"must be 0 or at least {_SMALLEST:g} in size")
        return value


def _numbers(value: Any) -> Iterator[float]:
    """The numbers in a key's value; a table in it has looked at its own."""
    if isinstance(value, int | float):
        yield value
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _numbers(item)
