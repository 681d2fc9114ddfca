"""The rows of the coupled benchmark: demand, case, settings, truth, and the error allowed."""

from __future__ import annotations

from dataclasses import dataclass

from tests.benchmark_structures_rows import PLATE_2D

PEAK = 0.0459
"""First tip peak [m] of dam_break_plate: mean of eight codes, which lie between 41 and 49.1 mm."""
STATIC_A = -5.98618e-5
"""Mid deflection [m] of udl_beam by 2-D elasticity."""
TIMOSHENKO = -7.1099e-5
"""Mid deflection [m] of hydrostatic_plate as Timoshenko's beam: q L⁴/(384 D) + q L²/(8 κ G t), q 20944 N/m², κ 5/6."""
ALONE = 0.016924
"""Tip [m] of cantilever_in_water under (ρ_s − ρ_f) g: `solid-solver run cantilever_in_water --set solid.density=500
--set solid.damping=5`, a geometrically exact beam; linear theory 0.0169."""


@dataclass(frozen=True)
class Row:
    """`statistic` of `probe` in a run of `case` with `sets`; `allowed`: largest relative error.

    `statistic`: one of shared/run/statistics.py; "envelope": distance [m] from the published curves; "iterations": the
    most of any window; "windows": how many the run took; "overhead": fraction of the wall time outside the two sides.
    `truth` may be the demand of another row: what that one found; None where `most`
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
    most: float | None = None
    least: float | None = None
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
        Row("gate, explicit stopped", case, explicit, "", "windows", None, most=50, breaks="ledger"),
        Row("gate, IQN-ILS, most iterations", case, (), "", "iterations", None, most=6, cost=20),
        Row("gate, IQN-ILS, pressure", case, (), "pressure", "mean", 158.8, cost=20),
        Row("gate, Aitken, most iterations", case, aitken, "", "iterations", None, cost=30),
    ]


def _buoyancy() -> list[Row]:
    case, light = "cantilever_in_water", ("solid.density=500",)
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
            Row(f"C beyond the envelope, dx {dx}", case, sets, "tip_x", "envelope", None, most=2e-3, cost=cost),
        ]
    rows.append(Row("C converging", case, spacing("1e-3"), "tip_x", "max", "C peak, dx 2e-3", 0.04, cost=300))
    rows.append(Row("C overhead", case, spacing("1e-3"), "", "overhead", None, most=0.03, cost=300))
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


TANK = 'walls=[{ name = "tank", polyline = [[0, 0.9], [0, 0], [0.584, 0], [0.584, 0.9]] }]'
"""dam_break_plate's tank with walls 0.9 m high, for the number of particles of the method's authors."""
FINEST = (*spacing("5e-4"), TANK)
OF_THE_PAPER = ("paper's A, 20 across", "paper's B, 20 across", "paper's C, dx 5e-4")
"""The rows whose pictures are kept."""


def _paper() -> list[Row]:
    """The method's authors' own system, ctvf on both sides, and the smallest models that do as well."""
    both, rows = models("ctvf", "ctvf"), []
    for across, dx, cost in ((10, "1.2e-3", 20), (15, "8e-4", 60), (20, "6e-4", 150)):
        sets = ("solid.model=ctvf", f"solid.dx={dx}")
        name = f"paper's A, {across} across"
        rows.append(Row(name, "udl_beam", sets, "mid_y", "mean", STATIC_A, printed=-5.787e-5, cost=cost))
    sets = ("solid.model=beam",)
    rows.append(Row("smallest for A: beam", "udl_beam", sets, "mid_y", "mean", STATIC_A, printed=-5.787e-5, cost=1))
    for across, dx, cost in ((10, "5e-3", 150), (15, "3.333e-3", 500), (20, "2.5e-3", 1200)):
        name, sets = f"paper's B, {across} across", (*both, *spacing(dx))
        rows.append(Row(name, "hydrostatic_plate", sets, "mid_y", "mean", PLATE_2D[0.34], printed=-6.85e-5, cost=cost))
    lagged = ("solid.damping=2400", "coupling.scheme=serial-explicit", "coupling.window=0.01")  # as pre-flight names it
    name, sets = "smallest for B: still water on a beam", (*models("still", "beam"), *lagged)
    rows.append(Row(name, "hydrostatic_plate", sets, "mid_y", "mean", PLATE_2D[0.34], printed=-6.85e-5, cost=1))
    for dx, cost in (("2e-3", 80), ("1e-3", 600)):
        sets = both if dx == "2e-3" else (*both, *spacing(dx))
        rows.append(Row(f"paper's C, dx {dx}", "dam_break_plate", sets, "tip_x", "max", PEAK, cost=cost))
    finest = (*both, *FINEST)
    rows.append(Row("paper's C, dx 5e-4", "dam_break_plate", finest, "tip_x", "max", PEAK, cost=3000))
    name, sets = "smallest for C, dx 5e-4: wcsph and total-lagrangian", FINEST
    rows.append(Row(name, "dam_break_plate", sets, "tip_x", "max", PEAK, cost=1200))
    name = "smallest for C: wcsph and beam, dx 2e-3"
    rows.append(Row(name, "dam_break_plate", models("wcsph", "beam"), "tip_x", "max", PEAK, cost=60))
    return rows


def rows() -> list[Row]:
    """All rows of the table, the cheapest runs first."""
    return sorted([*_gate(), *_buoyancy(), *_b(), *_c(), *_windows(), *_paper()], key=lambda row: row.cost)
