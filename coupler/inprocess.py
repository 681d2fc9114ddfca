"""Both participants in the coupler's own process: for tests and for debugging.

The coupler knows the solvers by the names of their packages only, as it does when it starts them as processes.
"""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Iterator
from pathlib import Path

from coupler.remote import Remote
from coupler.supervisor import PACKAGES
from shared.contract import Model
from shared.link import InProcessLink
from shared.participant import Participant, own_faces
from shared.scene.sides import own_probes
from shared.schema.scene import Scene
from shared.service import Service


def side_model(scene: Scene, side: str, coupled: bool, threads: int) -> Model:
    """The model of one side of `scene`, "fluid" or "solid"."""
    make_model = importlib.import_module(f"{PACKAGES[side]}.models").make_model
    return make_model(own_probes(scene, side), coupled, threads)


@contextlib.contextmanager
def inprocess_sides(scene: Scene, threads: dict[str, int], run: str, run_dir: Path) -> Iterator[dict[str, Remote]]:
    """The two participants of `scene` as remotes named "fluid" and "solid", over the in-process link."""
    with contextlib.ExitStack() as stack:
        remotes = {}
        for name in PACKAGES:
            model = side_model(scene, name, True, threads[name])
            participant = Participant(model, name, run_dir / f"{name}.vtkhdf", own_faces(scene, model))
            stack.callback(participant.close)
            remotes[name] = Remote(InProcessLink(Service(participant, run).handle), run, name)
        yield remotes
