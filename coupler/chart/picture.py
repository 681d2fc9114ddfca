"""The picture of a chart: error against core-seconds, both logarithmic."""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from coupler.chart.study import Chart, Point
from shared.run.drawing import FAINT, FONT_PT, INK, axes_at, new_figure, save

_WIDTH_IN, _HEIGHT_IN = 7.8, 4.2
_LEFT_IN, _BOTTOM_IN, _TOP_IN, _LEGEND_IN = 0.75, 0.55, 0.4, 2.6
# Okabe and Ito's palette, told apart by colour-blind readers.
_COLOURS = ("#0b4f8a", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#000000")
_MARKERS = "osD^vP*X"
_FLOOR = 1e-5  # error below which points are drawn on the floor
_LONGEST_LINE = 38  # of a name in the legend
_SHORT_AXIS = 300.0  # ratio of its ends
_SPREAD_OF = 2  # references besides the truth from which on they are a spread


def draw_chart(chart: Chart, path: Path) -> Path:
    """Draw the variants that finished, a line per series, the front beneath as a wide grey one."""
    figure = new_figure(_WIDTH_IN, _HEIGHT_IN)
    size = _WIDTH_IN - _LEFT_IN - _LEGEND_IN, _HEIGHT_IN - _BOTTOM_IN - _TOP_IN
    axes = axes_at(figure, _LEFT_IN, _BOTTOM_IN, *size)
    drawn = [p for p in chart.points if p.error is not None and p.cost]
    floor = max(_FLOOR, 0.3 * min((p.error for p in drawn if p.error > 0.0), default=_FLOOR))
    for k, series in enumerate(dict.fromkeys(p.variant.series for p in drawn)):
        own = sorted((p for p in drawn if p.variant.series == series), key=lambda p: p.cost)
        style = {"color": _COLOURS[k % len(_COLOURS)], "marker": _MARKERS[k % len(_MARKERS)]}
        axes.plot(
            *_places(own, floor), linewidth=0.9, markersize=4.5, label=textwrap.fill(series, _LONGEST_LINE), **style
        )
    if chart.front:
        front = _places(chart.front, floor)
        axes.plot(
            *front, color=INK, linewidth=5.0, marker="o", markersize=11, alpha=0.15, zorder=1, label="Pareto front"
        )
    axes.axhline(chart.scene.goal.error, color=FAINT, linestyle="--", linewidth=0.9, label="wanted error")
    if len(chart.spread) >= _SPREAD_OF:
        largest = max(abs(v) for v in chart.spread.values())
        axes.axhspan(floor, largest, color="#f0e442", alpha=0.2, linewidth=0, zorder=0, label="spread of references")
    axes.set_xscale("log")
    axes.set_yscale("log")
    _plain_ticks(axes.xaxis, *axes.get_xlim(), 1.0, "")
    _plain_ticks(axes.yaxis, *axes.get_ylim(), 100.0, " %")
    beside = "" if all(p.alone for p in drawn) else ", variants side by side: times are a hint only"
    axes.set_xlabel(f"stepping [core-seconds]{beside}", fontsize=FONT_PT, color=INK)
    axes.set_ylabel(f"error of {chart.scene.goal.statistic} {chart.scene.goal.probe}", fontsize=FONT_PT, color=INK)
    axes.set_title(chart.scene.title, loc="left", fontsize=FONT_PT + 1, color=INK)
    axes.grid(color="0.9", linewidth=0.5, zorder=0.5)
    axes.legend(fontsize=FONT_PT - 2.0, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.02), labelcolor=INK)
    return save(figure, path)


def _plain_ticks(axis, low: float, high: float, factor: float, unit: str) -> None:
    """Numbers written out, `factor` times the values: at 1, 2 and 5 where the axis is short."""
    short = high < _SHORT_AXIS * low
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if short else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{factor * value:.3g}{unit}"))
    axis.set_minor_formatter(NullFormatter())


def _places(points: list[Point], floor: float) -> np.ndarray:
    """Cost and error as rows (2, n)."""
    return np.array([(p.cost, max(p.error, floor)) for p in points]).T
