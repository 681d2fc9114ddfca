"""A variant of a chart on a worker of a Dask cluster: run in a folder of its own, of which only the results go back."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from coupler.guard import PATIENCE_S, end

_LOOK_EVERY_S = 0.5
RUN_FOLDER = "run"
"""Where a variant's command has to put its run directory."""


def run_variant(words: list[str], scene_file: str, scene: str) -> dict[str, str | int | None]:
    """Run Python with `words` in a temporary folder that holds the text `scene` as `scene_file`.

    Returns the texts of result.json and probes.csv, None where the run left none, its log and its exit code.
    The run ends early when the chart gives it up, and with the worker.
    """
    with tempfile.TemporaryDirectory(prefix="shearwater-") as name:
        folder = Path(name)
        (folder / scene_file).write_text(scene, encoding="utf-8")
        log = folder / "log.txt"
        command = [sys.executable, "-m", "coupler.guard", sys.executable, *words]
        with log.open("w") as file:
            child = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=file, stderr=file)
            try:
                _wait(child)
            finally:
                end(child, 2.0 * PATIENCE_S)  # the guard is patient first
        run = folder / RUN_FOLDER
        return {
            "result": _text(run / "result.json"),
            "probes": _text(run / "probes.csv"),
            "log": log.read_text(encoding="utf-8", errors="replace"),
            "code": child.returncode,
        }


def _wait(child: subprocess.Popen) -> None:
    """Until the process ends, or Dask's scheduler wants the task no longer."""
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()
    while True:
        try:
            child.wait(_LOOK_EVERY_S)
            return
        except subprocess.TimeoutExpired:
            task = worker.state.tasks.get(key)
            if task is None or task.state == "cancelled":
                return


def _text(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.exists() else None
