"""Slow benchmark: what the structures' models find against what is true, as a table.

    python -m tests.benchmark_structures                   all rows, about half an hour on two cores
    python -m tests.benchmark_structures --only beam       the rows whose demand, case or settings contain "beam"

Each row is a shipped case with settings, so that `solid-solver run CASE --set …` repeats it. Rows found are kept in
cases/results/structures.csv and shown in structures.md beside it; a row run again replaces its older self.
"""

from __future__ import annotations

import argparse
import csv
import math
import tempfile
from datetime import date
from pathlib import Path

import numpy as np

from shared.commands import default_threads
from shared.contract import ShearwaterError
from shared.probes import read_probes
from shared.scene import load_scene
from shared.solo import run_alone
from shared.statistics import relative_error, statistic
from solid_solver.models import make_model
from tests.benchmark_structures_rows import STATIC_SPEEDS, Row, rows

RESULTS = Path(__file__).resolve().parent.parent / "cases" / "results"
COLUMNS = (
    "demand",
    "case",
    "settings",
    "truth",
    "found",
    "error",
    "allowed",
    "kept",
    "static",
    "particles",
    "rate",
    "seconds",
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
    static = _static_run(row, time, probes[row.probe], result) if row.statistic == "mean" else ""
    if between is None and row.statistic == "mean":
        between = (load_scene(row.case, row.sets).output.average_from, float(time[-1]))
    found = statistic(row.statistic, time, probes[row.probe], between)
    error = relative_error(found, row.truth)
    cost = result["cost"]["solid"]
    kept = "" if row.allowed is None else ("yes" if abs(error) <= row.allowed else "no")
    cells = (
        *(row.demand, row.case, " ".join(f"--set {s!r}" if " " in s else f"--set {s}" for s in row.sets)),
        *(f"{row.truth:.6g}", f"{found:.6g}", f"{error:.3g}" if row.truth == 0.0 else f"{100.0 * error:+.2f} %"),
        *("" if row.allowed is None else f"{row.allowed:g}", kept, static, str(cost["particles"])),
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
        "Each row: `solid-solver run CASE SETTINGS`. Errors are relative; absolute where the truth is 0. Static: "
        "damping ratio, periods of the first mode averaged over, change of the mean between their halves. Rate: "
        "million particle-steps per second of stepping, beside whatever else the machine did.\n\n"
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
            table = {row["demand"]: dict.fromkeys(COLUMNS, "") | row for row in csv.DictReader(file)}
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
