"""What the structure models that are not made of particles need of a scene, and what of it they do not use."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from shared.geometry.regions import SIDES, own_size
from shared.scene.geometry import across, has_shape
from shared.schema.geometry import Shape
from shared.schema.probes import FORCES, MOMENTA, QUANTITIES, REACTIONS, SOLID_ONLY, STRESSES
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS, RIGID_MODELS

LEAST_SLENDER = 3.0  # length over thickness below which a body is no beam
WANTED_SLENDER = 5.0  # below it, shear and the clamps' neighbourhood rule, which a beam only sketches
_SLACK = 1.0 - 1e-9  # 0.12 over 0.04 is a little below 3
LEAST_ROWS = 2  # rows of interface points across a beam that let a fluid's ghosts follow its rotation

_MOTION = ("displacement-x", "displacement-y", "kinetic-energy", "max-speed", *MOMENTA)
_BALANCE = ("strain-energy", "external-work", "dissipated", *REACTIONS)
_EXPRESSED = {
    "rigid": _MOTION,
    "spring": (*_MOTION, *_BALANCE),
    "beam": (*_MOTION, *_BALANCE, *STRESSES, "spacing-max"),
}
"""What models that are not made of particles can say; the others say everything."""

_EXPRESSED_BY_WATER = {"still": ("pressure", "level"), "column": ("pressure",)}
"""What fluids that are not made of particles can say besides forces on solids; other probes they leave out."""

_BY_FORCES = ("external-work", "dissipated", *REACTIONS)

_AXIS = {face: axis for face, (axis, _) in SIDES.items()}


def slenderness(shape: Shape) -> tuple[float, int]:
    """Length over thickness of a rectangle, and the axis of its length (0 or 1)."""
    width, height = own_size(shape)
    return float(max(width, height) / min(width, height)), int(height > width)


def _beams(scene: Scene) -> Iterator[str]:
    """Bodies of model beam are slender rectangles, held at their ends, with points enough for a fluid."""
    solid = scene.solid
    if solid is None or solid.model != "beam":
        return
    for i, body in enumerate(solid.bodies or []):
        if not has_shape(body):
            continue
        path = f"solid.bodies[{i}]"
        if body.rectangle is None:
            yield f"{path}: model beam needs a rectangle; use model total-lagrangian for other shapes"
            continue
        ratio, axis = slenderness(body)
        if ratio < LEAST_SLENDER * _SLACK:
            yield (
                f"{path}.rectangle: {ratio:.3g} times as long as thick; model beam needs {LEAST_SLENDER:g} or more, "
                "model total-lagrangian takes any shape"
            )
        if scene.fluid is not None and solid.dx is not None and across(body, solid.dx) < LEAST_ROWS:
            yield (
                f"solid.dx = {solid.dx:g}: one row of points across '{body.name}' cannot tell a fluid how it turns; "
                "make it at most half the thickness"
            )
        for k, clamp in enumerate(solid.clamps or []):
            if clamp.body == body.name and _AXIS.get(clamp.face, axis) != axis:
                ends = " or ".join(name for name, of in _AXIS.items() if of == axis)
                yield f'solid.clamps[{k}].face = "{clamp.face}": model beam is held at its ends, {ends}'


def _motion(scene: Scene) -> Iterator[str]:
    solid = scene.solid
    if solid is None or solid.motion is None or solid.model is None:
        return
    if solid.model not in ("rigid", *PARTICLE_MODELS):
        yield f"solid.motion: is for models rigid, total-lagrangian, ctvf, not for model {solid.model}"
    elif solid.model in PARTICLE_MODELS:
        if solid.clamps:
            yield f"solid.clamps: model {solid.model} under solid.motion is carried as a whole; leave the clamps out"
        if scene.fluid is not None:
            yield f"solid.motion: with a fluid it is for model rigid, not for model {solid.model}"


def _moving_clamps(scene: Scene) -> Iterator[str]:
    """Clamps that follow a motion table."""
    solid = scene.solid
    if solid is None or solid.model is None:
        return
    moving = {clamp.body for clamp in solid.clamps or [] if clamp.motion is not None}
    for i, clamp in enumerate(solid.clamps or []):
        if clamp.motion is None:
            continue
        path = f"solid.clamps[{i}].motion"
        if solid.model in RIGID_MODELS:
            yield f"{path}: bodies of model {solid.model} have no clamps that move; use solid.motion with model rigid"
        shift, angle = clamp.motion.translation, clamp.motion.rotation
        if (shift and tuple(shift[0]) != (0.0, 0.0)) or (angle and angle[0] != 0.0):
            yield f"{path}: starts displaced, which would tear the body; begin with translation (0, 0) and rotation 0"
    for i, probe in enumerate(scene.probes):
        if probe.body in moving and probe.quantity == "dissipated":
            yield f"probes[{i}].quantity: the work of moving clamps is not kept, so what is dissipated is not known"


def _quantities(scene: Scene) -> Iterator[str]:
    """Probes that the model cannot express."""
    solid = scene.solid
    if solid is None or solid.model is None:
        return
    bodies = {body.name for body in solid.bodies or []}
    for i, probe in enumerate(scene.probes):
        if probe.body not in bodies:
            continue
        path = f'probes[{i}].quantity = "{probe.quantity}"'
        known = _EXPRESSED.get(solid.model)
        if known is not None and probe.quantity in SOLID_ONLY and probe.quantity not in known:
            yield f"{path}: model {solid.model} only knows {', '.join(known)}; total-lagrangian and ctvf know all"
        elif solid.motion is not None and probe.quantity in _BY_FORCES:
            yield f"{path}: the motion is prescribed, so no forces are computed; leave it out"


def _unknown_to_water(scene: Scene) -> Iterator[tuple[int, str]]:
    """Number of each probe that the fluid's model leaves out, and the sentence that says so, less its end."""
    fluid = scene.fluid
    known = _EXPRESSED_BY_WATER.get(fluid.model) if fluid is not None else None
    bodies = {body.name for body in scene.solid.bodies or []} if scene.solid is not None else ()
    for i, probe in enumerate(scene.probes if known is not None else []):
        if probe.body not in bodies and probe.quantity in QUANTITIES and probe.quantity not in known:
            of = "walls" if probe.quantity in FORCES else "water"
            yield (
                i,
                f"{probe.quantity} of {of} is nothing that model {fluid.model} knows (it knows {', '.join(known)} and "
                "the force on a structure)",
            )


def _goals(scene: Scene) -> Iterator[str]:
    """A goal that the fluid's model leaves out."""
    for i, what in _unknown_to_water(scene):
        if scene.goal is not None and scene.probes[i].name == scene.goal.probe:
            yield f'goal.probe = "{scene.goal.probe}": {what}; use model wcsph or ctvf, or another goal'


def _left_out(scene: Scene) -> Iterator[str]:
    """Probes that the fluid's model leaves out."""
    for i, what in _unknown_to_water(scene):
        name = scene.probes[i].name
        yield f"probes[{i}]: '{name}' will have no value: {what}; use model wcsph or ctvf, or leave it out"


def _starts(scene: Scene) -> Iterator[str]:
    """Initial states that a body or the model cannot take."""
    solid = scene.solid
    if solid is None or solid.model is None:
        return
    clamped = {clamp.body for clamp in solid.clamps or []}
    for i, body in enumerate(solid.bodies or []):
        path = f"solid.bodies[{i}]"
        if body.prestrain and any(body.prestrain):
            if solid.model not in PARTICLE_MODELS:
                yield f"{path}.prestrain: for models total-lagrangian and ctvf, not for model {solid.model}"
            elif body.name in clamped:
                yield f"{path}.prestrain: body '{body.name}' is clamped, so it cannot start stretched; use loads"
        if body.velocity_mode is not None:
            if solid.model in RIGID_MODELS:
                yield f"{path}.velocity_mode: bodies of model {solid.model} do not bend"
            if has_shape(body) and body.rectangle is None:
                yield f"{path}.velocity_mode: needs a rectangle"
            elif has_shape(body) and body.velocity_mode.clamped is not None:
                ratio, axis = slenderness(body)
                if _AXIS[body.velocity_mode.clamped] != axis:
                    ends = " or ".join(name for name, of in _AXIS.items() if of == axis)
                    yield (
                        f'{path}.velocity_mode.clamped = "{body.velocity_mode.clamped}": a long face of body '
                        f"'{body.name}', {ratio:.3g} times as long as thick; allowed: {ends}"
                    )
        if body.spin and solid.model == "rigid":
            yield f"{path}.spin: bodies of model rigid move by solid.motion"


def _following(scene: Scene) -> Iterator[str]:
    solid = scene.solid
    if solid is None or solid.model in (None, *PARTICLE_MODELS):
        return
    for i, load in enumerate(solid.loads or []):
        if load.following:
            yield f"solid.loads[{i}].following: for models total-lagrangian and ctvf, not for model {solid.model}"


def _unused(scene: Scene) -> Iterator[str]:
    solid = scene.solid
    if solid is None:
        return
    held_by_spring = any(solid.spring.stiffness) or any(solid.spring.damping)
    if held_by_spring and solid.model != "spring":
        yield f"solid.spring: has no effect with model {solid.model}"
    if solid.clamps and (solid.model == "spring" or solid.motion is not None):
        mover = "spring" if solid.motion is None else "motion"
        yield f"solid.clamps: have no effect with model {solid.model}, which solid.{mover} moves"
    if solid.model == "rigid":
        if solid.loads:
            yield "solid.loads: have no effect with model rigid"
        if any(body.velocity != (0.0, 0.0) for body in solid.bodies):
            yield "solid.bodies: initial velocities have no effect with model rigid; use solid.motion"
    elif solid.model == "beam":
        for i, body in enumerate(solid.bodies):
            ratio, _ = slenderness(body)
            if ratio < WANTED_SLENDER * _SLACK:
                wrong = f"solid.bodies[{i}]: '{body.name}' is {ratio:.3g} times as long as thick"
                yield f"{wrong}; model beam wants {WANTED_SLENDER:g}"


MODEL_CHECKS: tuple[Callable[[Scene], Iterator[str]], ...] = (
    _beams,
    _motion,
    _moving_clamps,
    _quantities,
    _goals,
    _starts,
    _following,
)
MODEL_WARNINGS: tuple[Callable[[Scene], Iterator[str]], ...] = (_unused, _left_out)
