"""Fluids of particles in small scenes, and access to their state, for their tests."""

from __future__ import annotations

import numpy as np

from fluid_solver.models import make_model
from shared.contract import Kinematics
from shared.schema.scene import Scene

G = 9.81


def scene(bodies, walls=(), gravity=(0.0, -G), solid=None, probes=(), **fluid) -> Scene:
    """A scene of water, `wcsph` at dx = 0.01 m unless `fluid` says otherwise."""
    given = {"model": "wcsph", "dx": 0.01, "bodies": bodies} | fluid
    table = {"schema": 1, "title": "test", "end_time": 1.0, "gravity": gravity, "fluid": given, "walls": list(walls)}
    if solid is not None:
        table["solid"] = solid
    return Scene.model_validate(table | {"probes": list(probes)})


def tank(width=0.2, height=0.2, fill=0.15, **fluid) -> Scene:
    """Water at rest in an open tank, sizes in m, with probes of pressure, level and weight."""
    wall = {"name": "tank", "polyline": [(0.0, height), (0.0, 0.0), (width, 0.0), (width, height)]}
    if fluid.get("viscosity"):
        wall["slip"] = "no"
    probes = [{"name": "bottom", "quantity": "pressure", "point": (width / 2, 0.0)}]
    probes += [{"name": name, "quantity": name} for name in ("leaked", "kinetic-energy", "level")]
    probes.append({"name": "weight", "quantity": "force-y", "body": "tank"})
    return scene([{"name": "water", "rectangle": (0.0, 0.0, width, fill)}], [wall], probes=probes, **fluid)


def begun(case: Scene, threads=1, coupled=False):
    """The scene's fluid at t = 0, a structure in it at rest."""
    model = make_model(case, coupled, threads)
    motion = Kinematics.at_rest(model.describe().position) if coupled else None
    model.begin(motion)
    return model


def run(model, time, windows=4, start=0.0):
    """Step a fluid on by `time` [s] in windows."""
    for k in range(windows):
        t0, t1 = start + time * k / windows, start + time * (k + 1) / windows
        model.advance(t0, t1, max(1, int(np.ceil((t1 - t0) / model.stable_step()))), None)
        model.check()


def fluid_rows(model, *rows):
    """Rows of the state (rows, n) of the water, in its first order."""
    return model.store.in_order_of_ids(list(rows), 0, model.fluid_count)


def everything(model):
    """A copy of all that a model's future depends on."""
    return {name: array.copy() for name, array in model.state().items()}


def dam(model_name, dx=0.01) -> Scene:
    """A column of water that falls over a dry floor."""
    wall = {"name": "tank", "polyline": [(0.0, 0.6), (0.0, 0.0), (0.5, 0.0), (0.5, 0.6)]}
    water = [{"name": "water", "rectangle": (0.0, 0.0, 0.15, 0.3)}]
    return scene(water, [wall], model=model_name, dx=dx)
