"""`coupler report`: a run directory as one HTML page that needs nothing else: pictures, tables, ledger, pre-flight."""

from __future__ import annotations

import base64
import csv
import io
import shlex
from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from shared.contract import BadInput, ShearwaterError
from shared.run.checkpoint import way_on
from shared.run.claims import is_claimed
from shared.run.drawing import FONT_PT, INK, axes_at, new_figure
from shared.run.results import loss, read_result
from shared.run.words import word
from shared.scene.reading import load_scene

_WIDTH_IN, _HEIGHT_IN = 6.5, 2.8
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; margin: .5rem 0 1.5rem; font-size: 13px }
td, th { border-bottom: 1px solid #ddd; padding: .25rem .6rem; text-align: left; vertical-align: top }
td.n { text-align: right; font-variant-numeric: tabular-nums }
img { max-width: 100%; display: block; margin: .5rem 0 1.5rem } h2 { margin-top: 2.2rem }
.warn, .failed, .lost { color: #b36b00 } .refuse { color: #b00020 } .smallest { font-weight: bold }
"""


def write_report(run_dir: Path, out: Path | None = None) -> Path:
    """Write `run_dir`/report.html, or `out`; its path. Raises BadInput if the folder holds no result."""
    if not (run_dir / "result.json").exists():
        raise BadInput(f"{run_dir} holds no result.json: {_why_none(run_dir)}")
    result = read_result(run_dir)
    out = out or run_dir / "report.html"
    try:
        page = report_page(run_dir, result)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise BadInput(
            f"{run_dir}: its result.json or its ledger.csv does not hold what a run writes there "
            f"({type(error).__name__}: {error}); run its case.toml again, with --out in a new directory"
        ) from error
    try:
        out.write_text(page, encoding="utf-8", errors="xmlcharrefreplace")
    except OSError as error:
        raise ShearwaterError(f"{out} cannot be written ({error}); choose another place with --out FILE") from error
    return out


def _why_none(run_dir: Path) -> str:
    """Why a folder holds no result, and what to do."""
    if not (run_dir / "case.toml").exists():
        return "name the directory of a run that ended, like runs/dam_break"
    if is_claimed(run_dir):
        return "its run is still going on, and writes one when it ends"
    way = way_on(run_dir) or f"run it again: coupler run {shlex.quote(word(run_dir / 'case.toml'))} --out DIR"
    return f"its run was killed before it could write one; {way}"


def report_page(run_dir: Path, result: Mapping[str, Any]) -> str:
    """The page as text."""
    title = load_scene(run_dir / "case.toml").title
    parts = [
        f"<h1>{escape(title)}</h1>",
        _summary(result),
        *_pictures(run_dir),
        "<h2>Against references</h2>",
        _table(result["references"], ("probe", "name", "statistic", "value", "computed", "error"), percent=("error",)),
        "<h2>Probes</h2>",
        _table(_named(result["probes"], "probe"), ("probe", "final", "mean", "min", "t_min", "max", "t_max", "unit")),
        *_ledger(run_dir, result.get("ledger")),
        "<h2>Cost</h2>",
        _cost(result["cost"]),
        *_preflight(result.get("preflight") or {}),
        "<h2>Environment</h2>",
        _table([_flat(result["environment"])], None),
    ]
    head = f'<meta charset="utf-8"><title>{escape(title)}</title><style>{_STYLE}</style>'
    return f"<!doctype html>\n<html><head>{head}</head><body>\n" + "\n".join(parts) + "\n</body></html>\n"


def _summary(result: Mapping[str, Any]) -> str:
    reason = f": {escape(result['reason'])}" if result["reason"] else ""
    lines = [f'<p>Case {escape(result["case"])}, <span class="{result["status"]}">{result["status"]}</span>{reason}, '
             f"t = {result['t_end']:g} s after {result['cost']['wall_s']:.1f} s.</p>"]  # fmt: skip
    if lost := loss(result):
        lines.append(f'<p class="warn">{escape(lost)}</p>')
    known = result.get("preflight") or {}
    if "predicted" in known and "actual" in known:
        said, came = known["predicted"], known["actual"]
        before = f"{_text(said['core_s'])} core-seconds and an error of at most {_percent(said['error_bound'])}"
        after = f"{_text(came['core_s'])} and erred by {_percent(came['error'])}"
        lines.append(f"<p>Pre-flight said {before}; it took {after}.</p>")
    return "".join(lines)


def _pictures(run_dir: Path) -> Iterable[str]:
    for path in (run_dir / "last_frame.png", *sorted(run_dir.glob("probe-*.png"))):
        if path.exists():
            yield f"<h2>{escape(path.stem.replace('_', ' ').replace('-', ' ', 1))}</h2>{_image(path.read_bytes())}"


def _image(data: bytes) -> str:
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(data).decode()}">'


def _ledger(run_dir: Path, sums: Mapping[str, Any] | None) -> Iterable[str]:
    """Force on the structure and the energy that the lag makes, over time."""
    if not sums:
        return
    yield "<h2>Ledger</h2>"
    yield _table([sums], None)
    path = run_dir / "ledger.csv"
    if path.exists():
        with path.open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if None not in row.values()]  # the last may be cut short
        if rows:
            yield _image(_ledger_picture(rows))


def _ledger_picture(rows: list[dict[str, str]]) -> bytes:
    time = np.array([float(row["t"]) for row in rows])
    figure = new_figure(_WIDTH_IN, _HEIGHT_IN)
    axes = axes_at(figure, 0.75, 0.5, _WIDTH_IN - 1.0, _HEIGHT_IN - 0.7)
    for name, label, colour in (
        ("work_structure", "work on the structure", "#0b4f8a"),
        ("work_fluid", "work on the fluid", "#009e73"),
        ("lag_energy", "their sum: energy made by the lag", "#d55e00"),
    ):
        axes.plot(time, [float(row[name]) for row in rows], color=colour, linewidth=1.0, label=label)
    axes.set_xlabel("time [s]", fontsize=FONT_PT, color=INK)
    axes.set_ylabel("work [J/m]", fontsize=FONT_PT, color=INK)
    axes.grid(color="0.9", linewidth=0.5)
    axes.legend(fontsize=FONT_PT - 2, frameon=False)
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()


def _cost(cost: Mapping[str, Any]) -> str:
    whole = {name: cost[name] for name in ("wall_s", "core_s")}
    sides = [{"side": side, **cost[side]} for side in ("fluid", "solid") if cost.get(side)]
    coupling = [_flat(cost["coupling"])] if cost.get("coupling") else []
    return _table([whole], None) + _table(sides, None) + _table(coupling, None)


def _preflight(known: Mapping[str, Any]) -> Iterable[str]:
    if "findings" not in known:
        return
    yield "<h2>Pre-flight</h2>"
    yield _table(known["findings"], ("rule", "value", "verdict", "reason", "way_out"))
    if known.get("ladder"):
        rungs = [{**rung, "sets": " ".join(rung["sets"])} for rung in known["ladder"] if rung["standing"] != "cannot"]
        columns = ("models", "sets", "error_bound", "core_s", "standing", "reason")
        yield _table(rungs, columns, percent=("error_bound",))


def _named(table: Mapping[str, Mapping[str, Any]], heading: str) -> list[dict[str, Any]]:
    return [{heading: name, **row} for name, row in table.items()]


def _flat(table: Mapping[str, Any]) -> dict[str, Any]:
    """Inner tables and lists as text."""
    words = {}
    for key, value in table.items():
        if isinstance(value, Mapping):
            value = ", ".join(f"{k} {v}" for k, v in value.items())
        words[key] = "; ".join(map(str, value)) if isinstance(value, list) else value
    return words


def _table(rows: Iterable[Mapping[str, Any]], columns: Iterable[str] | None, percent: Iterable[str] = ()) -> str:
    rows = list(rows)
    if not rows:
        return "<p>None.</p>"
    columns = list(columns or rows[0])
    head = "".join(f"<th>{escape(name.replace('_', ' '))}</th>" for name in columns)
    body = "".join("<tr>" + "".join(_cell(row.get(c), c in percent) for c in columns) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _cell(value: Any, as_percent: bool) -> str:
    number = isinstance(value, float | int) and not isinstance(value, bool)
    kind = ' class="n"' if number else f' class="{escape(value)}"' if value in ("warn", "refuse", "smallest") else ""
    return f"<td{kind}>{escape(_percent(value) if as_percent else _text(value))}</td>"


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.2g} %"


def _text(value: Any) -> str:
    if value is None:
        return "–"
    return f"{value:.5g}" if isinstance(value, float) else str(value)
