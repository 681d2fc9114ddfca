"""What the structure publishes: its description, and the motion of its interface points over a window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shared.contract import Description, Kinematics
from shared.elasticity import wave_speed
from shared.geometry.limbs import thickness_of
from shared.geometry.regions import own_size
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS
from solid_solver.filled import FilledBody


def thickness(scene: Scene) -> float:
    """Least thickness of the bodies [m]: of their limbs, or of rigid ones the smaller side of the bounding box in their
    own frames."""
    if scene.solid.model in RIGID_MODELS:
        return min(float(own_size(body).min()) for body in scene.solid.bodies)
    return min(thickness_of(body) for body in scene.solid.bodies)


def describe(scene: Scene, bodies: Sequence[FilledBody], stable_step: float) -> Description:
    """The structure's description: the points of the particle lattice are its interface points."""
    solid = scene.solid
    numbers = {
        "density": solid.density,
        "thickness": thickness(scene),
        "spacing_min": min(float(b.spacing.min()) for b in bodies),
    }
    if solid.model not in RIGID_MODELS:
        numbers |= {
            "wave_speed": wave_speed(solid),
            "youngs_modulus": solid.youngs_modulus,
            "poisson_ratio": solid.poisson_ratio,
        }
    return Description(
        name="solid",
        role="structure",
        model=solid.model,
        stable_step=stable_step,
        spacing=solid.dx,
        position=np.concatenate([b.position for b in bodies]),
        volume=np.concatenate([np.full(len(b.position), b.cell) for b in bodies]),
        body=np.concatenate([np.full(len(b.position), k) for k, b in enumerate(bodies)]),
        numbers=numbers,
    )


def kinematics_over_window(start, end, acceleration: np.ndarray, length: float) -> Kinematics:
    """Motion over a window of `length` [s] from (position, velocity) at its `start` and `end`, each (n, 2)."""
    return Kinematics(
        position=end[0],
        velocity=end[1],
        acceleration=acceleration,
        velocity_mean=(end[0] - start[0]) / length,
        acceleration_mean=(end[1] - start[1]) / length,
    )
