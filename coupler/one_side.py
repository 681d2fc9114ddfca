"""Runs of one side alone, by that side's own program."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from coupler.preflight.check import Preflight, actual
from coupler.supervisor import PACKAGES
from shared.run.curves import keep_curves
from shared.run.plain import plain
from shared.run.results import new_run_directory, read_result, write_result
from shared.run.words import word
from shared.scene.reading import dump_scene
from shared.schema.scene import Scene


def run_one_side(
    scene: Scene, case: str, out: Path | None, threads: dict[str, int], quiet: bool, found: Preflight
) -> int:
    """Run a scene that has one side by that side's own program; its exit code. The result keeps what pre-flight `found`
    and what came of it."""
    side = "solid" if scene.fluid is None else "fluid"
    run_dir = new_run_directory(out, case)
    with tempfile.TemporaryDirectory() as folder:
        path, kept = Path(folder) / f"{case}.toml", Path(folder) / "preflight.json"
        path.write_text(dump_scene(keep_curves(scene, Path(folder)), Path(folder)), encoding="utf-8")
        kept.write_text(json.dumps(plain(found.as_dict())), encoding="utf-8")
        command = [sys.executable, "-m", PACKAGES[side], "run", str(path), "--threads", str(threads[side])]
        command += ["--out", str(run_dir), "--preflight", str(kept)]
        command += ["--quiet"] if quiet else []
        return _concluded(_ended(command), run_dir, scene)


def resume_one_side(run_dir: Path, scene: Scene, side: str, threads: str, quiet: bool) -> int:
    """Go on with a run of one side; its exit code. `threads`: as on the command line, or empty."""
    command = [sys.executable, "-m", PACKAGES[side], "resume", word(run_dir)]
    command += ["--threads", threads.removeprefix(f"{side}=")] if threads else []
    command += ["--quiet"] if quiet else []
    return _concluded(_ended(command), run_dir, scene)


def _concluded(code: int, run_dir: Path, scene: Scene) -> int:
    """The exit code; what pre-flight had predicted of a run that finished has beside it what came."""
    result = read_result(run_dir) if code == 0 else {}
    if result.get("preflight"):
        result["preflight"]["actual"] = actual(result, scene)
        write_result(run_dir, result)
    return code


def _ended(command: list[str]) -> int:
    """Run a solver to its end; its exit code. Requests to stop reach this process alone, which passes them on."""
    solver = subprocess.Popen(command, start_new_session=True)
    while True:
        try:
            return solver.wait()
        except KeyboardInterrupt:
            solver.send_signal(signal.SIGINT)
