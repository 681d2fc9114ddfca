"""What there is to go on with in a run directory."""

from __future__ import annotations

import json
import shlex
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from shared.contract import BadInput
from shared.run.checkpoint import FOLDER, Checkpoint, misfit, newest
from shared.run.claims import claim
from shared.run.plain import plain
from shared.run.record import keep_scene
from shared.run.results import environment
from shared.run.vtkhdf import check_frames
from shared.run.words import word
from shared.scene.reading import load_scene
from shared.schema.scene import Scene
from shared.streams import say

_FREE = ("coupling.stall_after", "output.checkpoint_every")  # keys that no result depends on
_NOTES = ("case", "scene", "threads", "probe_rows", "wall_s", "preflight", "environment")


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
    if not (run_dir / "case.toml").exists() and not (run_dir / FOLDER).exists():
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
    if isinstance(result, dict) and result.get("status") == "finished":
        raise BadInput(f"The run in {run_dir} has finished: there is nothing to go on with.")
    last, case = newest(run_dir), run_dir / "case.toml"
    if lacking := [note for note in _NOTES if note not in last.notes]:
        raise misfit(last.folder, KeyError(", ".join(lacking)))
    _warn_of(last.passed_over, f"an older one is taken, t = {last.time:.4g} s")
    if not case.exists():
        keep_scene(run_dir, last.notes["scene"])
    scene = load_scene(case)
    text = case.read_text(encoding="utf-8-sig")
    if changes := _changes(last.notes["scene"], text):
        raise BadInput(
            f"{case} is not the scene that the run went by up to t = {last.time:.4g} s: {'; '.join(changes)}. Put it "
            f"back and resume, or run it from the start: coupler run {shlex.quote(word(case))} --out DIR"
        )
    if other := other_environment(last):
        much = "" if any(one.startswith("sources ") for one in other) else " in the last bits"
        say(f"warning: results may differ{much}: {'; '.join(other)}")
    for path in (run_dir / f"{side}.vtkhdf" for side in last.notes["threads"]):
        if path.exists():
            check_frames(path)
        elif path.stem not in last.notes.get("programs", {}):  # which need not write any
            _warn_of([f"{path} is gone"], f"a new one begins after t = {last.time:.4g} s")
    return scene, last


def _warn_of(complaints: Iterable[str], consequence: str) -> None:
    for text in complaints:
        say(f"warning: {text}: {consequence}")


def _changes(then: str, now: str) -> list[str]:
    """Keys of a scene's text that differ and may not, with both values."""
    old, new = (dict(_leaves(tomllib.loads(text))) for text in (then, now))
    keys = [key for key in old | new if old.get(key) != new.get(key) and key not in _FREE]
    return [f"{key} = {_shown(new.get(key))}, was {_shown(old.get(key))}" for key in keys]


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """The values in tables and lists, each with its path."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, one in inner:
        place = f"{path}[{key}]" if isinstance(value, list) else f"{path}.{key}".lstrip(".")
        yield from _leaves(one, place)
    if not isinstance(value, dict | list):
        yield path, value


def _shown(value: Any) -> str:
    return "nothing" if value is None else json.dumps(value, ensure_ascii=False)


def other_environment(last: Checkpoint) -> list[str]:
    """What differs from the environment that wrote the checkpoint."""
    then, now = last.notes["environment"], plain(environment({}))
    old, new = ({**e["versions"], "cpu": e["cpu"], "platform": e["platform"]} for e in (then, now))
    return [f"{name} {old.get(name)} then, {value} now" for name, value in new.items() if old.get(name) != value]
