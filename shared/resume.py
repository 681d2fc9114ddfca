"""What there is to go on with in a run directory."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from shared.checkpoint import Checkpoint, claim, newest
from shared.contract import BadInput
from shared.plain import plain
from shared.results import environment
from shared.scene import load_scene
from shared.schema import Scene


@dataclass(frozen=True)
class Unfinished:
    """A run that was cut short: its scene as it ran, its last checkpoint, and the claim that keeps others from it."""

    run_dir: Path
    scene: Scene
    last: Checkpoint
    held: TextIO


def unfinished(run_dir: Path) -> Unfinished:
    """The run in `run_dir`, claimed first, so that nobody changes what is found there; warns where the machine or the
    packages are others. Raises BadInput."""
    if not (run_dir / "case.toml").exists():
        raise BadInput(f"{run_dir} is not the directory of a run: it has no case.toml.")
    held = claim(run_dir)
    try:
        scene, last = _found(run_dir)
    except BaseException:
        held.close()
        raise
    return Unfinished(run_dir, scene, last, held)


def _found(run_dir: Path) -> tuple[Scene, Checkpoint]:
    try:
        result = json.loads((run_dir / "result.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        result = {}  # killed before it could say how it went
    if result.get("status") == "finished":
        raise BadInput(f"The run in {run_dir} has finished: there is nothing to go on with.")
    last = newest(run_dir)
    other = other_environment(last)
    if other:
        print(f"warning: results may differ in the last bits: {'; '.join(other)}", file=sys.stderr)
    return load_scene(run_dir / "case.toml"), last


def other_environment(last: Checkpoint) -> list[str]:
    """What differs from the environment that wrote the checkpoint."""
    then, now = last.notes["environment"], plain(environment({}))
    old, new = ({**e["versions"], "cpu": e["cpu"], "platform": e["platform"]} for e in (then, now))
    return [f"{name} {old.get(name)} then, {value} now" for name, value in new.items() if old.get(name) != value]
