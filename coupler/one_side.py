"""Runs of one side alone, by that side's own program."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from coupler.supervisor import PACKAGES
from shared.scene import dump_scene
from shared.schema import Scene


def run_one_side(scene: Scene, case: str, out: Path | None, threads: dict[str, int], quiet: bool) -> int:
    """Run a scene that has one side by that side's own program; its exit code."""
    side = "solid" if scene.fluid is None else "fluid"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{case}.toml"
        path.write_text(dump_scene(scene), encoding="utf-8")
        command = [sys.executable, "-m", PACKAGES[side], "run", str(path), "--threads", str(threads[side])]
        command += ["--out", str(out)] if out is not None else []
        command += ["--quiet"] if quiet else []
        return _ended(command)


def resume_one_side(run_dir: Path, side: str, threads: str, quiet: bool) -> int:
    """Go on with such a run; its exit code. `threads`: as on the command line, or empty."""
    command = [sys.executable, "-m", PACKAGES[side], "resume", str(run_dir)]
    command += ["--threads", threads.removeprefix(f"{side}=")] if threads else []
    command += ["--quiet"] if quiet else []
    return _ended(command)


def _ended(command: list[str]) -> int:
    """Run a solver to its end; its exit code. Requests to stop reach this process alone, which passes them on."""
    solver = subprocess.Popen(command, start_new_session=True)
    while True:
        try:
            return solver.wait()
        except KeyboardInterrupt:
            solver.send_signal(signal.SIGINT)
