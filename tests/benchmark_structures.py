"""Slow benchmark: what the structures' models find against what is true, as a table.

    python -m tests.benchmark_structures                   all rows, about half an hour on two cores
    python -m tests.benchmark_structures --only beam       the rows whose demand, case or settings contain "beam"

Each row is a shipped case with settings, so that `solid-solver run CASE --set …` repeats it. Rows found are kept in
cases/results/structures.csv and shown in structures.md beside it; a row run again replaces its older self.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from shared.commands import default_threads
from shared.contract import ShearwaterError
from shared.probes import read_probes
from shared.scene import load_scene
from shared.solo import run_alone
from shared.statistics import relative_error, statistic
from solid_solver.models import make_model

RESULTS = Path(__file__).resolve().parent.parent / "cases" / "results"
COLUMNS = ("demand", "case", "settings", "truth", "found", "error", "allowed", "kept", "particles", "rate", "seconds")

STATIC = ("end_time=0.2",)  # three periods to average over, after 3 ζ-decades
BEAM_2D = {0.0: -5.98618e-5, 0.22: -5.7361e-5, 0.34: -5.3465e-5, 0.47: -4.7115e-5}
"""Mid deflection [m] of udl_beam by ν: quadratic finite elements, 128 × 12 graded; last change 1e-5 to 6e-4."""

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
    for across, allowed in ((6, None), (10, 0.015), (20, 0.008)):
        sets = (*PLATE_B, f"solid.dx={0.05 / across:.6g}")
        rows.append(Row(f"B static, {across} across", "hydrostatic_plate", sets, "mid_y", "mean", -7.0668e-5, allowed))
    for gradient, across, allowed in (
        ("quadratic", 10, 0.04),
        ("quadratic", 20, 0.02),
        ("linear", 10, None),
        ("printed", 10, None),
    ):
        sets = (_model("ctvf"), f"solid.gradient={gradient}", f"solid.dx={0.012 / across:.6g}")
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
    return [*rows, Row("oscillating plate, gap, ctvf, ν 0.47", case, sets, "gap", "max", 1.0, 0.3)]


def _momenta() -> list[Row]:
    rows = []
    for model, allowed in (("total-lagrangian", 1e-12), ("ctvf", 1e-6)):
        for probe in ("stress_xx", "stress_yy", "stress_xy"):
            sets = (_model(model),)
            rows.append(
                Row(f"a turn of 360°, {probe}, {model}", "prescribed_spin", sets, probe, "change", 0.0, allowed)
            )
    for model, allowed in (("total-lagrangian", 1e-12), ("ctvf", None)):
        for probe in ("momentum_x", "angular_momentum", "energy_lost"):
            which, limit = ("final", None) if probe == "energy_lost" else ("change", allowed)
            name = f"free square, {probe}, {model}"
            rows.append(Row(name, "spinning_square", _sets(model), probe, which, 0.0, limit))
    for name, sets in {"ctvf": (), "ctvf, ν 0.47": ("solid.poisson_ratio=0.47",)}.items():
        sets = (*_sets("ctvf"), *sets)
        rows.append(Row(f"stretched strip, gap, {name}", "stretched_strip", sets, "gap", "max", 1.0, 0.3))
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
        ("total-lagrangian", 3.46e-4, 4e-3),
    ):
        sets = (
            _model(model),
            f"solid.dx={dx:g}",
            f"end_time={end:g}",
            "output.average_from=0",
            "output.probe_interval=5e-4",
        )
        rows.append(Row(f"speed, {model}", "udl_beam", sets, "mid_y", "final", 0.0, None))
    return rows


def rows() -> list[Row]:
    """All rows of the table."""
    return [*_static(), *_step_load(), *_oscillating(), *_momenta(), *_gravity(), *_speed()]


def run_row(row: Row, done: dict, threads: int) -> dict[str, str]:
    """The table's cells for one row; `done` keeps the runs that rows share."""
    key = row.case, row.sets
    if key not in done:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "run"
            record = run_alone(load_scene(row.case, row.sets), row.case, "solid", make_model, out, threads, quiet=True)
            done[key] = record.result, read_probes(out / "probes.csv")
    result, (time, probes) = done[key]
    between = row.between
    if between is None and row.statistic == "mean":
        between = (load_scene(row.case, row.sets).output.average_from, float(time[-1]))
    found = statistic(row.statistic, time, probes[row.probe], between)
    error = relative_error(found, row.truth)
    cost = result["cost"]["solid"]
    kept = "" if row.allowed is None else ("yes" if abs(error) <= row.allowed else "no")
    cells = (
        *(row.demand, row.case, " ".join(f"--set {s!r}" if " " in s else f"--set {s}" for s in row.sets)),
        *(f"{row.truth:.6g}", f"{found:.6g}", f"{error:.3g}" if row.truth == 0.0 else f"{100.0 * error:+.2f} %"),
        *("" if row.allowed is None else f"{row.allowed:g}", kept, str(cost["particles"])),
        *(f"{cost['particle_steps_per_s'] / 1e6:.2f}", f"{result['cost']['wall_s']:.1f}"),
    )
    return dict(zip(COLUMNS, cells, strict=True))


def _write(table: dict[str, dict[str, str]]) -> None:
    """The CSV file, and the same as Markdown, rows in the order of `rows()`."""
    ordered = [table[row.demand] for row in rows() if row.demand in table]
    with (RESULTS / "structures.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(ordered)
    head = (
        f"# Structures against what is true\n\nMade by `python -m tests.benchmark_structures`, last on {date.today()}. "
        "Each row: `solid-solver run CASE SETTINGS`. Errors are relative; absolute where the truth is 0. Rate: million "
        "particle-steps per second of stepping, beside whatever else the machine did.\n\n"
    )
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(row[c].replace("|", "\\|") for c in COLUMNS) + " |" for row in ordered]
    (RESULTS / "structures.md").write_text(head + "\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="run the rows that contain this text")
    parser.add_argument("--threads", type=int, default=default_threads())
    options = parser.parse_args()
    RESULTS.mkdir(exist_ok=True)
    table, done = {}, {}
    if (RESULTS / "structures.csv").is_file():
        with (RESULTS / "structures.csv").open(newline="", encoding="utf-8") as file:
            table = {row["demand"]: row for row in csv.DictReader(file)}
    for row in rows():
        if options.only not in " ".join((row.demand, row.case, *row.sets)):
            continue
        try:
            table[row.demand] = run_row(row, done, options.threads)
        except ShearwaterError as error:
            blank = dict.fromkeys(COLUMNS, "")
            table[row.demand] = blank | {"demand": row.demand, "case": row.case, "kept": "no", "found": str(error)[:80]}
        shown = table[row.demand]
        print(
            f"{shown['demand']}: {shown['found']} ({shown['error']}) {shown['kept']} {shown['seconds']} s", flush=True
        )
        _write(table)


if __name__ == "__main__":
    main()
