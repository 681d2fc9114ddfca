"""Registry of fluid models."""

from __future__ import annotations

from fluid_solver.column import Columns
from fluid_solver.model import ParticleFluid
from fluid_solver.still import StillWater
from shared.contract import Model
from shared.schema.scene import Scene

MODELS = {"ctvf": ParticleFluid, "wcsph": ParticleFluid, "still": StillWater, "column": Columns}


def make_model(scene: Scene, coupled: bool, threads: int) -> Model:
    """The fluid model that the scene asks for, on `threads` threads."""
    return MODELS[scene.fluid.model](scene, coupled, threads)
