"""Reference curves: CSV files of time and value."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path

import numpy as np

from shared.schema.scene import Scene
from shared.unwritable import cannot_write

FOLDER = "references"
"""Where a run directory keeps its curves."""


def keep_curves(scene: Scene, run_dir: Path) -> Scene:
    """Copy the curves of the scene's references into `run_dir`, which needs nothing from elsewhere then, wherever it is
    taken; the scene with the copies. Raises ShearwaterError."""
    folder = run_dir.resolve() / FOLDER
    curves = dict.fromkeys(reference.curve for reference in scene.references if reference.curve is not None)
    copies = {curve: folder / f"{number}.csv" for number, curve in enumerate(curves, start=1)}
    for curve, copy in copies.items():
        try:
            folder.mkdir(exist_ok=True)
            shutil.copyfile(curve, copy)
        except OSError as error:
            raise cannot_write(f"The copy of {curve},", copy, error) from error
    references = [
        r if r.curve is None else r.model_copy(update={"curve": str(copies[r.curve])}) for r in scene.references
    ]
    return scene.model_copy(update={"references": references})


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
