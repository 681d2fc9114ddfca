"""Checkpoints: all that a run's future depends on, in files that are whole or not there.

    checkpoints/window-0000001200/  fluid.h5 solid.h5    state of each side, written by that side
                                    run.h5               what lies between them: histories, sums
                                    manifest.json        written last: window, time, cost so far, checksums of all parts
                                                         and of itself

A folder counts once its manifest stands and all checksums hold; the two newest are kept. A part is made in memory and
written by plain writes, so that a full disk is an error like any other and spoils nothing that stands.
"""

from __future__ import annotations

import hashlib
import io
import json
import shlex
import shutil
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from shared.contract import BadInput
from shared.run.plain import plain
from shared.run.whole import write_whole
from shared.run.words import word
from shared.unwritable import cannot_write

State = dict[str, np.ndarray]
"""Named arrays; a name may be a path like "loads/0/force"."""

FOLDER = "checkpoints"
_KEPT = 2
_MANIFEST = "manifest.json"
_KINDS = {"window": int, "t": int | float, "parts": dict, "notes": dict}
_NOTES = {
    **dict.fromkeys(("case", "scene"), str),
    **dict.fromkeys(("threads", "preflight", "programs", "environment", "counts"), dict),
    **{"probe_rows": int, "wall_s": int | float, "reasons": list},
}
_WHAT, _INSTEAD = "The checkpoint", ", do without (--set output.checkpoint_every=0)"
AGAIN = "Start it again with `run` and a new directory (--out DIR): runs are never overwritten."
"""The way out where a run cannot go on."""


def under(prefix: str, state: Mapping[str, np.ndarray]) -> State:
    """The state with `prefix/` before every name."""
    return {f"{prefix}/{name}": array for name, array in state.items()}


def inside(prefix: str, state: Mapping[str, np.ndarray]) -> State:
    """The inverse of `under`; other names are left out."""
    return {name.removeprefix(f"{prefix}/"): a for name, a in state.items() if name.startswith(f"{prefix}/")}


def write_state(path: Path, state: Mapping[str, np.ndarray]) -> None:
    """Write `state` to the HDF5 file `path`: all of it or nothing. Raises ShearwaterError."""
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        for name, array in state.items():
            file[name] = array
    write_whole(_WHAT, path, image.getvalue(), _INSTEAD)


def read_state(path: Path) -> State:
    """What `write_state` wrote. Raises BadInput."""
    found: State = {}

    def take(name: str, item: h5py.Dataset | h5py.Group) -> None:
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]

    try:
        with h5py.File(path, locking=False) as file:
            file.visititems(take)
    except OSError as error:
        raise BadInput(f"The checkpoint {path} cannot be read ({error}).") from error
    return found


def misfit(path: str | Path, error: Exception) -> BadInput:
    """What to raise where a state has been read from `path`, and is not one of this run."""
    return BadInput(
        f"The checkpoint {path} does not fit this run ({type(error).__name__}: {error}): it was written under another "
        f"scene, or by another version. {AGAIN}"
    )


@dataclass(frozen=True)
class Checkpoint:
    """A complete checkpoint: its folder, the number of windows accepted, their end [s], and the run's own notes.

    `passed_over`: what is wrong with newer ones.
    """

    folder: Path
    window: int
    time: float
    notes: Mapping[str, Any]
    passed_over: tuple[str, ...] = ()

    def part(self, name: str) -> Path:
        """File of one part."""
        return self.folder / f"{name}.h5"


class Checkpoints:
    """Those of one run: says when the next is due, begins and seals it.

    `every`: wall time [s] between two of them, 0 for none; the first is due at t = 0. `last`: the one that the run
    goes on from; what is there beyond it goes when another begins.
    """

    def __init__(self, run_dir: Path, every: float, last: Checkpoint | None = None):
        self._root = run_dir / FOLDER
        self._every = every
        self._last = -float("inf") if last is None else time.monotonic()

    def due(self, last: bool = False) -> bool:
        """Whether it is time for another; `last`: the run stops here."""
        return self._every > 0.0 and (last or time.monotonic() - self._last >= self._every)

    def begin(self, window: int) -> Path:
        """A new folder for the parts of the checkpoint before window number `window`; later ones go."""
        folder = (self._root / f"window-{window:010d}").absolute()
        try:
            for other in self._root.glob("window-*"):
                if other.name >= folder.name:
                    shutil.rmtree(other)
            self._root.mkdir(exist_ok=True)
            folder.mkdir()
        except OSError as error:
            raise cannot_write(_WHAT, folder, error, _INSTEAD) from error
        return folder

    def seal(self, folder: Path, window: int, now: float, notes: Mapping[str, Any]) -> None:
        """All parts are there: the manifest makes them a checkpoint; all but the two newest go."""
        parts = {path.name: _checksum(path) for path in sorted(folder.glob("*.h5"))}
        manifest = {"window": window, "t": now, "parts": parts, "notes": plain(notes)}
        manifest["sum"] = _sum(manifest)
        write_whole(_WHAT, folder / _MANIFEST, json.dumps(manifest, indent=1).encode(), _INSTEAD)
        for old in sorted(self._root.glob("window-*"))[:-_KEPT]:
            shutil.rmtree(old, ignore_errors=True)
        self._last = time.monotonic()


def newest(run_dir: Path) -> Checkpoint:
    """The newest complete checkpoint of a run that its tables reach, or else the newest: what lacks is told of when
    they are read. Raises BadInput if there is none."""
    damaged: list[str] = []
    unreached: Checkpoint | None = None
    for folder in sorted((Path(run_dir) / FOLDER).glob("window-*"), reverse=True):
        if not (folder / _MANIFEST).exists():
            continue  # begun, and never sealed
        if not (spoiled := _spoiled(folder)):
            manifest = json.loads((folder / _MANIFEST).read_text())
            one = Checkpoint(folder, manifest["window"], manifest["t"], manifest["notes"], tuple(damaged))
            if not (short := _cut_short(Path(run_dir), one)):
                return one
            unreached = unreached or one
            damaged.append(f"{folder} is newer than the end of {', '.join(short)}")
            continue
        damaged.append(f"{folder} is damaged ({', '.join(spoiled)})")
    if unreached is not None:
        return unreached
    if damaged:
        raise BadInput(f"No checkpoint of {run_dir} can be gone on from: {'; '.join(damaged)}. {AGAIN}")
    raise BadInput(
        f"{run_dir} holds no complete checkpoint to go on from: it is not the directory of a run, or its run was over "
        f"before the first one. {AGAIN}"
    )


def _cut_short(run_dir: Path, last: Checkpoint) -> list[str]:
    """Tables of a run that hold less than they did at the checkpoint `last`; those that are gone are told of later."""
    rows = {"probes.csv": last.notes.get("probe_rows", 0)}
    if len(last.notes.get("threads", ())) > 1:  # of two sides
        rows["ledger.csv"] = last.window
    there = {name: count for name, count in rows.items() if (run_dir / name).is_file()}
    return [name for name, count in there.items() if (run_dir / name).read_bytes().count(b"\n") < 1 + count]


def _spoiled(folder: Path) -> list[str]:
    """Files of a sealed checkpoint that are gone or not as they were written."""
    try:
        manifest = json.loads((folder / _MANIFEST).read_text())
        sum_ = manifest.pop("sum", None)  # earlier versions had none
        notes = {name: note for name, note in manifest["notes"].items() if name in _NOTES}
        right = _are(manifest, _KINDS) and _are(notes, {name: _NOTES[name] for name in notes})
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return [_MANIFEST]
    if not right or (sum_ is not None and _sum(manifest) != sum_):
        return [_MANIFEST]
    return [name for name, written in manifest["parts"].items() if not _stands(folder / name, written)]


def _are(values: Mapping[str, Any], kinds: Mapping[str, Any]) -> bool:
    return all(isinstance(values[name], kind) for name, kind in kinds.items())


def _stands(path: Path, checksum: str) -> bool:
    try:
        return _checksum(path) == checksum
    except OSError:
        return False


def way_on(run_dir: Path) -> str:
    """The command that goes on with a run that was cut short; empty where no checkpoint lets it."""
    try:
        last = newest(run_dir)
    except BadInput:
        return ""
    return f"go on from t = {last.time:.4g} s with: coupler resume {shlex.quote(word(run_dir))}"


def _checksum(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _sum(manifest: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(manifest, sort_keys=True).encode()).hexdigest()
