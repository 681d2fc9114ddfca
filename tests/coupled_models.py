"""Two models coupled in one process, without a run directory: for tests of schemes on small models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coupler.choice import make_taker
from coupler.ledger import Ledger
from coupler.mapping import build_mapping
from coupler.prediction import Predictor
from coupler.remote import Remote
from coupler.schemes import Coupled, Outcome
from coupler.window import Plan, make_plan, mass_ratio
from fluid_solver.models import make_model as make_fluid
from shared.clock import Clock
from shared.contract import Model
from shared.face_loads import FaceLoads
from shared.link import InProcessLink
from shared.participant import Participant, own_faces
from shared.scene.reading import load_scene
from shared.schema.coupling import Coupling
from shared.schema.scene import Scene
from shared.service import Service
from solid_solver.models import make_model as make_solid


@dataclass
class History:
    """`times` (n + 1,) [s]; `points` (n + 1,): mean displacement of the structure's points along an axis; every
    window's outcome; the plan."""

    times: np.ndarray
    points: np.ndarray
    outcomes: list[Outcome]
    plan: Plan | None = None


def join(fluid: Model, structure: Model, clock: Clock, order: int, faces: FaceLoads | None = None) -> Coupled:
    """Both models at t = 0, over the in-process link; `faces`: what the structure integrates pressures over."""
    remotes = [
        Remote(
            InProcessLink(Service(Participant(model, name, faces=faces if name == "solid" else None), "test").handle),
            "test",
            name,
        )
        for name, model in (("fluid", fluid), ("solid", structure))
    ]
    ghosts, points = remotes[0].describe(), remotes[1].describe()
    mapping = build_mapping(points, ghosts)
    options = {"rollback": True, "frames": 1, "probe_rows": 1}
    motion, _ = remotes[1].start(clock, mapping.selection, **options)
    wall = mapping.motion(motion)
    loads, _ = remotes[0].start(clock, range(len(ghosts.position)), wall, **options)
    return Coupled(
        *remotes, mapping, motion, wall, Predictor(order, mapping.loads(loads, motion, wall)), Predictor(order, motion)
    )


def march(c: Coupled, take, clock: Clock, windows: int, along=(1.0, 0.0), ledger: Ledger | None = None) -> History:
    """Take `windows` windows."""
    outcomes, places, times = [], [c.points.position], [0.0]
    for window in map(clock.window, range(windows)):
        outcomes.append(take(c, window))
        if ledger is not None and take.heed(window, ledger.record(window, outcomes[-1])):
            ledger.excuse()
        places.append(c.points.position)
        times.append(window.t1)
    moved = (np.array(places) - places[0]).mean(axis=1) @ np.array(along)
    return History(np.array(times), moved, outcomes)


def couple(scene: Scene, windows: int | None = None, along=(1.0, 0.0), ledger: Ledger | None = None) -> History:
    """Run the scene's two models for `windows` windows, or to the scene's end."""
    fluid, structure = make_fluid(scene, True, 1), make_solid(scene, True, 1)
    points = structure.describe()
    plan = make_plan(scene.coupling, fluid.describe(), points, mass_ratio(scene, points))
    clock = Clock.fitting(scene.end_time, plan.window)
    c = join(fluid, structure, clock, scene.coupling.predictor, own_faces(scene, structure))
    history = march(c, make_taker(plan, scene.coupling), clock, windows or clock.count, along, ledger)
    history.plan = plan
    return history


def couple_models(fluid: Model, structure: Model, clock: Clock, coupling: Coupling, along=(1.0, 0.0), ledger=None):
    """The same for two models made by the test; the scheme is the one that `coupling` names."""
    c = join(fluid, structure, clock, coupling.predictor)
    plan = Plan(coupling.scheme, clock.window_length)
    return march(c, make_taker(plan, coupling), clock, clock.count, along, ledger)


def piston(sets: Sequence[str] = (), **coupling) -> Scene:
    """The shipped piston with changes; `coupling`: keys of its table."""
    keys = [f"coupling.{name}={value}" for name, value in coupling.items()]
    return load_scene("piston", ["references=[]", *keys, *sets])
