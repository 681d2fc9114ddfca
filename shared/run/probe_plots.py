"""One picture per probe: its history against the scene's references."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from shared.run.drawing import FAINT, FONT_PT, INK, axes_at, largest_size, new_figure, save, si_scale
from shared.run.probes import read_probes, reference_curve
from shared.run.statistics import statistic
from shared.schema.probes import QUANTITIES, Probe, Reference
from shared.schema.scene import Scene

_WIDTH_IN, _HEIGHT_IN = 6.5, 3.6
_LEFT_IN, _BOTTOM_IN, _TOP_IN, _RIGHT_IN = 0.8, 0.55, 0.4, 0.15
_LEGEND_IN = 3.0
_LEGEND_ENTRIES = 4  # more than these stand beside the axes, where they hide nothing
_OWN_COLOUR = "#0b4f8a"
# Okabe and Ito's palette, told apart by colour-blind readers; its blues are left to the run.
_COLOURS = ("#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f")
_DASHES = ("--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
_ROOM = 0.06  # above and below what is drawn


def draw_probes(run_dir: Path, scene: Scene) -> list[Path]:
    """Draw each probe that probes.csv holds to probe-NAME.png; the paths, in the scene's order."""
    run_dir = Path(run_dir)
    if not (run_dir / "probes.csv").exists():
        return []
    time, histories = read_probes(run_dir / "probes.csv")
    return [
        _draw_probe(run_dir / f"probe-{probe.name}.png", scene, probe, time, histories[probe.name])
        for probe in scene.probes
        if probe.name in histories and len(time)
    ]


def _draw_probe(path: Path, scene: Scene, probe: Probe, time: np.ndarray, values: np.ndarray) -> Path:
    references = [r for r in scene.references if r.probe == probe.name]
    shown = [values, *(_within(reference_curve(r), time[-1])[1] for r in references if r.curve)]
    shown += [np.array([r.value]) for r in references if r.value and r.statistic in ("mean", "min", "max", "final")]
    factor, unit = si_scale(max(map(largest_size, shown)), QUANTITIES[probe.quantity].unit)
    second, time_unit = si_scale(float(time[-1]), "s")
    beside = len(references) + 1 > _LEGEND_ENTRIES
    figure = new_figure(_WIDTH_IN + (_LEGEND_IN if beside else 0.0), _HEIGHT_IN)
    axes = axes_at(figure, _LEFT_IN, _BOTTOM_IN, _WIDTH_IN - _LEFT_IN - _RIGHT_IN, _HEIGHT_IN - _BOTTOM_IN - _TOP_IN)
    start = scene.output.average_from
    if 0.0 < start < time[-1]:
        axes.axvspan(start / second, time[-1] / second, color="0.94", linewidth=0, zorder=0, label="mean taken here")
    axes.plot(time / second, values / factor, color=_OWN_COLOUR, linewidth=1.4, zorder=3, label="this run")
    for number, reference in enumerate(references):
        style = {"color": _COLOURS[number % len(_COLOURS)], "linestyle": _DASHES[number % len(_DASHES)]}
        _draw_reference(axes, reference, (time, values), start, (second, factor), style)
    axes.set_xlim(0.0, max(time[-1] / second, 1e-12))
    _set_range(axes, np.concatenate(shown) / factor)
    axes.set_xlabel(f"time [{time_unit}]", fontsize=FONT_PT, color=INK)
    axes.set_ylabel(f"{_words(probe)} [{unit}]", fontsize=FONT_PT, color=INK)
    axes.set_title(scene.title, loc="left", fontsize=FONT_PT + 1, color=INK)
    axes.set_title(probe.name, loc="right", fontsize=FONT_PT, color=FAINT)
    axes.grid(color="0.88", linewidth=0.5, zorder=0.5)
    place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.02)} if beside else {}
    style = {"fontsize": FONT_PT - 2, "frameon": True, "framealpha": 0.85, "edgecolor": "none", "labelcolor": INK}
    legend = axes.legend(**style, **place)
    legend.set_zorder(5)
    return save(figure, path)


def _draw_reference(axes, reference: Reference, history, average_from: float, scales, style: dict) -> None:
    """A curve as a line with small dots; a value as a level, a moment or a slope, over its own interval."""
    (time, values), (second, factor) = history, scales
    if reference.curve is not None:
        t, v = _within(reference_curve(reference), time[-1])
        axes.plot(t / second, v / factor, linewidth=1.0, marker="o", markersize=2.0, label=reference.name, **style)
        return
    if reference.statistic in ("period", "change"):
        return  # a length of time and a share have no place on these axes
    label = f"{reference.name} ({reference.statistic.replace('_', ' of ')})"
    begin, end = reference.between or (average_from if reference.statistic == "mean" else 0.0, time[-1])
    if reference.statistic in ("t_min", "t_max"):
        if reference.value <= time[-1]:
            axes.axvline(reference.value / second, linewidth=1.0, label=label, **style)
    elif reference.statistic == "slope":
        # Through the run's own middle: only the slope is said.
        end = min(end, time[-1])
        middle = statistic("mean", time, values, (begin, end)) if begin < end else None
        if middle is not None:
            rise = 0.5 * (end - begin) * reference.value * np.array([-1.0, 1.0])
            axes.plot([begin / second, end / second], (middle + rise) / factor, linewidth=1.4, label=label, **style)
    else:
        level = reference.value / factor
        axes.plot([begin / second, end / second], [level, level], linewidth=1.0, label=label, **style)


def _within(curve: np.ndarray, end: float) -> np.ndarray:
    """The part of a curve (2, n) up to `end` [s]."""
    return curve[:, curve[0] <= end]


def _set_range(axes, values: np.ndarray) -> None:
    """A range that holds all finite values, with some room."""
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return
    low, high = float(values.min()), float(values.max())
    room = _ROOM * (high - low) or _ROOM * abs(high) or 1.0
    if math.isfinite(room):
        axes.set_ylim(low - room, high + room)


def _words(probe: Probe) -> str:
    """What the probe shows, for an axis."""
    quantity = {
        "displacement-x": "displacement x",
        "displacement-y": "displacement y",
        "front-x": "front position",
        "level": "fluid level",
        "max-speed": "largest speed",
        "kinetic-energy": "kinetic energy",
        "force-x": "force x",
        "force-y": "force y",
    }.get(probe.quantity, probe.quantity)
    return f"{quantity} of {probe.body}" if probe.body else quantity
