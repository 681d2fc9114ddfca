"""The rows of the structures' benchmark: demand, case, settings, truth, and the error allowed."""

from __future__ import annotations

import math
from dataclasses import dataclass

STATIC = ("end_time=0.2",)  # three periods to average over, after 3 ζ-decades
BEAM_2D = {0.0: -5.98618e-5, 0.22: -5.7361e-5, 0.34: -5.3465e-5, 0.47: -4.7115e-5}
"""Mid deflection [m] of udl_beam by ν: quadratic finite elements, 128 × 12 graded; last change 1e-5 to 6e-4."""

PLATE_2D = -7.0668e-5
"""Mid deflection [m] of hydrostatic_plate under water and self-weight, mid-plane."""

STATIC_SPEEDS = {"udl_beam": 2.0 * math.pi * 30.25, "hydrostatic_plate": 2.0 * math.pi * 269.0}
"""First frequency [rad/s] of the cases whose static answer is taken from a damped run."""

PLATE_B = (
    "end_time=0.025",
    "output.average_from=0.0125",
    "solid.damping=1700.0",
    'solid.loads=[{ body = "plate", face = "top", traction = [0.0, -19620.0] }]',
)
"""hydrostatic_plate without its water: 2 m of it as a dead load."""


@dataclass(frozen=True)
class Row:
    """`statistic` of `probe` over `between` in a run of `case` with `sets`; `allowed`: largest relative error (absolute
    where the truth is 0)."""

    demand: str
    case: str
    sets: tuple[str, ...]
    probe: str
    statistic: str
    truth: float
    allowed: float | None
    between: tuple[float, float] | None = None


def _model(name: str) -> str:
    return f"solid.model={name}"


def _sets(name: str) -> tuple[str, ...]:
    """Settings of a model; ctvf at its best."""
    return (_model(name), "solid.gradient=quadratic") if name == "ctvf" else (_model(name),)


def _static() -> list[Row]:
    rows = []
    for across, allowed in ((6, None), (10, 0.015), (15, None), (20, 0.008)):
        dx = f"solid.dx={0.012 / across:.6g}"
        rows.append(
            Row(f"A static, {across} across", "udl_beam", (*STATIC, dx), "mid_y", "mean", BEAM_2D[0.0], allowed)
        )
    for nu in (0.22, 0.34, 0.47):
        sets = (*STATIC, f"solid.poisson_ratio={nu}")
        rows.append(Row(f"A static, 10 across, ν {nu}", "udl_beam", sets, "mid_y", "mean", BEAM_2D[nu], 0.015))
    for alpha in (0.3, 3.0):
        sets = (*STATIC, f"solid.alpha={alpha}")
        rows.append(Row(f"A static, viscosity × {alpha:g}", "udl_beam", sets, "mid_y", "mean", BEAM_2D[0.0], 0.015))
    for across, allowed in ((6, None), (10, 0.015), (15, None), (20, 0.008)):
        sets = (*PLATE_B, f"solid.dx={0.05 / across:.6g}")
        rows.append(Row(f"B static, {across} across", "hydrostatic_plate", sets, "mid_y", "mean", PLATE_2D, allowed))
    for across in (10, 20):
        sets = (*PLATE_B, *_sets("ctvf"), f"solid.dx={0.05 / across:.6g}")
        allowed = {10: 0.04, 20: 0.02}[across]
        name = f"B static, ctvf quadratic, {across} across"
        rows.append(Row(name, "hydrostatic_plate", sets, "mid_y", "mean", PLATE_2D, allowed))
    for gradient, across, allowed in (
        ("quadratic", 6, None),
        ("quadratic", 10, 0.04),
        ("quadratic", 20, 0.02),
        ("linear", 10, None),
        ("printed", 10, None),
    ):
        sets = (*STATIC, _model("ctvf"), f"solid.gradient={gradient}", f"solid.dx={0.012 / across:.6g}")
        name = f"A static, ctvf {gradient}, {across} across"
        rows.append(Row(name, "udl_beam", sets, "mid_y", "mean", BEAM_2D[0.0], allowed))
    sets = (*STATIC, _model("beam"), "solid.dx=1e-3")
    return [*rows, Row("A static, beam (Timoshenko)", "udl_beam", sets, "mid_y", "mean", -5.98704e-5, 0.001)]


def _step_load() -> list[Row]:
    rows = []
    for model, limits in (
        ("total-lagrangian", (0.01, 0.02, 0.02)),
        ("beam", (0.01, 0.02, None)),
        ("ctvf", (None,) * 3),
    ):
        case, sets = "udl_beam_dynamic", _sets(model)
        first, tenth = (0.0, 0.033056), (0.2975, 0.3305)
        rows += [
            Row(f"A step load, period, {model}", case, sets, "mid_y", "period", 0.0330556, limits[0]),
            Row(f"A step load, first peak, {model}", case, sets, "mid_y", "min", -1.19656e-4, limits[1], first),
            Row(f"A step load, tenth peak, {model}", case, sets, "mid_y", "min", -1.19761e-4, limits[2], tenth),
        ]
    for model, allowed in (("total-lagrangian", 0.02), ("beam", 0.02), ("ctvf", None)):
        case, sets, first = "plate_step_load", _sets(model), (0.0, 0.12)
        rows += [
            Row(f"plate step load, peak, {model}", case, sets, "tip_x", "max", 0.04146, allowed, first),
            Row(f"plate step load, its time, {model}", case, sets, "tip_x", "t_max", 0.0845, allowed, first),
        ]
    return rows


def _oscillating() -> list[Row]:
    rows, case, first = [], "oscillating_plate", (0.0, 0.13)
    limits = {"total-lagrangian": (0.015, 0.02), "beam": (0.015, 0.02), "ctvf": (0.04, 0.04)}
    for model, (period, amplitude) in limits.items():
        sets = _sets(model)
        rows += [
            Row(f"oscillating plate, period, {model}", case, sets, "tip_y", "period", 0.2549, period),
            Row(f"oscillating plate, amplitude, {model}", case, sets, "tip_y", "max", 0.1066, amplitude, first),
        ]
    speed = "solid.bodies[0].velocity_mode.tip_speed_over_c0"
    variants = {
        (f"{speed}=0.001",): ("V_f 0.001", 0.25501),
        ("solid.poisson_ratio=0.22",): ("ν 0.22", 0.27154),
        ("solid.poisson_ratio=0.47", f"{speed}=0.001"): ("ν 0.47, V_f 0.001", 0.24491),
    }
    for sets, (name, truth) in variants.items():
        rows.append(Row(f"oscillating plate, period, {name}", case, sets, "tip_y", "period", truth, 0.015))
    sets = (*_sets("ctvf"), "solid.poisson_ratio=0.47", f"{speed}=0.02")
    rows.append(Row("oscillating plate, gap, ctvf, ν 0.47", case, sets, "gap", "max", 1.0, 0.3))
    return [*rows, Row("oscillating plate, gap, ctvf, ν 0.3975", case, _sets("ctvf"), "gap", "max", 1.0, 0.3)]


def _momenta() -> list[Row]:
    rows = []
    for model, allowed in (("total-lagrangian", 1e-12), ("ctvf", 1e-6)):
        for probe in ("stress_xx", "stress_yy", "stress_xy"):
            sets = (_model(model),)
            rows.append(
                Row(f"a turn of 360°, {probe}, {model}", "prescribed_spin", sets, probe, "change", 0.0, allowed)
            )
    for model, allowed in (("total-lagrangian", 1e-12), ("ctvf", 1e-10)):
        for probe in ("momentum_x", "angular_momentum", "energy_lost"):
            which, limit = ("final", None) if probe == "energy_lost" else ("change", allowed)
            name = f"free square, {probe}, {model}"
            rows.append(Row(name, "spinning_square", _sets(model), probe, which, 0.0, limit))
    nearly, without = "solid.poisson_ratio=0.47", "solid.shifting=false"
    for name, sets, allowed in (
        ("ctvf", (), 0.3),
        ("ctvf, ν 0.47", (nearly,), 0.3),
        ("ctvf linear", ("solid.gradient=linear",), 0.3),
        ("ctvf without shifting", (without,), 0.3),
        ("ctvf printed, with shifting", ("solid.gradient=printed",), None),
        ("ctvf printed, without shifting", ("solid.gradient=printed", without), None),
    ):
        sets = (*_sets("ctvf"), *sets)
        rows.append(Row(f"stretched strip, gap, {name}", "stretched_strip", sets, "gap", "max", 1.0, allowed))
    return rows


def _gravity() -> list[Row]:
    limits = {"total-lagrangian": 0.015, "beam": 0.002, "ctvf": None}
    return [
        Row(f"cantilever, {m}", "cantilever_gravity", _sets(m), "tip_y", "mean", -0.029166, limit)
        for m, limit in limits.items()
    ]


def _speed() -> list[Row]:
    """Rates are in the last columns: of 4,000 particles, and of 20,000."""
    rows = []
    for model, dx, end in (
        ("total-lagrangian", 7.7e-4, 0.02),
        ("ctvf", 7.7e-4, 0.01),
        ("ctvf quadratic", 7.7e-4, 0.01),
        ("total-lagrangian", 3.46e-4, 4e-3),
    ):
        sets = (
            *(_sets("ctvf") if model == "ctvf quadratic" else (_model(model), "solid.gradient=linear")),
            f"solid.dx={dx:g}",
            f"end_time={end:g}",
            "output.average_from=0",
            "output.probe_interval=5e-4",
        )
        rows.append(Row(f"speed, {model}, dx {dx:g}", "udl_beam", sets, "mid_y", "final", 0.0, None))
    return rows


def rows() -> list[Row]:
    """All rows of the table."""
    return [*_static(), *_step_load(), *_oscillating(), *_momenta(), *_gravity(), *_speed()]
