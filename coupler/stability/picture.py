"""The picture of a stability map: a panel per method, coloured by what runs did, the boundary found, theory's line and
pre-flight's."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from shared.run.drawing import FONT_PT, INK, axes_at, new_figure, save

_PANEL_IN = 2.3
_GAP_IN, _LEFT_IN, _BOTTOM_IN, _TOP_IN, _BAR_IN = 0.28, 0.7, 0.95, 0.62, 0.95
_ROW_GAP_IN = 0.1
_TICK_IN = 0.3  # room that a number under the axis takes
_MOST_COLUMNS = 3
_GROWTH_SHOWN = (0.03, 0.3)  # per row of probes: colours end between these, where nine of ten runs are inside
_PALE = 0.25  # of white in the colours, under lines and points
_TICKS = (
    (4.0, (1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)),
    (10.0, (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)),
    (100.0, (1.0, 2.0, 5.0)),
)
"""Numbers within a decade that get a tick, where the axis ends below so many times its start; else powers of ten."""
_NAMES = {
    "growth": "growth per window",
    "iterations": "iterations of a window",
    "rise": "rise over largest size, over its limit",
    "deviation": "deviation over its limit",
}


def draw_map(stability, found, path: Path) -> Path:
    """Draw `found` (Boundary of every method and x) of a StabilityMap."""
    count = len(stability.methods)
    columns = 2 if count == 4 else min(count, _MOST_COLUMNS)
    rows = math.ceil(count / columns)
    step = _PANEL_IN + _GAP_IN
    height = _BOTTOM_IN + rows * (step + _ROW_GAP_IN) + _TOP_IN - _GAP_IN - _ROW_GAP_IN
    figure = new_figure(_LEFT_IN + columns * step + _BAR_IN, height)
    colours, scaled, label = _colours(stability.criterion, found)
    ends = {"growth": "both", "iterations": "neither"}.get(stability.criterion.measure, "max")
    handles = {}
    for k, method in enumerate(stability.methods):
        row, column = divmod(k, columns)
        bottom = _BOTTOM_IN + (rows - 1 - row) * (step + _ROW_GAP_IN)
        axes = axes_at(figure, _LEFT_IN + column * step, bottom, _PANEL_IN, _PANEL_IN)
        _frame(axes, stability, found, k + columns >= count, column == 0)
        shown = _cells(axes, [b for b in found if b.method == method.name], colours, scaled)
        _lines(axes, [b for b in found if b.method == method.name])
        axes.set_title(method.name, loc="left", fontsize=FONT_PT - 0.5, color=INK, pad=3)
        handles |= dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    bar = axes_at(figure, _LEFT_IN + columns * step + 0.05, _BOTTOM_IN, 0.12, min(rows, 2) * _PANEL_IN)
    figure.colorbar(shown, cax=bar, extend=ends).set_label(label, fontsize=FONT_PT - 1, color=INK)
    bar.tick_params(labelsize=FONT_PT - 1)
    figure.legend(
        handles.values(), handles.keys(),
        fontsize=FONT_PT - 1.5, frameon=False, labelcolor=INK, ncols=2 * columns - 1, loc="lower left",
        bbox_to_anchor=(0.4 / figure.get_figwidth(), 0.0),
    )  # fmt: skip
    figure.text(0.1 / figure.get_figwidth(), 1.0 - 0.22 / height, stability.title, fontsize=FONT_PT + 1, color=INK)
    return save(figure, path)


def _colours(criterion, found):
    """Norm and map of colours, the function that turns a measure into what is coloured, and its name."""
    name = _NAMES[criterion.measure]
    if criterion.measure == "growth":
        sizes = [abs(v) for b in found for _, v in b.tried if math.isfinite(v)]
        end = float(np.clip(np.quantile(sizes, 0.9), *_GROWTH_SHOWN)) if sizes else _GROWTH_SHOWN[1]
        return (Normalize(-end, end), "RdYlGn_r"), lambda v: np.clip(v, -end, end), name
    if criterion.measure == "iterations":
        return (LogNorm(1.0, criterion.limit), "viridis_r"), lambda v: np.minimum(v, criterion.limit), name
    return (Normalize(0.0, 2.0), "RdYlGn_r"), lambda v: np.clip(v / criterion.limit, 0.0, 2.0), name


def _cells(axes, own, colours, scaled):
    """One method's runs, each filling the panel half-way to its neighbours; returns a patch for the bar of colours."""
    norm, name = colours
    ends = _half_way(np.array([b.x for b in own]), axes.get_xlim())
    for b, left, right in zip(own, ends[:-1], ends[1:], strict=True):
        y, value = np.array(b.tried).T
        levels = _half_way(y, axes.get_ylim())
        shown = axes.pcolormesh(
            [left, right], levels, scaled(value)[:, None], norm=norm, cmap=_pale(name), linewidth=0, zorder=1
        )
        axes.plot(np.full(len(y), b.x), y, ".", color="0.35", markersize=1.5, zorder=2, label="run")
        ended = y[np.isposinf(value)]
        if len(ended):
            axes.plot(
                np.full(len(ended), b.x), ended, "x", color=INK, markersize=3.5, zorder=3,
                label="run ended by its diagnosis",
            )  # fmt: skip
    return shown


def _pale(name: str) -> ListedColormap:
    """A map of colours with some white in it."""
    return ListedColormap(_PALE + (1.0 - _PALE) * colormaps[name](np.linspace(0.0, 1.0, 256)))


def _half_way(values: np.ndarray, limits: tuple[float, float]) -> np.ndarray:
    """Ends (n + 1,) of the intervals around increasing `values`, on an axis of ratios between `limits`."""
    middles = np.sqrt(values[:-1] * values[1:])
    return np.concatenate([[limits[0]], middles, [limits[1]]])


def _lines(axes, own) -> None:
    """One method's boundaries: of runs, of theory, of pre-flight."""
    for key, style, label in (
        ("theory", {"color": "#0b4f8a", "linewidth": 1.5}, "theory"),
        ("warned", {"color": INK, "linewidth": 1.0, "linestyle": (0, (3, 2))}, "pre-flight warns from here"),
    ):
        line = np.array([(b.x, getattr(b, key)) for b in own if getattr(b, key) is not None]).reshape(-1, 2)
        if len(line):
            axes.plot(*line.T, zorder=4, label=label, **style)
    found = np.array([(b.x, b.found) for b in own if b.found is not None]).reshape(-1, 2)
    if len(found):
        axes.plot(
            *found.T, "o", color="white", markeredgecolor="black", markersize=4.5, zorder=5, clip_on=False,
            label="boundary, by runs",
        )  # fmt: skip


def _frame(axes, stability, found, lowest: bool, leftmost: bool) -> None:
    """Scales and names, the same for all panels."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    x = np.array(stability.x.values)
    y = np.array([y for b in found for y, _ in b.tried])
    beside = (x.max() / x.min()) ** (0.5 / max(1, len(x) - 1)) if len(x) > 1 else 1.5
    axes.set_xlim(x.min() / beside, x.max() * beside)
    axes.set_ylim(y.min() / 1.05, y.max() * 1.05)
    _ticks_at(axes, x)
    subs = next((subs for ratio, subs in _TICKS if y.max() < ratio * y.min()), (1.0,))
    axes.yaxis.set_major_locator(LogLocator(subs=subs, numticks=20))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    if lowest:
        axes.set_xlabel(_typeset(stability.x.name), fontsize=FONT_PT, color=INK)
    else:
        axes.set_xticklabels([])
    if leftmost:
        axes.set_ylabel(_typeset(stability.y.name), fontsize=FONT_PT, color=INK)
    else:
        axes.yaxis.set_major_formatter(NullFormatter())


def _ticks_at(axes, x: np.ndarray) -> None:
    """Ticks at all x, numbers at as many as there is room for."""
    low, high = np.log(axes.get_xlim())
    places = _PANEL_IN * (np.log(x) - low) / (high - low)
    labels, last = [], -math.inf
    for value, place in zip(x, places, strict=True):
        labels.append(f"{value:.3g}" if place - last >= _TICK_IN else "")
        last = place if labels[-1] else last
    axes.set_xticks(x, labels)
    axes.xaxis.set_minor_locator(NullLocator())


def _typeset(name: str) -> str:
    """A name with its indices set low: ρ_f."""
    return re.sub(r"(\w)_(\w+)", r"$\1_{\2}$", name)
