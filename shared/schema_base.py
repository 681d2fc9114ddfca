"""What every table of the scene's vocabulary is made of."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

Pair = tuple[float, float]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*$")]


def key(default: Any = ..., *, unit: str = "", about: str, **limits: Any) -> Any:
    """A scene key: default, unit, meaning and range."""
    extra = {"unit": unit} if unit else None
    return Field(default, description=about, json_schema_extra=extra, **limits)


class Table(BaseModel):
    """A TOML table: unknown keys are refused, values are finite, nothing changes after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
