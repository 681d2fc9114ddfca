"""Slow benchmark: what the structures' models find against what is true, as a table.

    python -m tests.benchmark_structures                   all rows, about half an hour on one core
    python -m tests.benchmark_structures --only beam       the rows whose demand, case or settings contain "beam"
    python -m tests.benchmark_structures --missing         the rows that the table lacks

Most rows are a shipped case with settings, so that `solid-solver run CASE --set …` repeats them. Rows found are kept in
cases/results/structures.csv and shown in structures.md beside it; a row run again replaces its older self.
"""

from __future__ import annotations

import argparse
import itertools
import math
import tempfile
from datetime import date
from pathlib import Path

import numpy as np

from shared.commands import default_threads
from shared.contract import ShearwaterError
from shared.elasticity import wave_speed
from shared.geometry.regions import own_size
from shared.run.probes import read_probes
from shared.run.statistics import relative_error, statistic
from shared.scene.reading import load_scene
from shared.solo import run_alone
from solid_solver.models import make_model
from tests.benchmark_structures_measures import measures
from tests.benchmark_structures_rows import ACROSS, STATIC_SPEEDS, Row, rows
from tests.benchmark_table import Measure, read_table, run_measure, verdict, write_table

COLUMNS = (
    *("demand", "case", "settings", "truth", "found", "error", "allowed", "verdict"),
    *("static", "particles", "core seconds"),
)


def _static_run(row: Row, time: np.ndarray, values: np.ndarray, result: dict) -> str:
    """Damping ratio, periods averaged over, and drift between the halves of the mean of a damped run."""
    omega = STATIC_SPEEDS.get(row.case)
    if omega is None:
        return ""
    scene = load_scene(row.case, row.sets)
    omega *= math.sqrt(scene.solid.youngs_modulus / load_scene(row.case).solid.youngs_modulus)
    begin, end = scene.output.average_from, float(time[-1])
    middle = 0.5 * (begin + end)
    halves = statistic("mean", time, values, (begin, middle)), statistic("mean", time, values, (middle, end))
    drift = abs(halves[1] / halves[0] - 1.0)
    periods = (end - begin) * omega / (2.0 * math.pi)
    return f"ζ {scene.solid.damping / (2.0 * omega):.2f}, {periods:.1f} periods, drift {100.0 * drift:.2g} %"


def _settings(row: Row) -> str:
    return " ".join(f"--set {s!r}" if " " in s else f"--set {s}" for s in row.sets)


def _run(row: Row, done: dict, threads: int) -> tuple:
    """Result and probes of the row's run; `done` keeps the runs that rows share."""
    key = row.case, row.sets
    if key not in done:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "run"
            record = run_alone(load_scene(row.case, row.sets), row.case, "solid", make_model, out, threads, quiet=True)
            done[key] = record.result, read_probes(out / "probes.csv")
    return done[key]


def run_row(row: Row, done: dict, table: dict, threads: int) -> dict[str, str]:
    """The table's cells for one run of a case; `table`: rows found before."""
    cells = {"demand": row.demand, "case": row.case, "settings": _settings(row)}
    try:
        result, (time, probes) = _run(row, done, threads)
    except ShearwaterError as error:
        expected = bool(row.breaks) and row.breaks in str(error)
        return cells | {"found": str(error).split(". ")[0][:120], "verdict": verdict(expected)}
    if row.breaks:
        return cells | {"found": "it ran to its end", "verdict": verdict(False)}
    between = row.between
    if between is None and row.statistic == "mean":
        between = (load_scene(row.case, row.sets).output.average_from, float(time[-1]))
        cells["static"] = _static_run(row, time, probes[row.probe], result)
    found = statistic(row.statistic, time, probes[row.probe], between)
    if row.over:
        found /= float(table[row.over]["found"])
    truth = float(table[row.truth]["found"]) if isinstance(row.truth, str) else row.truth
    error = relative_error(found, truth)
    cost = result["cost"]["solid"]
    return cells | {
        "truth": f"{truth:.6g}",
        "found": f"{found:.6g}",
        "error": f"{error:.3g}" if truth == 0.0 else f"{100.0 * error:+.3f} %",
        "allowed": "" if row.allowed is None else f"{row.allowed:g}",
        "verdict": verdict(None if row.allowed is None else abs(error) <= row.allowed),
        "particles": str(cost["particles"]),
        "core seconds": f"{cost['stepping_core_s']:.1f}",
    }


def falls(table: dict, letter: str) -> dict[str, str] | None:
    """Whether the error of total-lagrangian falls from each spacing of ACROSS to the next."""
    rows_of = [table.get(f"{letter} static, {across} across") for across, _ in ACROSS]
    if not all(rows_of):
        return None
    errors = [abs(float(row["error"].rstrip(" %"))) for row in rows_of]
    kept = all(b < a for a, b in itertools.pairwise(errors))
    found = ", ".join(f"{e:.2f}" for e in errors) + " %"
    return {
        "demand": f"{letter} static, error falls at 6, 10, 15, 20 across",
        "found": found,
        "verdict": verdict(kept),
    }


def work(row: Row | Measure) -> float:
    """Steps times particles of a row, roughly: the cheap ones run first."""
    if isinstance(row, Measure):
        return 0.0
    scene = load_scene(row.case, row.sets)
    solid = scene.solid
    area = sum(float(np.prod(own_size(body))) for body in solid.bodies)
    if solid.model == "beam":
        return 0.0
    weight = {"printed": 3.0, "linear": 4.0, "quadratic": 10.0}[solid.gradient] if solid.model == "ctvf" else 1.0
    return weight * scene.end_time * wave_speed(solid) / solid.dx * area / solid.dx**2


def _write(table: dict[str, dict[str, str]]) -> None:
    """The rows found, in the order of `rows()` and `measures()`, with those drawn from others."""
    wanted = [row.demand for row in (*rows(), *measures())]
    drawn = [row for row in (falls(table, letter) for letter in "AB") if row]
    lacking = [demand for demand in wanted if demand not in table]
    head = (
        f"# Structures against what is true\n\nMade by `python -m tests.benchmark_structures`, last on {date.today()}. "
        "Each row: `solid-solver run CASE SETTINGS`, or the command shown. Errors are relative; absolute where the "
        "truth is 0. Static: damping ratio, periods of the first mode averaged over, change of the mean between their "
        f"halves. Core seconds: of stepping.\n\nNot measured yet (`--missing` does): {'; '.join(lacking) or 'nothing'}."
    )
    write_table("structures", COLUMNS, [*drawn, *(table[demand] for demand in wanted if demand in table)], head)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="run the rows that contain this text")
    parser.add_argument("--missing", action="store_true", help="run the rows that the table lacks")
    parser.add_argument("--threads", type=int, default=default_threads())
    options = parser.parse_args()
    table, done = read_table("structures", COLUMNS), {}
    wanted = [row for row in (*rows(), *measures()) if not (options.missing and row.demand in table)]
    wanted = [row for row in wanted if options.only in " ".join(map(str, vars(row).values()))]
    _write(table)
    for row in sorted(wanted, key=work):
        cells = run_row(row, done, table, options.threads) if isinstance(row, Row) else run_measure(row)
        shown = dict.fromkeys(COLUMNS, "") | cells
        table[row.demand] = shown
        print(f"{row.demand}: {shown['found']} ({shown['error']}) {shown['verdict']}", flush=True)
        _write(table)


if __name__ == "__main__":
    main()
