"""Helpers of the pictures: SI prefixes, a figure laid out in inches, one look for all."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from shared.unwritable import cannot_write

matplotlib.rcdefaults()  # whatever a user's matplotlibrc wants, like words set by a LaTeX that is not installed

INK = "0.15"
FAINT = "0.55"
FONT_PT = 9.0
DPI = 200

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
_PREFIXABLE = ("m", "s", "m/s", "Pa", "N/m", "J/m")
_LEAST_LEADING = 0.1  # 0.45 m rather than 450 mm


def si_scale(largest: float, unit: str) -> tuple[float, str]:
    """Factor to divide by, and the unit with its prefix, so that `largest` reads well: (1e-3, "mm") for 0.045 m."""
    if unit not in _PREFIXABLE or not np.isfinite(largest) or largest <= 0.0:
        return 1.0, unit
    for factor, prefix in _PREFIXES:
        if largest / factor >= _LEAST_LEADING and not (unit in ("m", "s") and factor > 1.0):
            return factor, prefix + unit
    return _PREFIXES[-1][0], _PREFIXES[-1][1] + unit


def largest_size(values: np.ndarray) -> float:
    """Largest absolute finite value; 0 if there is none."""
    values = np.abs(values[np.isfinite(values)])
    return float(values.max()) if values.size else 0.0


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of `width` by `height` inches; no global state, so that any process may draw."""
    figure = Figure(figsize=(width, height), dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def axes_at(figure: Figure, left: float, bottom: float, width: float, height: float):
    """Axes whose frame stands at these inches from the figure's lower left corner."""
    w, h = figure.get_size_inches()
    axes = figure.add_axes((left / w, bottom / h, width / w, height / h))
    axes.tick_params(labelsize=FONT_PT - 1, colors=INK, direction="out", length=3, width=0.6)
    for spine in axes.spines.values():
        spine.set(linewidth=0.6, color=FAINT)
    return axes


def save(figure: Figure, path: Path) -> Path:
    """Write the picture; ShearwaterError if it cannot be written."""
    try:
        figure.savefig(path)
    except OSError as error:
        raise cannot_write("The picture", path, error) from error
    return path
