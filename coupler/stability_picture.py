"""The picture of a stability map: a panel per method, every run a coloured cell, the boundary found, theory's line."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.ticker import LogFormatterSciNotation

from shared.drawing import FONT_PT, INK, axes_at, new_figure, save

_PANEL_IN = 2.3
_GAP_IN, _LEFT_IN, _BOTTOM_IN, _TOP_IN, _BAR_IN = 0.28, 0.7, 0.95, 0.62, 0.95
_MOST_COLUMNS = 3
_GROWTH_SHOWN = 0.3  # per row of probes: colours end there
_NAMES = {
    "growth": "growth per window",
    "swell": "growth per window",
    "iterations": "iterations per window",
    "rise": "rise over largest size, over its limit",
    "deviation": "deviation over its limit",
}


def draw_map(stability, found, path: Path) -> Path:
    """Draw `found` (Boundary of every method and x) of a StabilityMap."""
    count = len(stability.methods)
    columns = 2 if count == 4 else min(count, _MOST_COLUMNS)
    rows = math.ceil(count / columns)
    step = _PANEL_IN + _GAP_IN
    height = _BOTTOM_IN + rows * step + _TOP_IN - _GAP_IN + (rows - 1) * 0.1
    figure = new_figure(_LEFT_IN + columns * step + _BAR_IN, height)
    colours, scaled, label = _colours(stability.criterion, found)
    for k, method in enumerate(stability.methods):
        row, column = divmod(k, columns)
        bottom = _BOTTOM_IN + (rows - 1 - row) * (step + 0.1)
        axes = axes_at(figure, _LEFT_IN + column * step, bottom, _PANEL_IN, _PANEL_IN)
        shown = _panel(axes, [b for b in found if b.method == method.name], colours, scaled)
        _frame(axes, stability, found, row == rows - 1 or k + columns >= count, column == 0)
        axes.set_title(method.name, loc="left", fontsize=FONT_PT - 0.5, color=INK, pad=3)
    bar = axes_at(figure, _LEFT_IN + columns * step + 0.05, _BOTTOM_IN, 0.12, min(rows, 2) * _PANEL_IN)
    figure.colorbar(shown, cax=bar).set_label(label, fontsize=FONT_PT - 1, color=INK)
    bar.tick_params(labelsize=FONT_PT - 1)
    axes.legend(
        *axes.get_legend_handles_labels(),
        fontsize=FONT_PT - 1.5, frameon=False, labelcolor=INK, ncols=3, loc="lower left",
        bbox_to_anchor=(0.0, 0.0), bbox_transform=figure.transFigure,
    )  # fmt: skip
    figure.text(0.05 / figure.get_figwidth(), 1.0 - 0.22 / height, stability.title, fontsize=FONT_PT + 1, color=INK)
    return save(figure, path)


def _colours(criterion, found):
    """Norm and map of colours, the function that turns a measure into what is coloured, and its name."""
    name = _NAMES[criterion.measure]
    if criterion.measure in ("growth", "swell"):
        bounds = Normalize(-_GROWTH_SHOWN, _GROWTH_SHOWN)
        return (bounds, "RdYlGn_r"), lambda v: np.clip(v, -_GROWTH_SHOWN, _GROWTH_SHOWN), name
    if criterion.measure == "iterations":
        return (LogNorm(1.0, criterion.limit), "viridis_r"), lambda v: np.minimum(v, criterion.limit), name
    return (Normalize(0.0, 2.0), "RdYlGn_r"), lambda v: np.clip(v / criterion.limit, 0.0, 2.0), name


def _panel(axes, own, colours, scaled):
    """One method's cells, boundaries and theory; returns the cells, for the bar of colours."""
    norm, name = colours
    cells = np.array([(b.x, y, value) for b in own for y, value in b.tried]).reshape(-1, 3)
    shown = axes.scatter(
        cells[:, 0], cells[:, 1], c=scaled(cells[:, 2]), norm=norm, cmap=name, s=26, marker="s", linewidths=0
    )
    ended = cells[np.isposinf(cells[:, 2])]
    axes.plot(ended[:, 0], ended[:, 1], "x", color=INK, markersize=3.0, linewidth=0, label="ended by its diagnosis")
    found = np.array([(b.x, b.found) for b in own if b.found is not None]).reshape(-1, 2)
    axes.plot(*found.T, "o", color="white", markeredgecolor="black", markersize=4.5, label="boundary, by runs")
    line = np.array([(b.x, b.theory) for b in own if b.theory is not None]).reshape(-1, 2)
    axes.plot(*line.T, color="#0b4f8a", linewidth=1.3, label="theory")
    return shown


def _frame(axes, stability, found, lowest: bool, leftmost: bool) -> None:
    """Scales and names, the same for all panels."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    x = np.array([b.x for b in found])
    y = np.array([y for b in found for y, _ in b.tried])
    axes.set_xlim(x.min() / 1.25, x.max() * 1.25)
    axes.set_ylim(y.min() / 1.25, y.max() * 1.25)
    for axis, values in ((axes.xaxis, x), (axes.yaxis, y)):
        if values.max() / values.min() < 10.0:
            axis.set_minor_formatter(LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(2.0, 1.0)))
            axis.set_tick_params(which="minor", labelsize=FONT_PT - 2)
    axes.grid(color="0.9", linewidth=0.5, zorder=0)
    axes.set_axisbelow(True)
    if lowest:
        axes.set_xlabel(stability.x.name, fontsize=FONT_PT, color=INK)
    else:
        axes.set_xticklabels([], minor=False)
    if leftmost:
        axes.set_ylabel(stability.y.name, fontsize=FONT_PT, color=INK)
    else:
        axes.set_yticklabels([], minor=False)
