"""What a rule of pre-flight says, and what rules share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from coupler.preflight.measures.numbers import Numbers
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.probes import FORCES
from shared.schema.scene import Scene

Verdict = Literal["ok", "warn", "refuse"]

STEADY = ("mean",)  # statistics that do not feel how fast sound crosses the water
PUSHES = (*FORCES, "pressure")  # quantities that feel what rings in the water
COLUMN = 0.3
"""Bound of what columns make of the swing of a plate that bends."""


@dataclass(frozen=True)
class Finding:
    """What a rule says: its `value`, the verdict, one line of reason, and the way out where there is need for one."""

    rule: str
    value: float
    verdict: Verdict
    reason: str
    way_out: str = ""


Rule = Callable[[Scene, Numbers], Finding | None]


def graded(rule: str, value: float, verdict: Verdict, reason: str, way_out: str) -> Finding:
    """A finding whose way out is left away where all is well."""
    return Finding(rule, value, verdict, reason, "" if verdict == "ok" else way_out)


def above(value: float, warn: float, refuse: float = math.inf) -> Verdict:
    """Verdict on a number that should be small."""
    return "refuse" if value > refuse else "warn" if value > warn else "ok"


def below(value: float, warn: float, refuse: float = -math.inf) -> Verdict:
    """Verdict on a number that should be large."""
    slack = 1.0 - 1e-9
    return "refuse" if value < refuse * slack else "warn" if value < warn * slack else "ok"


def of_particles(n: Numbers) -> bool:
    """Whether the fluid is made of particles."""
    return n.water is not None and n.water.model in PARTICLE_FLUIDS
