"""Compiled code is made by a process of its own and only ever *run* from the cache.

A process that compiles a kernel and one that loads it from the cache bind some of its inner calls to different copies,
and copies differ in the last bit. So that the first run of a scene gives the same bytes as the second, a child process
takes the model through one tiny step, which fills the cache; then the run begins. A model whose sweeps over pairs take
as long to compile as the rest of its step has a second child for them.
"""

from __future__ import annotations

import errno
import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numba
import numpy as np

from shared.awake import wait_for
from shared.contract import Kinematics, Loads, Model, ShearwaterError
from shared.run.words import word
from shared.scene.sides import own_probes
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.scene import Scene

_TINY_STEPS = 2
_PLACE = str(Path(__file__).resolve().parent)  # numba keeps what it compiles of the same sources elsewhere apart
_ROOM = 1 << 22  # bytes, what the kernels of a scene need
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # disk, quota, limit of the shell
_FLAGS = ("model", "kernel", "gradient", "shifting")  # keys that choose kernels by their value
_PRESENCE = ("viscosity", "alpha", "damping", "loads", "spring", "motion")  # keys that choose them by being there


def stamp(scene: Scene, side: str) -> Path:
    """File that says that the kernels of this side of such a scene are in the cache."""
    part = getattr(scene, side)
    choice = [_PLACE, side, *(getattr(part, key, None) for key in _FLAGS)]
    choice += [bool(getattr(part, key, 0)) for key in _PRESENCE]
    choice += sorted({(wall.slip, wall.motion is not None) for wall in scene.walls})
    choice += sorted({probe.quantity for probe in own_probes(scene, side).probes})
    name = hashlib.sha256(repr(choice).encode()).hexdigest()[:16]
    return Path(numba.config.CACHE_DIR) / f"warm-{side}-{name}"


def fill_cache(packages: Mapping[str, str], case: Path, scene: Scene) -> None:
    """Compile what is missing for each side's package, in child processes side by side; `case` is the scene's file.

    A child that fails says nothing here: the run itself will meet the same error and report it. Raises ParticipantLost
    where one is stopped, ShearwaterError where there is no room for what they make.
    """
    parts = {}
    for side, package in packages.items():
        if not stamp(scene, side).exists():
            parts[f"compiles the {side} side"] = [package, "warm", word(case)]
            if side == "fluid" and scene.fluid.model in PARTICLE_FLUIDS:  # have `compile_sweeps`
                parts[f"compiles the {side} side's sweeps"] = [package, "warm", word(case), "--sweeps"]
    if parts:
        _try_room()
    children = {
        name: subprocess.Popen(
            [sys.executable, "-m", *part, "--parent", str(os.getpid())],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for name, part in parts.items()
    }
    try:
        wait_for(children)
    finally:
        for child in children.values():
            child.kill()
            child.wait()


def _try_room() -> None:
    """See that the disk of the cache is not full."""
    folder = Path(numba.config.CACHE_DIR)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(bytes(_ROOM))
    except OSError as error:
        if error.errno in _FULL:
            raise ShearwaterError(
                f"There is no room for compiled code in {folder} ({error}): free some space on that disk, or name a "
                "folder on another by the environment variable NUMBA_CACHE_DIR."
            ) from None


def take_a_tiny_step(model: Model, scene: Scene, side: str) -> None:
    """Call everything that a run calls of `model`, then leave the stamp."""
    try:
        places = model.describe().position
        fluid = model.role == "fluid"
        boundary = Kinematics.at_rest(places) if fluid else Loads.zero(len(places))
        model.begin(boundary if fluid else None)
        step = 1e-3 * model.stable_step()
        for window in range(2):
            model.advance(window * step, (window + 1) * step, _TINY_STEPS, boundary)
        model.check()
        model.probe_values()
        model.frame()
        model.restore({name: np.copy(array) for name, array in model.state().items()})
    except ShearwaterError:
        return
    place = stamp(scene, side)
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(f"{os.getpid()}\n")
