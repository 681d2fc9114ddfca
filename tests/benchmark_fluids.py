"""Slow benchmark: what the fluid's models find against what is true, and what they cost, as a table.

    python -m tests.benchmark_fluids                   all rows, about an hour on one core
    python -m tests.benchmark_fluids --only dam_break  the rows whose demand, case or settings contain "dam_break"
    python -m tests.benchmark_fluids --missing         the rows that the table lacks

Most rows are shipped cases with settings, so that `fluid-solver run CASE --set …` repeats them; finished runs are kept
in the folder of --runs and taken from there: delete it after a change of the solver. Rows found are kept in
cases/results/fluids.csv and shown in fluids.md beside it; a row found again replaces its older self.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
from datetime import date
from functools import cache
from pathlib import Path

from fluid_solver.machine import copy_rate, multiply_add_rate
from fluid_solver.models import make_model
from shared.contract import BadInput, ShearwaterError
from shared.run.statistics import relative_error
from shared.scene.reading import load_scene
from shared.solo import run_alone
from tests.benchmark_fluids_costs import measures
from tests.benchmark_fluids_measures import Found
from tests.benchmark_fluids_models import draw, model_rows
from tests.benchmark_fluids_rows import Job, Row, rows
from tests.benchmark_table import bounded, bounds, read_table, run_measure, verdict, write_table

COLUMNS = (
    *("demand", "case", "settings", "truth", "found", "error", "allowed", "verdict"),
    *("particles", "rate", "seconds"),
)


def found_of(job: Job, folder: Path, threads: int) -> Found:
    """The finished run of a case with settings, run now unless `folder` holds it."""
    case, sets = job
    scene = load_scene(case, sets)
    at = folder / f"{case}_{hashlib.sha256(repr(sets).encode()).hexdigest()[:12]}"
    if not _finished(at):
        shutil.rmtree(at, ignore_errors=True)
        run_alone(scene, case, "fluid", make_model, at, threads, quiet=True)
    return Found.of(scene, at)


def _finished(run: Path) -> bool:
    result = run / "result.json"
    return result.is_file() and json.loads(result.read_text(encoding="utf-8"))["status"] == "finished"


def run_row(row: Row, folder: Path, threads: int) -> dict[str, str]:
    """The table's cells of a row."""
    case, sets = row.jobs[-1]
    cells = {"demand": row.demand, "case": case, "settings": " ".join(f"--set {one}" for one in sets)}
    cells["allowed"] = _allowed(row)
    try:
        runs = [found_of(job, folder, threads) for job in row.jobs]
    except BadInput as refused:
        return cells | {"found": f"refused: {str(refused)[:60]} …", "verdict": verdict(True)}
    except ShearwaterError as failed:
        return cells | {"found": f"failed: {str(failed)[:60]} …", "verdict": verdict(False)}
    figure = row.measure(*runs)
    spent = runs[-1].result["cost"]["fluid"]
    cells |= {
        "found": f"{figure:.5g} {row.unit}".strip(),
        "particles": str(spent["particles"]),
        "rate": f"{spent['particle_steps_per_s'] / 1e6:.2f}",
        "seconds": f"{spent['stepping_core_s']:.0f}",
    }
    if row.truth is not None:
        error = relative_error(figure, row.truth)
        cells |= {"truth": f"{row.truth:.6g}", "error": f"{100 * error:+.2f} %" if row.truth else f"{error:.3g}"}
        return cells | {"verdict": verdict(None if row.allowed is None else abs(error) <= row.allowed)}
    return cells | {"verdict": bounded(figure, row)}


def _allowed(row: Row) -> str:
    return bounds(row) or ("" if row.allowed is None else f"± {row.allowed:g}")


@cache
def _machine() -> str:
    return f"One core: {multiply_add_rate() / 1e9:.0f} GFLOP/s multiply-add, {copy_rate() / 1e9:.0f} GB/s copy."


def _write(table: dict[str, dict[str, str]]) -> None:
    ordered = [table[row.demand] for row in (*rows(), *model_rows(), *measures()) if row.demand in table]
    head = (
        f"# The fluid against what is true\n\nMade by `python -m tests.benchmark_fluids`, last on {date.today()}. Each "
        "row: `fluid-solver run CASE SETTINGS` (the finest of its runs), or the command shown. Errors are relative; "
        "absolute where the truth is 0. Rate: million particle-steps per second, seconds: core-seconds of stepping of "
        f"the finest run on one thread, beside whatever else the machine did. {_machine()}"
    )
    write_table("fluids", COLUMNS, ordered, head)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="find the rows that contain this text")
    parser.add_argument("--missing", action="store_true", help="find the rows that the table lacks")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--runs", type=Path, default=Path("runs/benchmark_fluids"), help="folder of finished runs")
    options = parser.parse_args()
    table = read_table("fluids", COLUMNS)
    for row in (*rows(), *model_rows(), *measures()):
        text = " ".join((row.demand, *(f"{case} {' '.join(sets)}" for case, sets in getattr(row, "jobs", ()))))
        if options.only not in text or (options.missing and row.demand in table):
            continue
        cells = run_row(row, options.runs, options.threads) if isinstance(row, Row) else run_measure(row)
        table[row.demand] = dict.fromkeys(COLUMNS, "") | cells
        print(f"{row.demand}: {cells['found']} ({cells.get('error', '')}) {cells['verdict']}", flush=True)
        _write(table)
    draw(lambda job: found_of(job, options.runs, options.threads), bool(options.only))


if __name__ == "__main__":
    main()
