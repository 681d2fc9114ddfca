"""What a chart leaves behind: a CSV row per variant, a Markdown page, and the picture."""

from __future__ import annotations

import csv
import math
from pathlib import Path

from coupler.chart.study import Chart, Point

COLUMNS = (
    "family",
    "settings",
    "status",
    "value",
    "error",
    "stepping_core_s",
    "core_s",
    "timed_alone",
    "front",
    "predicted_error_bound",
    "predicted_core_s",
)


def write_chart(chart: Chart, folder: Path, command: str) -> list[Path]:
    """Write chart.csv, chart.md and chart.png into `folder`; their paths."""
    paths = [folder / name for name in ("chart.csv", "chart.md", "chart.png")]
    with paths[0].open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(_row(chart, point) for point in chart.points)
    paths[1].write_text(chart_page(chart, command), encoding="utf-8")
    from coupler.chart.picture import draw_chart  # loads for half a second

    draw_chart(chart, paths[2])
    return paths


def _row(chart: Chart, p: Point) -> list:
    cells = ["" if v is None else f"{v:.6g}" for v in (p.value, p.error, p.cost, p.core_s)]
    bound = "" if p.bound is None else f"{p.bound:.4g}"
    front = "yes" if p in chart.front else ""
    alone = "yes" if p.alone else ""
    return [p.variant.family, p.variant.label, p.status, *cells, alone, front, bound, f"{p.expected.core_s:.4g}"]


def chart_page(chart: Chart, command: str) -> str:
    """The Markdown page."""
    goal = chart.scene.goal
    lines = [
        f"# {chart.scene.title}: error against cost",
        "",
        f"Made by `{command}`. Error: of the {goal.statistic} of {goal.probe}, against {chart.truth} "
        f"({chart.truth_value:.6g}). Stepping: processor time of both sides, one thread each, without start-up and "
        "output; core-s holds these too. Bold: the Pareto front. Predicted: what `coupler check` says of the variant.",
        "",
        "| family | settings | value | error | predicted bound | stepping, core-s | core-s | predicted core-s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [_table_line(chart, p) for p in sorted(chart.points, key=lambda p: p.cost or math.inf)]
    lines += ["", *summary(chart)]
    return "\n".join(lines) + "\n"


def _table_line(chart: Chart, p: Point) -> str:
    family = f"**{p.variant.family}**" if p in chart.front else p.variant.family
    value = p.status if p.value is None else f"{p.value:.5g}"
    error, bound = ("–" if v is None else f"{100 * v:.2g} %" for v in (p.error, p.bound))
    beside = "" if p.alone else "~"
    cost, core = ("–" if v is None else f"{beside}{v:.3g}" for v in (p.cost, p.core_s))
    return f"| {family} | {p.variant.label} | {value} | {error} | {bound} | {cost} | {core} | {p.expected.core_s:.3g} |"


def summary(chart: Chart) -> list[str]:
    """What the chart says, in sentences."""
    wanted = f"{100 * chart.scene.goal.error:g} %"
    best = chart.smallest
    if best is None:
        lines = [f"- No variant reaches the wanted error of {wanted}."]
    else:
        what = f"**{best.variant.family}**, {best.variant.settings}"
        reached = f"{100 * best.error:.2g} % in {best.cost:.3g} core-seconds of stepping"
        lines = [f"- Smallest under the wanted {wanted}: {what}: {reached}."]
    if chart.front:
        top = chart.front[-1]
        lines.append(
            f"- Least error on the front: {top.variant.family}, {top.variant.settings}: {100 * top.error:.2g} %."
        )
    for s in chart.slopes:
        text = f"- {s.series}: error ~ cost^{s.slope:.2f}, error ~ dx^{s.order:.2f}"
        if best is not None and math.isfinite(s.at) and s.series != best.variant.series:
            text += f"; at the smallest one's error it costs {s.at:.3g} core-seconds by this line, "
            text += f"{s.at / best.cost:.3g} times as much"
        lines.append(text + ".")
    if chart.spread:
        low, high = min(chart.spread.values()), max(chart.spread.values())
        lines.append(f"- The other references lie {100 * low:+.2g} % to {100 * high:+.2g} % from this truth.")
    beside = sum(not p.alone for p in chart.points)
    if beside:
        lines.append(
            f"- Errors count, times do not: {beside} of {len(chart.points)} variants (~) ran side by side, in "
            "pieces or on other machines, so costs, slopes and the front are only a hint. For times, chart anew into "
            "an empty folder, one variant at a time."
        )
    return lines + [f"- {note}" for note in chart.notes]
