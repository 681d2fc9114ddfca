"""`--models auto`: the run takes the smallest pair that meets the goal, on one side alone where no more is needed."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from coupler.preflight import Preflight
from coupler.supervisor import PACKAGES
from shared.contract import BadInput
from shared.scene import dump_scene
from shared.schema import Scene


def chosen(report: Preflight) -> Scene:
    """The scene of the smallest pair. Raises BadInput where there is none, with what was in the way."""
    if report.choice is not None:
        return report.choice.scene
    if not report.ladder:
        raise BadInput("--models auto needs a [goal] (probe, statistic, error) to choose by; add one to the scene")
    reasons = "\n".join(f"  {rung.name}: {rung.reason}" for rung in report.ladder if rung.standing == "not enough")
    raise BadInput(f"--models auto: no pair of models is known to meet the goal\n{reasons}")


def run_one_side(scene: Scene, case: str, out: Path | None, threads: dict[str, int], quiet: bool) -> int:
    """Run a scene that has one side by that side's own program; its exit code."""
    side = "solid" if scene.fluid is None else "fluid"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{case}.toml"
        path.write_text(dump_scene(scene), encoding="utf-8")
        command = [sys.executable, "-m", PACKAGES[side], "run", str(path), "--threads", str(threads[side])]
        command += ["--out", str(out)] if out is not None else []
        command += ["--quiet"] if quiet else []
        return subprocess.run(command, check=False).returncode
