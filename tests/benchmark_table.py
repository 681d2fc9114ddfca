"""A benchmark's table: rows of text cells kept as CSV, and shown as Markdown beside it."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

RESULTS = Path(__file__).resolve().parent.parent / "cases" / "results"
MET, MISSED = "met", "missed"


@dataclass(frozen=True)
class Measure:
    """A figure that is no run of a case: `find()`, in `unit`; `least`, `most`: allowed; `command` repeats it."""

    demand: str
    command: str
    find: Callable[[], float]
    unit: str
    least: float | None = None
    most: float | None = None


def verdict(kept: bool | None) -> str:
    """The word for a demand that is kept or not; nothing where nothing is demanded."""
    return "" if kept is None else MET if kept else MISSED


def bounds(row) -> str:
    """What is demanded of a figure by `row.least` or `row.most`, in words of the table."""
    if row.least is not None:
        return f"≥ {row.least:g}"
    return "" if row.most is None else f"≤ {row.most:g}"


def bounded(figure: float, row) -> str:
    """The verdict on a figure by `row.least` and `row.most`."""
    kept = (row.least is None or figure >= row.least) and (row.most is None or figure <= row.most)
    return verdict(None if row.least is None and row.most is None else kept)


def run_measure(one: Measure) -> dict[str, str]:
    """The table's cells of a figure that is no run of a case."""
    figure = one.find()
    cells = {"demand": one.demand, "settings": f"`{one.command}`", "found": f"{figure:.4g} {one.unit}".strip()}
    return cells | {"allowed": bounds(one), "verdict": bounded(figure, one)}


def read_table(name: str, columns: Sequence[str]) -> dict[str, dict[str, str]]:
    """The rows of cases/results/NAME.csv, by demand."""
    path = RESULTS / f"{name}.csv"
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8") as file:
        return {row["demand"]: {c: row.get(c) or "" for c in columns} for row in csv.DictReader(file)}


def write_table(name: str, columns: Sequence[str], rows: Sequence[dict[str, str]], head: str) -> None:
    """Write the rows to cases/results/NAME.csv, and `head` and the rows to NAME.md."""
    rows = [dict.fromkeys(columns, "") | row for row in rows]
    with (RESULTS / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    missed = [row["demand"] for row in rows if row["verdict"] == MISSED]
    lines = [head, "", f"Missed: {', '.join(missed) or 'nothing'}.", ""]
    lines += ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(row[c].replace("|", "\\|") for c in columns) + " |" for row in rows]
    (RESULTS / f"{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
