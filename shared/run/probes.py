"""Probes: their units, their time histories in probes.csv, and the comparison with the scene's references."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from shared.contract import BadInput, ShearwaterError
from shared.run.checkpoint import AGAIN
from shared.run.curves import read_curve
from shared.run.lines import Lines
from shared.run.statistics import Interval, finite, relative_error, statistic
from shared.schema.probes import QUANTITIES, Reference
from shared.schema.scene import Scene
from shared.unwritable import cannot_write


def probe_units(scene: Scene) -> dict[str, str]:
    """Unit of each probe of the scene, by name."""
    return {probe.name: QUANTITIES[probe.quantity].unit for probe in scene.probes}


class ProbeTable:
    """The probes' time histories: kept, and written to the CSV file `path` row by row.

    `units`: unit of each probe by name; its order is the order of the columns after `time`. `rows`: go on with the
    file that is there, behind this many rows.
    """

    def __init__(self, path: str | Path, units: Mapping[str, str], rows: int | None = None):
        self.path = Path(path)
        self.units = dict(units)
        try:
            # A row is on the disk once it is written.
            self._file = Lines(self.path, None if rows is None else 1 + rows, buffering=1)
        except OSError as error:
            raise self._cannot_write(error) from error
        self._rows = [self._numbers(number, line) for number, line in enumerate(self._file.first[1:], start=2)]
        if rows is None:
            self._write(["time", *self.units])

    def append(self, time: float, values: Mapping[str, float]) -> None:
        """Add the values at `time` [s]; a probe that is not among them has none (nan)."""
        row = [float(time), *(float(values.get(name, math.nan)) for name in self.units)]
        self._write([repr(value) for value in row])
        self._rows.append(row)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self._rows)

    @property
    def time(self) -> np.ndarray:
        """Times (n,) [s]."""
        return self._array()[:, 0]

    def values(self, name: str) -> np.ndarray:
        """History (n,) of one probe, in its unit."""
        return self._array()[:, 1 + list(self.units).index(name)]

    def summary(self, average_from: float) -> dict[str, dict[str, Any]]:
        """Per probe: final, mean (over `average_from` [s] … end), min, t_min, max, t_max, unit; None: no value."""
        time = self.time
        window = (average_from, float(time[-1])) if len(time) else None
        result = {}
        for name, unit in self.units.items():
            history = (time, self.values(name))
            names = ("min", "t_min", "max", "t_max")
            result[name] = {
                "final": statistic("final", *history),
                "mean": statistic("mean", *history, window) if window and window[0] <= window[1] else None,
                **{which: statistic(which, *history) for which in names},
                "unit": unit,
            }
        return result

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> ProbeTable:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _array(self) -> np.ndarray:
        return np.array(self._rows, dtype=float).reshape(len(self._rows), 1 + len(self.units))

    def _numbers(self, number: int, line: str) -> list[float]:
        """The cells of a line of the file."""
        try:
            row = [float(cell) for cell in line.split(",")]
        except ValueError:
            row = []
        wanted = 1 + len(self.units)
        if len(row) != wanted:
            raise BadInput(f"{self.path}: line {number} does not hold {wanted} numbers. {AGAIN}")
        return row

    def _write(self, cells: list[str]) -> None:
        try:
            self._file.write(",".join(cells))
        except OSError as error:
            raise self._cannot_write(error) from error

    def _cannot_write(self, error: OSError) -> ShearwaterError:
        return cannot_write("The table of probes", self.path, error)


def read_probes(path: str | Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times (n,) [s] and the history (n,) of each probe, from a probes.csv; a last line cut short is left out.

    Raises BadInput.
    """
    try:
        with Path(path).open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        whole = [row for row in rows if len(row) == len(header)]
        columns = np.array(whole, dtype=float).reshape(len(whole), len(header)).T
    except (OSError, ValueError, csv.Error) as error:
        raise BadInput(
            f"{path} is not a readable table of probes ({error}): remove its run, and run it again"
        ) from None
    return columns[0], dict(zip(header[1:], columns[1:], strict=True))


def compare(scene: Scene, table: ProbeTable) -> list[dict[str, Any]]:
    """The scene's references beside what the run found: probe, name, statistic, value, computed, error.

    error = (computed − value)/|value|, absolute where the value is 0. With a curve, both statistics are taken over
    the interval that curve and run share. None: the run does not reach over the interval asked for, or has no value
    there. References of probes that the run does not have (those of the other side) are left out.
    """
    rows = []
    for reference in scene.references:
        if reference.probe not in table.units:
            continue
        value, computed = _both(reference, table.time, table.values(reference.probe), scene.output.average_from)
        known = value is not None and computed is not None
        rows.append(
            {
                "probe": reference.probe,
                "name": reference.name,
                "statistic": reference.statistic,
                "value": value,
                "computed": computed,
                "error": relative_error(computed, value) if known else None,
            }
        )
    return rows


def goal_value(scene: Scene, time: np.ndarray, values: np.ndarray) -> float | None:
    """The goal's statistic of the history (n,) of its probe, over the interval that it is judged by, or else, of a
    mean, from output.average_from on; None where there is none."""
    goal, (time, values) = scene.goal, finite(time, values)
    if len(time) == 0:
        return None
    start = scene.output.average_from if goal.statistic == "mean" else float(time[0])
    return _over(goal.statistic, time, values, goal_interval(scene) or (start, float(time[-1])))


def goal_interval(scene: Scene) -> Interval | None:
    """The interval of the study's truth for the goal, or of the goal's first reference; None where that names none."""
    truth = scene.study.truth if scene.study is not None else None
    known = (r for r in goal_references(scene) if truth in (None, r.name))
    return next((r.between for r in known), None)


def goal_references(scene: Scene) -> list[Reference]:
    """The scene's references of the goal's probe and statistic."""
    return [r for r in scene.references if (r.probe, r.statistic) == (scene.goal.probe, scene.goal.statistic)]


def reference_curve(reference: Reference) -> np.ndarray:
    """Time [s] and value, in the probe's unit, of a reference's curve: (2, n). Raises BadInput."""
    try:
        return read_curve(reference.curve, reference.scale).T - np.array([[reference.delay], [0.0]])
    except (OSError, ValueError) as error:
        raise BadInput(
            f"The curve {reference.curve} of reference {reference.name!r} cannot be read: {error}."
        ) from error


def _both(reference: Reference, time: np.ndarray, values: np.ndarray, average_from: float):
    """Reference value and computed value of one reference."""
    time, values = finite(time, values)
    if len(time) == 0:
        return reference.value, None
    interval = reference.between or (average_from if reference.statistic == "mean" else float(time[0]), math.inf)
    if reference.curve is None:
        if reference.between is None:
            interval = (interval[0], float(time[-1]))
        return reference.value, _over(reference.statistic, time, values, interval)
    curve = reference_curve(reference)
    shared = (max(interval[0], time[0], curve[0][0]), min(interval[1], time[-1], curve[0][-1]))
    return _over(reference.statistic, *curve, shared), _over(reference.statistic, time, values, shared)


def _over(which: str, time: np.ndarray, values: np.ndarray, interval: Interval) -> float | None:
    return statistic(which, time, values, interval) if interval[0] <= interval[1] else None
