"""Runs of a map that have been made: a line each in runs.jsonl beside the map, so that one cut short goes on.

A line is found again by what it depends on: the cell's scene, what is measured of it, and the code that measures.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

from coupler.stability.map import Criterion
from shared.run.plain import plain
from shared.run.results import environment
from shared.scene.reading import computed
from shared.schema.scene import Scene

Measured = Callable[[Scene, Criterion], float | None]
Remembered = Callable[[Measured, Scene, Criterion], float | None]


def remembered(path: Path) -> Remembered:
    """A function that says what a measure of a scene's run gives: from the file `path`, or by the run, which is then
    written there."""
    known = _read(path)
    versions = json.dumps(plain(environment({})["versions"]))

    def give(measured: Measured, scene: Scene, criterion: Criterion) -> float | None:
        what = (computed(scene), criterion.model_dump_json(exclude={"limit"}), measured.__name__, versions)
        cell = hashlib.sha256("\n".join(what).encode()).hexdigest()
        if cell not in known:
            known[cell] = measured(scene, criterion)
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"cell": cell, "value": known[cell]}) + "\n")
        return known[cell]

    return give


def _read(path: Path) -> dict[str, float | None]:
    """The whole lines of the file; one that was cut short is ended, so that the next stands alone."""
    known: dict[str, float | None] = {}
    text = path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""
    if text and not text.endswith("\n"):
        with path.open("a", encoding="utf-8") as file:
            file.write("\n")
    for line in text.splitlines():
        try:
            found = json.loads(line)
            known[found["cell"]] = found["value"]
        except (ValueError, KeyError, TypeError):
            continue
    return known
