"""Slow benchmark: what coupled runs find against what is true, as a table.

    python -m tests.benchmark_coupling                   all rows, the cheapest first: hours on two cores
    python -m tests.benchmark_coupling --only buoyancy   the rows whose demand, case or settings contain "buoyancy"
    python -m tests.benchmark_coupling --missing         the rows that the table lacks
    python -m tests.benchmark_coupling --most 100        the rows of about 100 core-seconds or less

Each row is a shipped case with settings, so that `coupler run CASE --set …` repeats it. Run directories stay in
`--runs`, and finished ones are not run again. Rows found are kept in cases/results/coupled.csv and shown in coupled.md
beside it; a row found again replaces its older self. The method's authors' own three cases, and the smallest models
that do as well, are shown once more in paper.md, with pictures.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shlex
import shutil
from datetime import date
from pathlib import Path

import numpy as np

from coupler.run import run_coupled
from fluid_solver.models import make_model as make_fluid
from shared.contract import ShearwaterError
from shared.run.probes import read_probes
from shared.run.statistics import relative_error, statistic
from shared.scene.reading import load_scene
from shared.solo import run_alone
from solid_solver.models import make_model as make_solid
from tests.benchmark_coupling_rows import OF_THE_PAPER, Row, rows
from tests.benchmark_table import MISSED, RESULTS, bounds, read_table, verdict, write_table

COLUMNS = (
    "demand",
    "case",
    "settings",
    "truth",
    "found",
    "error",
    "allowed",
    "verdict",
    "printed",
    "from printed",
    "particles",
    "windows",
    "core seconds",
    "seconds",
)
ENVELOPE = np.array(
    [
        (0.15, -0.0001, 0.0078),
        (0.2, 0.0358, 0.0442),
        (0.25, 0.0402, 0.0483),
        (0.3, 0.0289, 0.0427),
        (0.35, 0.021, 0.0326),
        (0.4, 0.0156, 0.0252),
    ]
)
"""dam_break_plate: time [s], lowest and highest tip displacement [m] of six published curves."""
SHIFTS = np.linspace(-0.01, 0.01, 41)
"""Shifts in time [s] that the codes' own beginnings leave open."""


def beyond_envelope(time: np.ndarray, tip: np.ndarray) -> tuple[float, float]:
    """Largest distance [m] from the envelope before 0.45 s after the best shift, and that shift [s]."""

    def distance(shift: float) -> float:
        moved = np.interp(ENVELOPE[:, 0] - shift, time, tip)
        return float(np.maximum(ENVELOPE[:, 1] - moved, moved - ENVELOPE[:, 2]).max().clip(0.0))

    shift = min(SHIFTS, key=lambda s: (distance(s), abs(s)))
    return distance(shift), float(shift)


def directory_of(row: Row, runs: Path) -> Path:
    """Where the row's run lies; rows of the same run share it."""
    return runs / f"{row.case}-{hashlib.sha256(' '.join(row.sets).encode()).hexdigest()[:8]}"


def result_of(row: Row, runs: Path, threads: dict[str, int]) -> dict:
    """The row's result.json, from a run that has ended already or from one made now."""
    folder = directory_of(row, runs)
    found = folder / "result.json"
    if found.is_file():
        result = json.loads(found.read_text(encoding="utf-8"))
        if result["status"] in ("finished", "failed"):
            return result
    shutil.rmtree(folder, ignore_errors=True)
    scene = load_scene(row.case, row.sets)
    try:
        if scene.fluid is None:
            run_alone(scene, row.case, "solid", make_solid, folder, threads["solid"], quiet=True)
        elif scene.solid is None:
            run_alone(scene, row.case, "fluid", make_fluid, folder, threads["fluid"], quiet=True)
        else:
            run_coupled(scene, row.case, folder, threads, quiet=True)
    except ShearwaterError as error:
        print(f"{row.demand}: {str(error)[:160]}", flush=True)
    return json.loads(found.read_text(encoding="utf-8"))


def windows_of(folder: Path) -> int:
    """Windows that a run took, also one that failed; 0 of one side alone."""
    if not (folder / "ledger.csv").is_file():
        return 0
    with (folder / "ledger.csv").open(encoding="utf-8") as file:
        return sum(1 for _ in file) - 1


def figure(row: Row, result: dict, folder: Path) -> tuple[float, str]:
    """What the row asks for, and a word on it."""
    coupling = result["cost"]["coupling"] or {}
    if row.statistic in ("iterations", "overhead"):
        key = {"iterations": "iterations_most", "overhead": "overhead_fraction"}[row.statistic]
        return float(coupling[key]), ""
    if row.statistic == "windows":
        return float(windows_of(folder)), ""
    time, probes = read_probes(folder / "probes.csv")
    if row.statistic == "envelope":
        beyond, shift = beyond_envelope(time, probes[row.probe])
        return beyond, f", shift {1e3 * shift:+.1f} ms"
    between = row.between
    if between is None and row.statistic == "mean":
        between = (load_scene(row.case, row.sets).output.average_from, float(time[-1]))
    return float(statistic(row.statistic, time, probes[row.probe], between)), ""


def run_row(row: Row, table: dict, runs: Path, threads: dict[str, int]) -> dict[str, str]:
    """The table's cells."""
    result, folder = result_of(row, runs, threads), directory_of(row, runs)
    cells = {"demand": row.demand, "case": row.case, "settings": " ".join(f"--set {shlex.quote(s)}" for s in row.sets)}
    if result["status"] != "finished" and (not row.breaks or row.breaks not in result["reason"]):
        return cells | {"found": result["reason"].split(". ")[0][:120], "verdict": MISSED}
    found, word = figure(row, result, folder)
    kept = row.most is None or found <= row.most
    kept &= not row.breaks or result["status"] == "failed"
    cells["found"] = f"{found:.6g}{word}"
    cells["allowed"] = bounds(row)
    if row.truth is not None:
        truth = float(table[row.truth]["found"]) if isinstance(row.truth, str) else row.truth
        error = relative_error(found, truth)
        kept &= row.allowed is None or abs(error) <= row.allowed
        cells |= {"truth": f"{truth:.6g}", "error": f"{100.0 * error:+.2f} %"}
        cells |= {} if row.allowed is None else {"allowed": f"{100.0 * row.allowed:g} %"}
    if row.printed is not None:
        cells |= {"printed": f"{row.printed:g}", "from printed": f"{100.0 * relative_error(found, row.printed):+.2f} %"}
    judged = row.allowed is not None or row.most is not None or bool(row.breaks)
    cost = result["cost"]
    return cells | {
        "verdict": verdict(kept if judged else None),
        "particles": str(sum(cost[side]["particles"] for side in ("fluid", "solid") if cost[side]) or ""),
        "windows": str(windows_of(folder) or ""),
        "core seconds": f"{cost['core_s']:.0f}" if cost["core_s"] else "",
        "seconds": f"{cost['wall_s']:.0f}",
    }


def write(table: dict[str, dict[str, str]], runs: Path) -> None:
    """The tables, rows in the order of `rows()`, and the pictures of the method's authors' cases."""
    ordered = [table[row.demand] for row in rows() if row.demand in table]
    lacking = [row.demand for row in rows() if row.demand not in table]
    made = (
        f"Made by `python -m tests.benchmark_coupling`, last on {date.today()}. Each row: `coupler run CASE SETTINGS`."
    )
    costs = (
        "Seconds are of wall time, beside whatever else the machine did; core seconds are of both sides, start-up in."
    )
    head = f"# Coupled runs against what is true\n\n{made} {costs}\n\nNot run yet: {', '.join(lacking) or 'nothing'}."
    write_table("coupled", COLUMNS, ordered, head)
    pictures = []
    for row in rows():
        drawn = directory_of(row, runs) / "last_frame.png"
        if row.demand in OF_THE_PAPER and row.demand in table:
            name = f"paper_{row.case}.png"
            if drawn.is_file():
                shutil.copy(drawn, RESULTS / name)
            pictures.append(f"![{row.demand}]({name})")
    head = (
        f"# The method's authors' three cases, and the smallest models that do as well\n\n{made} {costs} Case A ends "
        "at 0.16 s: with half the critical damping it rests from 0.06 s on. Case B ends at 0.06 s, before the echo of "
        "the water's surface is back; the water, slowed down, damps the plate within 20 ms. Printed: the authors' own "
        f"references, thin beam and thin plate.\n\n{' '.join(pictures)}"
    )
    write_table("paper", COLUMNS, [row for row in ordered if row["demand"].startswith(("paper", "smallest"))], head)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="run the rows that contain this text")
    parser.add_argument("--missing", action="store_true", help="run the rows that the table lacks")
    parser.add_argument("--most", type=float, default=np.inf, help="run the rows of at most so many core-seconds")
    parser.add_argument("--runs", type=Path, default=Path("runs/benchmark_coupling"), help="where run directories stay")
    parser.add_argument("--threads", type=int, default=1, help="of the fluid")
    options = parser.parse_args()
    RESULTS.mkdir(exist_ok=True)
    table = read_table("coupled", COLUMNS)
    for row in rows():
        wanted = row.cost <= options.most and options.only in " ".join((row.demand, row.case, *row.sets))
        if not wanted or (options.missing and row.demand in table):
            continue
        if isinstance(row.truth, str) and row.truth not in table:
            print(f"{row.demand}: waits for {row.truth!r}", flush=True)
            continue
        cells = run_row(row, table, options.runs, {"fluid": options.threads, "solid": 1})
        table[row.demand] = cells
        shown = dict.fromkeys(COLUMNS, "") | cells
        print(f"{row.demand}: {shown['found']} ({shown['error']}) {shown['verdict']} {shown['seconds']} s", flush=True)
        write(table, options.runs)


if __name__ == "__main__":
    main()
