"""The rows of the structures' benchmark: demand, case, settings, truth, and the error allowed."""

from __future__ import annotations

import math
from dataclasses import dataclass

BEAM_2D = {0.0: -5.98618e-5, 0.22: -5.7361e-5, 0.34: -5.3465e-5, 0.47: -4.7115e-5}
"""Mid deflection [m] of udl_beam by ν: quadratic finite elements, 128 × 12 graded; last change 1e-5 to 6e-4."""

PLATE_2D = {0.0: -7.9427e-5, 0.22: -7.5930e-5, 0.34: -7.0668e-5, 0.47: -6.2168e-5}
"""Mid deflection [m] by ν of hydrostatic_plate under water and self-weight, mid-plane: the same, 300 × 24 graded."""

STATIC_SPEEDS = {
    "udl_beam": 2.0 * math.pi * 30.25,
    "hydrostatic_plate": 2.0 * math.pi * 269.0,
    "cantilever_gravity": 22.6,
}
"""First frequency [rad/s] of the cases whose static answer is taken from a damped run."""

PLATE_B = (
    "end_time=0.0185",
    "output.average_from=0.0065",
    "solid.damping=1700.0",
    'solid.loads=[{ body = "plate", face = "top", traction = [0.0, -19620.0] }]',
)
"""hydrostatic_plate without its water: 2 m of it as a dead load."""


@dataclass(frozen=True)
class Row:
    """`statistic` of `probe` over `between` in a run of `case` with `sets`; `allowed`: largest relative error (absolute
    where the truth is 0). `truth` may be the demand of another row: what that one found. `over`: the row's figure is
    the ratio to what that row found. `breaks`: the run must end by this failure."""

    demand: str
    case: str
    sets: tuple[str, ...]
    probe: str
    statistic: str
    truth: float | str
    allowed: float | None
    between: tuple[float, float] | None = None
    over: str = ""
    breaks: str = ""


def _model(name: str) -> str:
    return f"solid.model={name}"


def _sets(name: str) -> tuple[str, ...]:
    """Settings of a model; ctvf at its best."""
    return (_model(name), "solid.gradient=quadratic") if name == "ctvf" else (_model(name),)


def _ctvf(gradient: str) -> tuple[str, ...]:
    return (_model("ctvf"), f"solid.gradient={gradient}")


ACROSS = ((6, None), (10, 0.015), (15, None), (20, 0.008))
"""Particles across the thickness, and the error allowed model total-lagrangian."""

UPDATED = (
    ("quadratic", 10, 0.04),
    ("quadratic", 20, 0.02),
    ("linear", 10, None),
    ("linear", 20, None),
    ("printed", 10, None),
    ("printed", 20, None),
)
"""Gradients and particles across of model ctvf, and the error allowed."""

CASES = {
    "A": ("udl_beam", (), 0.012, BEAM_2D, 0.0),
    "B": ("hydrostatic_plate", PLATE_B, 0.05, PLATE_2D, 0.34),
}
"""Case, settings, thickness [m], truth by ν, and the case's own ν."""


def _static(letter: str) -> list[Row]:
    case, own, thickness, truth, own_nu = CASES[letter]

    def row(name, sets, nu, allowed):
        wanted = truth[nu] if isinstance(nu, float) else nu
        return Row(f"{letter} static, {name}", case, (*own, *sets), "mid_y", "mean", wanted, allowed)

    rows = []
    for across, allowed in ACROSS:
        rows.append(row(f"{across} across", (f"solid.dx={thickness / across:.6g}",), own_nu, allowed))
    for nu in sorted(set(truth) - {own_nu}):
        rows.append(row(f"10 across, ν {nu}", (f"solid.poisson_ratio={nu}",), nu, 0.015))
    for alpha in (0.3, 3.0):
        base = f"{letter} static, 10 across"
        rows.append(row(f"10 across, viscosity × {alpha:g} against × 1", (f"solid.alpha={alpha}",), base, 0.003))
    for gradient, across, allowed in UPDATED:
        sets = (*_ctvf(gradient), f"solid.dx={thickness / across:.6g}")
        rows.append(row(f"ctvf {gradient}, {across} across", sets, own_nu, allowed))
    for nu in sorted(set(truth) - {own_nu}):
        sets = (*_ctvf("quadratic"), f"solid.poisson_ratio={nu}")
        rows.append(row(f"ctvf quadratic, 10 across, ν {nu}", sets, nu, 0.04))
    return rows


def _timoshenko() -> list[Row]:
    sets = (_model("beam"), "solid.dx=1e-3")
    return [Row("A static, beam (Timoshenko)", "udl_beam", sets, "mid_y", "mean", -5.98704e-5, 0.001)]


def _step_load() -> list[Row]:
    rows = []
    for model, limits in (
        ("total-lagrangian", (0.01, 0.02, 0.02)),
        ("beam", (0.01, 0.02, None)),
        ("ctvf", (None,) * 3),
    ):
        case, sets = "udl_beam_dynamic", _sets(model)
        first, tenth, name = (0.0, 0.033056), (0.2975, 0.3305), f"A step load, first peak, {model}"
        rows += [
            Row(f"A step load, period, {model}", case, sets, "mid_y", "period", 0.0330556, limits[0]),
            Row(name, case, sets, "mid_y", "min", -1.19656e-4, limits[1], first),
            Row(
                f"A step load, tenth peak over first, {model}",
                *(case, sets, "mid_y", "min", 1.19761 / 1.19656, limits[2], tenth),
                over=name,
            ),
        ]
    for model, allowed in (("total-lagrangian", 0.02), ("beam", 0.02), ("ctvf", None)):
        case, sets, first = "plate_step_load", _sets(model), (0.0, 0.12)
        rows += [
            Row(f"plate step load, peak, {model}", case, sets, "tip_x", "max", 0.04146, allowed, first),
            Row(f"plate step load, its time, {model}", case, sets, "tip_x", "t_max", 0.0845, allowed, first),
        ]
    return rows


def _oscillating() -> list[Row]:
    rows, case, first, speed = [], "oscillating_plate", (0.0, 0.13), "solid.bodies[0].velocity_mode.tip_speed_over_c0"
    limits = {"total-lagrangian": (0.015, 0.02), "beam": (0.015, 0.02), "ctvf": (0.04, 0.04)}
    variants = {
        "V_f 0.001": ((f"{speed}=0.001",), 0.25501),
        "ν 0.22": (("solid.poisson_ratio=0.22",), 0.27154),
        "ν 0.47, V_f 0.001": (("solid.poisson_ratio=0.47", f"{speed}=0.001"), 0.24491),
    }
    for model, (period, amplitude) in limits.items():
        sets = (*_sets(model), "end_time=0.6")
        rows += [
            Row(f"oscillating plate, period, {model}", case, sets, "tip_y", "period", 0.2549, period),
            Row(f"oscillating plate, amplitude, {model}", case, sets, "tip_y", "max", 0.1066, amplitude, first),
        ]
        for name, (extra, truth) in variants.items():
            name = f"oscillating plate, period, {name}, {model}"
            rows.append(Row(name, case, (*sets, *extra), "tip_y", "period", truth, period))
    sets = (*_sets("ctvf"), "end_time=0.6")
    nearly = (*_sets("ctvf"), "solid.poisson_ratio=0.47", f"{speed}=0.02", "end_time=0.3")
    limit = (*_sets("ctvf"), "solid.poisson_ratio=0.49", f"{speed}=0.02", "end_time=0.3")
    return [
        *rows,
        Row("oscillating plate, gap, ctvf, ν 0.3975", case, sets, "gap", "max", 1.0, 0.3),
        Row("oscillating plate, gap, ctvf, ν 0.47", case, nearly, "gap", "max", 1.0, 0.3),
        Row("oscillating plate, gap, ctvf, ν 0.49", case, limit, "gap", "max", 1.0, 0.3),
    ]


def _momenta() -> list[Row]:
    rows = []
    for model, allowed in (("total-lagrangian", 1e-12), ("ctvf", 1e-6)):
        for probe in ("stress_xx", "stress_yy", "stress_xy"):
            name = f"a turn of 360°, {probe}, {model}"
            rows.append(Row(name, "prescribed_spin", _sets(model), probe, "change", 0.0, allowed))
    for model, allowed in (("total-lagrangian", 1e-12), ("ctvf", 1e-10)):
        for probe in ("momentum_x", "momentum_y", "angular_momentum", "energy_lost"):
            which, limit = ("final", None) if probe == "energy_lost" else ("change", allowed)
            name = f"free square, {probe}, {model}"
            rows.append(Row(name, "spinning_square", _sets(model), probe, which, 0.0, limit))
    return rows


def _strip() -> list[Row]:
    nearly, without = "solid.poisson_ratio=0.47", "solid.shifting=false"
    rows = []
    for name, gradient, extra, allowed in (
        ("ctvf", "quadratic", (), 0.3),
        ("ctvf, ν 0.47", "quadratic", (nearly,), 0.3),
        ("ctvf linear", "linear", (), 0.3),
        ("ctvf linear, ν 0.47", "linear", (nearly,), 0.3),
        ("ctvf without shifting", "quadratic", (without,), 0.3),
    ):
        sets, name = (*_ctvf(gradient), *extra), f"stretched strip, gap, {name}"
        rows.append(Row(name, "stretched_strip", sets, "gap", "max", 1.0, allowed))
    for extra, name in (((), "with"), ((without,), "without")):
        sets, name = (*_ctvf("printed"), *extra), f"stretched strip, ctvf printed, {name} shifting: breaks"
        rows.append(Row(name, "stretched_strip", sets, "gap", "max", 1.0, None, breaks="fracture"))
    return rows


def _gravity() -> list[Row]:
    limits = {"total-lagrangian": 0.015, "beam": 0.002, "ctvf": 0.04}
    return [
        Row(f"cantilever, {m}", "cantilever_gravity", _sets(m), "tip_y", "mean", -0.029166, limit)
        for m, limit in limits.items()
    ]


def rows() -> list[Row]:
    """All rows of the table that are runs of cases."""
    static = [*_static("A"), *_static("B"), *_timoshenko()]
    return [*static, *_step_load(), *_oscillating(), *_momenta(), *_strip(), *_gravity()]
