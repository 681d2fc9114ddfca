"""What a scene is varied by for the ladder of models: models, coupling, spacings, damping. Each variation comes with
the `--set` texts that make it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from coupler.preflight.finding import STEADY
from coupler.preflight.measures.numbers import Numbers, scene_numbers
from coupler.preflight.measures.plate import goals_quantity
from coupler.preflight.measures.swing import swing
from coupler.preflight.rules.joint import SUPPORT_WARN
from coupler.preflight.rules.plate import ACROSS_WARN
from coupler.preflight.rules.water import WATER_ACROSS_WARN
from shared.geometry.limbs import thickness_of
from shared.scene.geometry import LEAST_ACROSS, across
from shared.schema.fluid import PARTICLE_FLUIDS, Column
from shared.schema.probes import FORCES, REACTIONS
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS, RIGID_MODELS

Varied = tuple[Scene, tuple[str, ...]]

_ROWS_OF_A_MEAN = 4  # of a structure that has come to rest
_AT_REST = 1e-3  # of a swing, that is rest
_STIFF = 0.03  # deflection over depth: below, water that follows the plate adds so much to its load, window by window
_DAMPING_RATIO = 0.7  # of the first mode, of bending alone: brings a static answer to rest within a period
_LINEAR = ("displacement-x", "displacement-y", "stress-xx", "stress-yy", "stress-xy", *REACTIONS, *FORCES, "pressure")
"""Quantities whose mean over a swing is that of the structure at rest; of energies, speeds and sizes it is another."""


def with_models(scene: Scene, fluid: str | None, solid: str | None) -> Varied:
    """The scene with these models; None: as it is."""
    changes, sets = {}, []
    for side, model in (("fluid", fluid), ("solid", solid)):
        part = getattr(scene, side)
        if model is not None and part.model != model:
            update = {"model": model}
            if model == "ctvf" and side == "solid":
                update["gradient"] = "quadratic"
                sets.append("solid.gradient=quadratic")
            if model == "column" and part.column == Column():  # the water itself carries no slow sound
                update["column"] = Column(compressible=False)
                sets.append("fluid.column.compressible=false")
            if side == "solid" and model in PARTICLE_MODELS and (dx := _resolving(scene)) < part.dx:
                update["dx"] = dx
                sets.append(f"solid.dx={dx:g}")
            changes[side] = part.model_copy(update=update)
            sets.append(f"{side}.model={model}")
    return (scene.model_copy(update=changes) if changes else scene), tuple(sets)


def _resolving(scene: Scene) -> float:
    """The spacing [m] of particles that pre-flight finds enough, where the scene's is too coarse for any."""
    solid = scene.solid
    if all(across(body, solid.dx) >= LEAST_ACROSS for body in solid.bodies):
        return solid.dx
    return float(f"{min(thickness_of(body) for body in solid.bodies) / ACROSS_WARN:.6g}")


def coupled(scene: Scene) -> Varied:
    """The scene with the coupling that its models want, where the scene leaves it to be chosen.

    Water in a box that a plate closes has nowhere to go: its load is found by iteration. Under water at rest a mean
    needs no rows of its own, and only a few windows of a plate that has come to rest.
    """
    n = scene_numbers(scene)
    if n.joint is None or scene.coupling.scheme != "auto" or scene.coupling.window != "auto":
        return scene, ()
    if n.water.model == "still" and _rests(scene, n):
        window = (scene.end_time - scene.output.average_from) / _ROWS_OF_A_MEAN
        update = {"scheme": "serial-explicit", "window": float(f"{window:.3g}")}
    elif n.water.model in PARTICLE_FLUIDS and n.water.boxed and n.joint.closes and n.joint.mass_ratio > 1.0:
        update = {"scheme": "serial-implicit", "acceleration": "iqn-ils"}
    else:
        return scene, ()
    changed = scene.model_copy(update={"coupling": scene.coupling.model_copy(update=update)})
    return changed, tuple(f"coupling.{key}={value}" for key, value in update.items())


def _rests(scene: Scene, n: Numbers) -> bool:
    """Whether under water at rest the goal is a mean over a time in which the plate has come to rest."""
    if scene.goal is None or scene.goal.statistic not in STEADY or scene.end_time <= scene.output.average_from:
        return False
    stiff = n.plate.deflection is None or n.plate.deflection < _STIFF * n.water.height
    swings = swing(scene, n)
    return stiff and (swings is None or swings.left(scene.output.average_from) < _AT_REST)


def has_particles(scene: Scene) -> bool:
    """Whether a side is made of particles, so that its spacing counts."""
    fluid = scene.fluid is not None and scene.fluid.model in PARTICLE_FLUIDS
    return fluid or (scene.solid is not None and scene.solid.model in PARTICLE_MODELS)


def bends_at_points(scene: Scene) -> bool:
    """Whether water without particles presses at points, a spacing apart, on a structure that bends."""
    sides = scene.fluid, scene.solid
    return None not in sides and not has_particles(scene) and scene.solid.model not in RIGID_MODELS


def refined(scene: Scene, factor: float) -> Varied:
    """The scene with the spacings of both sides times `factor`."""
    if factor == 1.0:
        return scene, ()
    changes, sets = {}, []
    for side in ("fluid", "solid"):
        part = getattr(scene, side)
        if part is not None:
            dx = float(f"{part.dx * factor:.4g}")
            changes[side] = part.model_copy(update={"dx": dx})
            sets.append(f"{side}.dx={dx:g}")
    return scene.model_copy(update=changes), tuple(sets)


def fits(n: Numbers) -> bool:
    """Whether a resolution is fine enough for the rules that warn."""
    if n.water is not None and n.water.model in PARTICLE_FLUIDS:
        if n.water.width / n.water.dx < WATER_ACROSS_WARN:
            return False
        if n.plate is not None and n.plate.thinnest / n.water.support < SUPPORT_WARN:
            return False
    least = ACROSS_WARN if n.plate is not None and n.plate.model in PARTICLE_MODELS else 2.0
    return n.plate is None or n.plate.fewest >= least * (1.0 - 1e-9)


def dampings(scene: Scene, n: Numbers) -> Iterator[Varied]:
    """The scene as it is, and damped to rest where the goal is a mean that only the start-up swing disturbs."""
    yield scene, ()
    first = swing(scene, n)
    if goals_quantity(scene) not in _LINEAR:
        return
    flows = n.water is not None and not n.water.rests
    if first is None or flows or scene.goal.statistic not in STEADY:
        return
    if n.plate.model in RIGID_MODELS:  # have dampers of their own
        return
    thin = first.omega * math.sqrt(1.0 + n.plate.sheared)
    damping = float(f"{2.0 * _DAMPING_RATIO * thin * first.moved:.3g}")
    if damping > n.plate.damping and scene.output.average_from > 0.0:
        solid = scene.solid.model_copy(update={"damping": damping})
        yield scene.model_copy(update={"solid": solid}), (f"solid.damping={damping:g}",)
