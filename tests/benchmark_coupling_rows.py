"""The rows of the coupled benchmark: demand, case, settings, truth, and the error allowed."""

from __future__ import annotations

from dataclasses import dataclass

from tests.benchmark_structures_rows import PLATE_2D

PEAK = 0.0459
"""First tip peak [m] of dam_break_plate: mean of eight codes, which lie between 41 and 49.1 mm."""
TIMOSHENKO = -7.1099e-5
"""Mid deflection [m] of hydrostatic_plate as Timoshenko's beam: q L⁴/(384 D) + q L²/(8 κ G t), q 20944 N/m², κ 5/6."""
ALONE = 0.016924
"""Tip [m] of cantilever_in_water under (ρ_s − ρ_f) g: `solid-solver run cantilever_in_water --set solid.density=500
--set solid.damping=5`, a geometrically exact beam; linear theory 0.0169."""


@dataclass(frozen=True)
class Row:
    """`statistic` of `probe` in a run of `case` with `sets`; `allowed`: largest relative error.

    `statistic`: one of shared/statistics.py; "envelope": distance [m] from the published curves; "iterations": the most
    of any window; "windows": how many the run took; "overhead": fraction of the wall time outside the two sides.
    `truth` may be the demand of another row: what that one found; None where `at_most`
    judges, or nothing. `printed`: what the method's authors print. `breaks`: the run must end by this failure.
    `cost`: core-seconds, roughly; the cheapest run first.
    """

    demand: str
    case: str
    sets: tuple[str, ...]
    probe: str
    statistic: str
    truth: float | str | None
    allowed: float | None = None
    between: tuple[float, float] | None = None
    at_most: float | None = None
    printed: float | None = None
    breaks: str = ""
    cost: float = 10.0


def spacing(fluid: str, solid: str = "") -> tuple[str, str]:
    """Settings of both sides' spacings [m]."""
    return f"fluid.dx={fluid}", f"solid.dx={solid or fluid}"


def models(fluid: str, solid: str) -> tuple[str, ...]:
    """Settings of both sides' models."""
    return f"fluid.model={fluid}", f"solid.model={solid}"


def _gate() -> list[Row]:
    case, explicit = "light_gate", ("coupling.scheme=serial-explicit",)
    aitken = ("coupling.acceleration=aitken", "coupling.max_iterations=100")
    return [
        Row("gate, explicit stopped", case, explicit, "", "windows", None, at_most=50, breaks="ledger"),
        Row("gate, IQN-ILS, most iterations", case, (), "", "iterations", None, at_most=6, cost=20),
        Row("gate, IQN-ILS, pressure", case, (), "pressure", "mean", 158.8, cost=20),
        Row("gate, Aitken, most iterations", case, aitken, "", "iterations", None, cost=30),
    ]


def _buoyancy() -> list[Row]:
    case, light = "cantilever_in_water", ("solid.density=500", "solid.damping=60")
    return [
        Row("buoyancy, ρ_s 1500", case, (), "tip_y", "mean", -ALONE, 0.03, cost=120),
        Row("buoyancy, ρ_s 500", case, light, "tip_y", "mean", ALONE, 0.03, cost=120),
    ]


def _b() -> list[Row]:
    case = "hydrostatic_plate"
    peaks = (("first", -1.1670e-4, (0.0, 0.0035)), ("second", -9.088e-5, (0.0045, 0.0068)))
    peaks = (*peaks, ("third", -7.894e-5, (0.008, 0.0102)))  # 1.6514, 1.286 and 1.117 of the static value
    pressures = ("coupling.loads=pressure",)
    rows = [
        Row("B static, 10 across", case, (), "mid_y", "mean", PLATE_2D[0.34], 0.015, printed=-6.85e-5, cost=120),
        Row("B bottom pressure, 10 across", case, (), "bottom_pressure", "mean", 19620.0, 0.02, cost=120),
        *(Row(f"B {n} peak, 10 across", case, (), "mid_y", "min", y, 0.05, t, cost=120) for n, y, t in peaks),
        Row("B static, beam", case, ("solid.model=beam",), "mid_y", "mean", TIMOSHENKO, 0.005, cost=130),
        Row("B pressures for forces", case, pressures, "mid_y", "mean", "B static, 10 across", 0.02, cost=130),
        Row("B static, ctvf", case, ("solid.model=ctvf",), "mid_y", "mean", PLATE_2D[0.34], 0.04, cost=150),
    ]
    fine = spacing("2.5e-3")
    return [*rows, Row("B static, 20 across", case, fine, "mid_y", "mean", PLATE_2D[0.34], 0.008, cost=1000)]


def _c() -> list[Row]:
    case, rows = "dam_break_plate", []
    for dx, cost in (("4e-3", 15), ("2e-3", 60), ("1e-3", 300)):
        sets = spacing(dx)
        rows += [
            Row(f"C peak, dx {dx}", case, sets, "tip_x", "max", PEAK, cost=cost),
            Row(f"C its time, dx {dx}", case, sets, "tip_x", "t_max", 0.238, cost=cost),
            Row(f"C beyond the envelope, dx {dx}", case, sets, "tip_x", "envelope", None, at_most=2e-3, cost=cost),
        ]
    rows.append(Row("C converging", case, spacing("1e-3"), "tip_x", "max", "C peak, dx 2e-3", 0.04, cost=300))
    rows.append(Row("C overhead", case, spacing("1e-3"), "", "overhead", None, at_most=0.03, cost=300))
    to_peak = ("end_time=0.3",)
    for solid in ("total-lagrangian", "beam", "ctvf"):
        sets, first = (*to_peak, *models("wcsph", solid)), solid == "total-lagrangian"
        truth, allowed = (PEAK, None) if first else ("C peak, total-lagrangian", 0.05)
        rows.append(Row(f"C peak, {solid}", case, sets, "tip_x", "max", truth, allowed, cost=30))
    coarse = "C peak, fluid 4e-3, solid 4e-3"
    rows += [
        Row(coarse, case, (*to_peak, *spacing("4e-3")), "tip_x", "max", PEAK, cost=8),
        Row("C peak, fluid 4e-3, solid 2e-3", case, (*to_peak, *spacing("4e-3", "2e-3")), "tip_x", "max", coarse, 0.03),
        Row("C to 1.0 s", case, ("end_time=1.0",), "tip_x", "max", PEAK, cost=90),
    ]
    return rows


def _windows() -> list[Row]:
    """C with windows of two fluid steps, and of one, as automatic ones are."""
    case, sets = "dam_break_plate", ("end_time=0.3", *spacing("1e-3"))
    several, one = "C peak, window of two steps", (*sets, "coupling.window=4.28e-5")
    two = (*sets, "coupling.window=8.56e-5", "coupling.scheme=serial-explicit")
    return [
        Row(several, case, two, "tip_x", "max", PEAK, cost=130),
        Row("C peak, window of one step", case, one, "tip_x", "max", several, 0.01, cost=130),
    ]


def _paper() -> list[Row]:
    """The method's authors' own system: ctvf on both sides."""
    both, rows = models("ctvf", "ctvf"), []
    for across, dx, cost in ((10, "5e-3", 150), (15, "3.333e-3", 500), (20, "2.5e-3", 1200)):
        name = f"paper's B, {across} across"
        sets = (*both, *spacing(dx))
        rows.append(Row(name, "hydrostatic_plate", sets, "mid_y", "mean", PLATE_2D[0.34], printed=-6.85e-5, cost=cost))
    for dx, cost in (("2e-3", 80), ("1e-3", 600), ("5e-4", 4900)):
        sets = both if dx == "2e-3" else (*both, *spacing(dx))
        rows.append(Row(f"paper's C, dx {dx}", "dam_break_plate", sets, "tip_x", "max", PEAK, cost=cost))
    return rows


def rows() -> list[Row]:
    """All rows of the table, the cheapest runs first."""
    return sorted([*_gate(), *_buoyancy(), *_b(), *_c(), *_windows(), *_paper()], key=lambda row: row.cost)
