"""The scene's vocabulary: one class per table of the TOML file, one field per key; a whole scene.

Every field carries its meaning, unit, range and default here and in the modules beside, and nowhere else:
`cases/SCENE.md`, the error messages and the checks are made from it. All quantities SI, two dimensions, plane strain,
per metre of depth.
"""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from shared.schema.base import NonNegative, Pair, Positive, Table, key
from shared.schema.coupling import Coupling
from shared.schema.fluid import Fluid, Wall
from shared.schema.geometry import Domain
from shared.schema.probes import Goal, Probe, Reference
from shared.schema.solid import Solid


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
