"""The scene's vocabulary of coupling: schemes, acceleration, limits of the ledger."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from shared.schema.base import NonNegative, Positive, Table, key


class Limits(Table):
    """Limits of the ledger; the run stops past one. They count once the coupling is past its first windows."""

    energy: Positive = key(
        0.5,
        unit="-",
        about="largest energy made at the interface by the lag, over the largest work done there, or lost, over all "
        "the work turned over",
    )
    impulse: Positive = key(
        0.5, unit="-", about="largest difference of the impulses given and taken, over all that was exchanged"
    )
    mapping: Positive = key(
        1e-9, unit="-", about="largest difference of the total force before and after the map, over the sum of forces"
    )

    @field_validator("*")
    @classmethod
    def _computable(cls, value: float) -> float:
        return value  # compared with, never computed with: 1e300 is no limit


class Coupling(Table):
    """Serial: the structure first, then the fluid on its true motion; parallel: both at once, on predictions of both.

    Explicit: once per window. Implicit: repeated with better loads until the load used is the load found.
    """

    scheme: Literal["auto", "serial-explicit", "parallel-explicit", "serial-implicit", "parallel-implicit"] = key(
        "auto",
        about=(
            "auto: serial, explicit while the measured response of the load to itself is small and the ledger's energy "
            "keeps below half its limit, then implicit; reasons are in the coupler's log and in result.json"
        ),
    )
    window: Positive | Literal["auto"] = key(
        "auto",
        unit="s",
        about=(
            "coupling window; auto: up to four fluid steps, with α = ρ_f c Δt/(ρ_s t) at most 0.07, and at most 0.5 "
            "with a soft structure's spacing dx for t; one fluid step where it is iterated"
        ),
    )
    predictor: Literal[0, 1, 2] = key(0, about="order of the extrapolation from past windows")
    acceleration: Literal["constant", "aitken", "iqn-ils"] = key(
        "iqn-ils", about="how an implicit scheme finds its next load: relaxation, or quasi-Newton from differences"
    )
    relaxation: Annotated[float, Field(gt=0.0, le=2.0)] = key(
        0.5, unit="-", about="factor ω of constant relaxation; the others' first step"
    )
    reuse: Annotated[int, Field(ge=0, le=100)] = key(
        8, about="past windows whose differences iqn-ils goes on using; those that did not converge are left out"
    )
    tolerance: Annotated[float, Field(gt=0.0, lt=1.0)] = key(
        1e-4,
        unit="-",
        about="converged: the difference of load used and found, over the load found, is below this",
    )
    tolerance_absolute: NonNegative = key(1e-9, unit="N/m", about="or the difference itself is below this")
    max_iterations: Annotated[int, Field(ge=1, le=1000)] = key(30, about="most iterations of a window")
    on_cap: Literal["fail", "accept"] = key(
        "fail",
        about="a window not converged after max_iterations: fail: the run ends; accept, and always "
        "under scheme auto: it goes on, and such windows are counted",
    )
    loads: Literal["force", "pressure"] = key(
        "force",
        about=(
            "force: the structure takes the fluid's forces on the ghosts, action and reaction exactly; pressure: it "
            "integrates the ghosts' pressures over its own faces, for a body with water on one side"
        ),
    )
    limits: Limits = key(Limits(), about="limits of the ledger")
    stall_after: Positive = key(
        120.0, unit="s", about="a participant without progress for this long ends the run (exit code 4)"
    )
