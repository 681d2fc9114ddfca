"""The ladder of model pairs for a scene's goal: what each would cost, how well it would do, and which is the smallest.

For each pair the coarsest resolution is sought whose error bound (bounds/error.py) meets the goal, without particles no
coarser than the scene's; the smallest pair is the one of least expected cost on the table's machine (cost.py), so that
nothing timed decides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from coupler.preflight.bounds.error import FACES, Parts, drifting, error_parts, stirred
from coupler.preflight.bounds.flow import MOTIONS, lids
from coupler.preflight.bounds.ploughed import ploughed
from coupler.preflight.bounds.shaken import SHAKEN, why_unknown
from coupler.preflight.bounds.solid import not_bounded
from coupler.preflight.bounds.swings import PHASE, SWING, about_nothing
from coupler.preflight.bounds.waves import torn
from coupler.preflight.cost import Cost, predicted_cost
from coupler.preflight.finding import STEADY
from coupler.preflight.measures.afloat import afloat
from coupler.preflight.measures.numbers import Numbers, scene_numbers
from coupler.preflight.measures.plate import goals_probe, goals_quantity, of_a_body, plates_body
from coupler.preflight.measures.shapes import CROWDED, crowding
from coupler.preflight.measures.water import LEVEL, measure_water
from coupler.preflight.measures.window import GROWTH_WARN, lag_growth
from coupler.preflight.rules.findings import findings
from coupler.preflight.rules.joint import helmholtz
from coupler.preflight.variations import bends_at_points, coupled, dampings, fits, has_particles, refined, with_models
from shared.scene.checks import check_scene
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS

Standing = Literal["smallest", "enough", "not enough", "cannot"]

FLUIDS = ("still", "column", "wcsph", "ctvf")
SOLIDS = ("rigid", "spring", "beam", "total-lagrangian", "ctvf")
"""Both sides' rungs, the smallest first."""

REFINEMENTS = (2.0, 1.5, 1.25, 1.0, 0.8, 2 / 3, 0.5, 0.4, 1 / 3, 0.25, 0.2, 1 / 6, 0.125, 0.1, 0.075, 0.05, 0.025)
"""Spacings tried, over the scene's own."""
FINER = tuple(factor for factor in REFINEMENTS if 0.1 <= factor <= 1.0)
"""The same where the spacing is that of pressures on a plate that bends."""

NEAR, DEAR = 1.5, 10.0  # bound over the goal's error, and cost over its own, that make a near miss worth naming
LONGEST = 3600.0
"""Core-seconds, on the table's machine, that are not begun unless asked for."""
_RIGID_SHARE = 10.0  # error of the flow per deflection over depth, when an elastic body is held rigid


@dataclass(frozen=True)
class Rung:
    """One pair at one resolution: `sets` make it from the scene; `error` bounds the goal's, made of `parts`."""

    fluid: str | None
    solid: str | None
    standing: Standing
    reason: str
    scene: Scene = field(repr=False)
    sets: tuple[str, ...] = ()
    error: float = math.inf
    parts: Parts = field(default_factory=dict)
    cost: Cost | None = None

    @property
    def name(self) -> str:
        """Both models in words."""
        return " + ".join(filter(None, (self.fluid, self.solid)))


def ladder(scene: Scene) -> list[Rung]:
    """All pairs for the scene's goal, the smallest first; the one to take has standing "smallest"."""
    if scene.goal is None:
        return []
    fluids, solids = ({model: _cannot(scene, side, model) for model in known} for side, known in _rungs(scene))
    rungs = [_rung(scene, fluid, solid, fluids[fluid] or solids[solid]) for fluid in fluids for solid in solids]
    enough = [rung for rung in rungs if rung.standing == "enough"]
    if not enough:
        return rungs
    best = min(enough, key=lambda rung: rung.cost.core_s)
    return [_placed(rung, best) for rung in rungs]


def smallest(rungs: list[Rung]) -> Rung | None:
    """The rung to take, if any is enough."""
    return next((rung for rung in rungs if rung.standing == "smallest"), None)


def near_miss(rungs: list[Rung]) -> Rung | None:
    """The cheapest pair that just misses the goal, where the smallest that meets it costs ten times as much."""
    best = smallest(rungs)
    if best is None:
        return None
    near = [r for r in rungs if r.standing == "not enough" and r.error <= NEAR * r.scene.goal.error]
    return min((r for r in near if DEAR * r.cost.core_s < best.cost.core_s), key=lambda r: r.cost.core_s, default=None)


def _placed(rung: Rung, best: Rung) -> Rung:
    """The rung with its reason, seen from the best one."""
    if rung.standing != "enough":
        return rung
    if rung is best:
        return replace(rung, standing="smallest", reason=f"bound {_percent(rung.error)} at the least cost")
    more = (rung.cost.core_s - rung.cost.start_s) / max(best.cost.core_s - best.cost.start_s, 1e-9)
    return replace(rung, reason=f"not needed: {more:.3g} times the stepping of {best.name}")


def _rungs(scene: Scene) -> tuple[tuple[str, list], tuple[str, list]]:
    """The models to try on each side; None alone for a side that is absent."""
    fluids, solids = [None], [None]
    if scene.fluid is not None:
        fluids = list(FLUIDS)
    if scene.solid is not None and scene.solid.model in RIGID_MODELS:
        solids = [scene.solid.model]
    elif scene.solid is not None:
        solids = list(SOLIDS)
    return ("fluid", fluids), ("solid", solids)


def _rung(scene: Scene, fluid: str | None, solid: str | None, why: str) -> Rung:
    """The pair at the coarsest resolution that meets the goal, or `why` it cannot."""
    base, sets = with_models(scene, fluid, solid)
    if why:
        return Rung(fluid, solid, "cannot", why, base, sets)
    best: Rung | None = None
    for factor in REFINEMENTS if has_particles(base) else FINER if bends_at_points(base) else (1.0,):
        tried, spacing = refined(base, factor)
        numbers = scene_numbers(tried)
        if factor != 1.0 and not (fits(numbers) and _no_more_crowded(tried, base)):
            continue
        judged = []
        for damped, damping in dampings(tried, numbers):
            joined, coupling = coupled(damped)
            told = (*sets, *coupling, *spacing, *damping)
            last = {text.partition("=")[0]: text for text in told}  # a spacing may be refined again
            judged.append(_judged(joined, fluid, solid, tuple(last.values())))
        enough = [rung for rung in judged if rung.standing == "enough"]
        if enough:
            judged = [_startable(min(enough, key=lambda rung: rung.cost.core_s))]
            if judged[0].standing == "enough":
                return judged[0]
        best = min([best, *judged] if best else judged, key=lambda rung: rung.error)
    return best


def _no_more_crowded(scene: Scene, base: Scene) -> bool:
    """Whether particles of a fluid fit the gaps of its bodies, or no worse than at the scene's own spacing."""
    if scene.fluid is None or scene.fluid.model not in PARTICLE_FLUIDS:
        return True
    worst, own = (max(crowding(body, one.fluid.dx) for body in one.fluid.bodies) for one in (scene, base))
    return worst <= max(CROWDED, own)


def _startable(rung: Rung) -> Rung:
    """The rung, if a run of it would find no mistake as it starts. What takes hours is not looked at: laying its
    particles takes long too."""
    wrong = _mistake(rung.scene) if rung.cost.core_s < LONGEST else ""
    return replace(rung, standing="cannot", reason=wrong) if wrong else rung


def _judged(scene: Scene, fluid: str | None, solid: str | None, sets: tuple[str, ...]) -> Rung:
    numbers = scene_numbers(scene)
    parts = error_parts(scene, numbers)
    if scene.solid is not None and scene.solid.model == "rigid" and numbers.joint is not None:
        parts["held rigid"] = _held_rigid(scene, numbers)
    error, goal = sum(parts.values()), scene.goal.error
    standing, reason = "enough", ""
    if error > goal:
        standing = "not enough"
        worst = max(parts, key=parts.get)
        if math.isinf(error):
            reason = _unable(scene, numbers, worst)
        else:
            reason = f"bound {_percent(error)} above the goal's {_percent(goal)}, most of it by {worst}"
            reason += ", which a longer end_time averages out" if worst == SWING else ""
    elif wrong := _refusal(scene, numbers):
        standing, reason = "cannot", wrong
    return Rung(fluid, solid, standing, reason, scene, sets, error, parts, predicted_cost(scene, numbers))


def _unable(scene: Scene, n: Numbers, worst: str) -> str:
    """Why a pair has no bound at all."""
    what = scene.goal.statistic
    if worst == FACES:
        return "a body with water round it integrates pressures whose net is a small difference; coupling.loads = force"
    if worst == SHAKEN:
        return why_unknown(scene, n)
    if n.water is not None and worst.startswith("fluid"):
        if drifting(scene, n):
            return "nothing holds the body in the water, where drag decides how far it goes: give it springs"
        if n.water.model in PARTICLE_FLUIDS and n.water.bottomless > 0.0:
            return "the water falls away: under some of it there is nothing"
        if n.water.model in PARTICLE_FLUIDS:
            found = helmholtz(scene, n)
            if found is not None and found.verdict == "refuse":
                return f"the low sound speed cannot resolve a {what}: {found.reason}"
            if n.water.rests and goals_quantity(scene) in MOTIONS:
                return "the water rests: of a motion that is nothing there is no relative error"
            if stirred(scene, n):
                return "rows of particles do not fit between the faces, which stirs water at rest: see filled gaps"
            if torn(scene, n):
                return "tension clumps particles at the waterline of walls: see h/dx; ctvf keeps them apart"
            if n.water.waves and what in ("change", "decay", "wave-decay") and scene.fluid.viscosity == 0.0:
                return "nothing of the water's own wears its waves out: what decays is the method's alone"
            if ploughed(scene):
                return "particles that nothing shifts are pressed into what is moved through them; ctvf shifts them"
            if lids(scene):
                return "a lid slides beside walls that stand: its flow is known of ctvf, 25 dx across, from Re 100 on"
            return "what is left of the value is too little for a bound of its relative error"
        if n.plate is not None and afloat(scene, plates_body(scene, n.plate)):
            return f"the body floats: the windows of {n.water.model} do not follow its heave"
        if not any(scene.gravity) and n.water.model == "still":
            return "water at rest without weight presses on nothing"
        if not n.water.held:
            return "nothing holds the water on some side, so it flows away; if it is to rest, add [[walls]] there"
        if not n.water.rests:
            sloped = n.water.slope > LEVEL * n.water.dx
            return f"the water does not rest: {'its surface is not level' if sloped else 'it moves, or is moved'}"
        if n.water.boxed and n.joint is not None and n.joint.closes:
            return (
                f"the plate closes a box of water, whose pressure comes from being squeezed; {n.water.model} has none"
            )
        if n.water.model == "column" and n.joint.parts:
            return "beside an upright plate water gives way upward, to its surface, and not along columns"
        if lag_growth(scene, n) > math.log(GROWTH_WARN):
            return "lagged exchange makes a swing on the column grow until the end: see window α"
        if what not in STEADY:
            return f"a {what} feels the mass of the water that moves along, which {n.water.model} leaves out"
    if worst == SWING and about_nothing(scene, n):
        return "it swings about nothing, of whose mean there is no relative error: judge a peak or a period"
    if worst == PHASE:
        return (
            "by the end the phase of the swing is not known to a radian, or its value is next to nothing: it may "
            "be anything: judge a peak or a mean, end earlier, or damp it (solid.damping)"
        )
    return not_bounded(scene, n) or f"{worst} does not express the goal"


def _cannot(scene: Scene, side: str, model: str | None) -> str:
    """Why a model cannot express its side of the scene at all; empty if it can."""
    solid = scene.solid
    held = side == "solid" and model in RIGID_MODELS and solid.model not in RIGID_MODELS
    if held and (goals_probe(scene) is None or of_a_body(scene)):
        return "the goal is how an elastic body deforms"
    if held and model == "spring":
        return "the scene has no springs to hold a rigid body by"
    if model in ("still", "column") and solid is None:
        return f"model {model} is water on a structure, and there is none"
    changed, _ = with_models(scene, *((model, None) if side == "fluid" else (None, model)))
    if (
        side == "fluid"
        and model in PARTICLE_FLUIDS
        and scene.fluid.model == "column"
        and not measure_water(changed).held
    ):
        return "columns stand without walls, particles fall: nothing holds the water; add [[walls]] around it"
    return _mistake(changed)


def _mistake(scene: Scene) -> str:
    """The first mistake of a scene, in one line; empty without."""
    return next((mistake.replace("\n", " ") for mistake in check_scene(scene)), "")


def _refusal(scene: Scene, n: Numbers) -> str:
    """The first of pre-flight's own refusals; empty without."""
    refused = (found for found in findings(scene, n) if found.verdict == "refuse")
    return next((f"{found.rule} = {found.value:.3g}: {found.reason}" for found in refused), "")


def _held_rigid(scene: Scene, n: Numbers) -> float:
    """Error of a flow by holding an elastic body rigid; nothing is right in a box that it closes."""
    if n.water.boxed and n.joint.closes:
        return math.inf
    if scene.solid.youngs_modulus is None:  # nothing else was ever meant
        return 0.0
    elastic = scene_numbers(scene.model_copy(update={"solid": scene.solid.model_copy(update={"model": "beam"})}))
    bent = elastic.plate.deflection if elastic.plate.deflection is not None else 0.0
    return _RIGID_SHARE * bent / n.joint.depth


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"
