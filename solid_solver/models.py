"""The solid's models by name."""

from __future__ import annotations

from shared.contract import Model
from shared.schema.scene import Scene
from solid_solver.beam import BeamModel
from solid_solver.rigid import Rigid
from solid_solver.rigid_spring import SpringModel
from solid_solver.total_lagrangian import TotalLagrangian
from solid_solver.updated_lagrangian import UpdatedLagrangian

MODELS = {
    "total-lagrangian": TotalLagrangian,
    "ctvf": UpdatedLagrangian,
    "beam": BeamModel,
    "rigid": Rigid,
    "spring": SpringModel,
}
"""A new model is one new file and one entry here."""


def make_model(scene: Scene, coupled: bool, threads: int) -> Model:
    """The model that `scene.solid.model` names; `coupled`: a fluid's loads will come; `threads` to use at most."""
    return MODELS[scene.solid.model](scene, coupled, threads)
