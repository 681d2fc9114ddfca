"""Reference curves: CSV files of time and value."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np


def read_curve(path: str | Path, scale: tuple[float, float] = (1.0, 1.0)) -> np.ndarray:
    """The curve in a CSV file as (n, 2): time [s] and value, in order of time.

    The first two columns count, times `scale`. A first line that holds no numbers is a header; lines that
    begin with # are comments. Raises OSError or ValueError with a reason fit for the user.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError("no such file")
    rows = []
    with path.open(newline="", encoding="utf-8") as file:
        for number, row in enumerate(csv.reader(file), start=1):
            if not row or row[0].lstrip().startswith("#"):
                continue
            try:
                rows.append((float(row[0]), float(row[1])))
            except (ValueError, IndexError):
                if number > 1:
                    raise ValueError(f"line {number} does not hold two numbers") from None
    curve = np.array(rows).reshape(-1, 2)
    if len(curve) == 0 or not np.isfinite(curve).all():
        raise ValueError("no rows of two finite numbers")
    return curve[np.argsort(curve[:, 0], kind="stable")] * np.asarray(scale)
