"""Bounds of the structure's part of the error in the scene's goal, relative, and what its swing adds.

Each is measured on cases with a known answer (cases/results/structures.md), with a margin of 1.2 to 2.5 over the worst
found; n particles across, t/L thickness over length, ν Poisson's ratio, dx spacing.

    beam               0.25 (t/L)², of a stress three times as much, + its clamps + 0.4 × square of the strain it
                       bends to, for its law is linear; 0.04 % of what happens in time, for it steps a hundred times
                       in a period
                                                         plate_step_load, oscillating_plate, udl_beam
                       of a stress at least 1.2 times what a load along it puts on outer fibres besides bending
    total-lagrangian   (0.08 + 0.15 ν)/n                                udl_beam at 6 … 20 across, ν 0 … 0.47
    ctvf               (0.15 + 0.15 ν)/n quadratic, 5/n² linear, 4.5/n printed gradient
    both               at least their clamps             udl_beam, hydrostatic_plate, a dam of gel as wide as high
    stresses           besides, of particles             stresses.py
    mean reactions     0.1 % of dead loads, whatever a body is made of
    all                + what particles hold of a body's area too much or too little (disc: 2 % at 10 across), or of
                       a spun one's inertia; what a lattice that does not fit the limbs of a frame makes of their
                       bending (a tee's stem of 3 in place of 4: 115 %); a peak between two rows of probes
    clamps, peaks of what comes at once, strain along    clamps.py, sudden.py, measures/pressed.py

A force that presses a cantilever by a share s of Euler's load makes all of this count 1/(1 − s) times; past 1 it
buckles, and what small differences decide has no bound.

A plate that bends draws in by the square of its deflection: such a goal feels all twice. A period feels half the error
of a stiffness, a time of a peak half or more (sudden.py); less than two periods show none. A peak under a load's table
may be one of resonance (resonance.py). A beam that starts in a higher mode, r times as fast, is r times as far from
slender and takes r times as few steps in a period.

What a swing adds: swings.py. Slopes and decays are not bounded.
"""

from __future__ import annotations

import math

from coupler.preflight.bounds.clamps import clamps_slip, clamps_width, never_moves
from coupler.preflight.bounds.stresses import axial, beside_bending, lost_stress, of_stress
from coupler.preflight.bounds.sudden import PEAKS, fast, rings_along, rivals, sudden_error, times_feel
from coupler.preflight.finding import STEADY
from coupler.preflight.measures.held import damping_drag, lengthwise
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import Plate, goals_quantity, of_a_body, plates_body
from coupler.preflight.measures.pressed import law_error, with_law
from coupler.preflight.measures.shapes import FEW, excess, excess_of_inertia
from coupler.preflight.measures.swing import swing
from shared.geometry.limbs import bearing, limbs
from shared.geometry.regions import axes_of
from shared.scene.sides import probe_rows
from shared.schema.probes import REACTIONS, STRESSES
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS
from shared.solid_step import BEAM_STEPS, FIRST_ROOT

BEAM_SHAPE, BEAM_STEPPED = 0.25, 4e-4
BEAM_STRESS, BEAM_BESIDE = 3.0, 1.2
BEAM_BENT = 0.4
OF_OVERTONES_PEAK = 2.5  # found 2.1, 2.5 of modes 2 and 3, 20 and 30 times as long as thick
BENT = {1: 2.0, 2: 16.0}  # strain of the outer fibre at a clamp over thickness × deflection/L², by clamped ends
LAGRANGIAN = (0.08, 0.15)
UPDATED = (0.15, 0.15)
LINEAR, PRINTED = 5.0, 4.5
AT_REST = 1e-3  # of what clamps bear of dead loads, whatever a body is made of
DRAG_MOST = 1.0  # of a body's weight and inertia, by damping where its clamps carry it along
KEPT = {"total-lagrangian": 1e-12, "spring": 1e-12, "rigid": 1e-12, "beam": 1e-3, "ctvf": 1e-2}
"""What a model loses of a momentum, of a free flight, or of a stress carried round, that physics keeps."""
TIMES = ("period", "wave-period", "t_min", "t_max")
PERIODS = ("period", "wave-period")
UNBOUNDED = ("slope", "decay", "wave-decay")
LEAST_PERIODS = 2.0
AT_ONCE_MOST = 0.5  # of Euler's load
SHORTENED, ALONG = 2.0, 0.99  # of a displacement along a plate; cosine of its angle
UNKNOWN = math.inf


def of_structure(scene: Scene, n: Numbers) -> float:
    """The structure's part; infinite where nothing bounds it."""
    plate, solid, what = n.plate, scene.solid, scene.goal.statistic
    if not_bounded(scene, n):
        return UNKNOWN
    if what == "change" and not of_displacement(scene):
        return KEPT[plate.model]
    if of_displacement(scene) and _moves_as_a_whole(scene, plate):
        return KEPT[plate.model]
    if what in STEADY and goals_quantity(scene) in REACTIONS and _dead(scene, plate):
        return max(KEPT[plate.model], AT_REST) + (0.0 if plate.model == "beam" else _filled(scene, plate))
    seen_late, filled = _between_rows(scene, n), 0.0 if plate.model == "beam" else _filled(scene, plate)
    if plate.model in RIGID_MODELS:
        return filled + seen_late
    nu = solid.poisson_ratio
    if plate.model == "beam":
        shape = BEAM_SHAPE
        if goals_quantity(scene) in STRESSES:
            shape = max(BEAM_STRESS * shape, BEAM_BESIDE * beside_bending(scene, plate))
        quick = overtone(scene, plate)
        shape *= quick * (OF_OVERTONES_PEAK if what in PEAKS and quick > 1.0 else 1.0)
        bound = shape * (plate.thickness / plate.bent) ** 2
        bound += clamps_width(scene, plate) + BEAM_BENT * _bent(plate, what) ** 2
    elif plate.model == "ctvf" and solid.gradient != "quadratic":
        bound = LINEAR / plate.across**2 if solid.gradient == "linear" else PRINTED / plate.across
    else:
        base, slope = LAGRANGIAN if plate.model == "total-lagrangian" else UPDATED
        bound = max((base + slope * nu) / plate.across, clamps_slip(scene, plate))
    if plate.model != "beam":
        bound += abs(bearing(plates_body(scene, plate), solid.dx))
        bound += of_stress(scene, plate) if goals_quantity(scene) in STRESSES else 0.0
    feels = times_feel(scene, plate) if what in TIMES else SHORTENED if _shortens(scene, plate) else 1.0
    bound *= feels / min(1.0 - plate.squeeze, 1.0)
    bound = _with_law(scene, plate, bound)
    bound += stepped(scene, plate) if what in (*TIMES, *PEAKS) else 0.0
    return bound + filled + sudden_error(scene, plate) + seen_late


def _with_law(scene: Scene, plate: Plate, error: float) -> float:
    """An error, with what the law of a model makes of a strain along a body; of a stress, the area that it acts on."""
    strain = (2.0 if scene.goal.statistic in PEAKS else 1.0) * plate.strain
    return error + abs(strain) if goals_quantity(scene) in STRESSES else with_law(plate.model, strain, error)


def _dead(scene: Scene, plate: Plate) -> bool:
    """Whether all that a body's clamps bear is dead: weight and loads that keep their direction."""
    solid = scene.solid
    follows = any(load.following for load in solid.loads if load.body == plate.name)
    moved = any(clamp.motion is not None for clamp in solid.clamps if clamp.body == plate.name)
    return scene.fluid is None and not follows and not moved


def _moves_as_a_whole(scene: Scene, plate: Plate) -> bool:
    """Whether nothing but weight and a start moves a body: it flies whatever it is made of."""
    solid, body = scene.solid, plates_body(scene, plate)
    named = {one.body for one in (*solid.clamps, *solid.loads)}
    bends = body.velocity_mode is not None or any(body.prestrain) or body.spin  # about what its particles weigh
    held = any(solid.spring.stiffness) or any(solid.spring.damping) or solid.motion is not None
    return scene.fluid is None and plate.name not in named and not bends and not held


def _shortens(scene: Scene, plate: Plate) -> bool:
    """Whether the goal is how far a plate that bends is drawn in along its length: the square of its deflection."""
    if not plate.clamps or plate.along or not of_displacement(scene):
        return False
    body = plates_body(scene, plate)
    if limbs(body) is not None:  # whose limbs lead both ways
        return False
    component = ("displacement-x", "displacement-y").index(goals_quantity(scene))
    return abs(float(axes_of(body.rotate)[lengthwise(body)[0]][component])) > ALONG


def _filled(scene: Scene, plate: Plate) -> float:
    """What particles hold of the body's area too much or too little, and so of its mass; of a body that is spun, of
    its inertia."""
    body = plates_body(scene, plate)
    if body.spin and goals_quantity(scene) in ("angular-momentum", "kinetic-energy"):
        return abs(excess_of_inertia(body, scene.solid.dx, FEW))
    return abs(excess(body, scene.solid.dx, FEW)) * (0.5 if scene.goal.statistic in TIMES else 1.0)


def _between_rows(scene: Scene, n: Numbers) -> float:
    """What a peak, or its time, loses between two rows of probes: of half a period, and of a cosine's height."""
    what, seen = scene.goal.statistic, periods(scene, n)
    missed = 0.0 if seen is None else seen / probe_rows(scene)
    return 2.0 * missed if what in ("t_min", "t_max") else 0.5 * (math.pi * missed) ** 2 if what in PEAKS else 0.0


def _bent(plate: Plate, what: str) -> float:
    """Largest strain by bending; a peak is up to twice the deflection at rest."""
    if plate.deflection is None:
        return 0.0
    deflection = min((2.0 if what in PEAKS else 1.0) * plate.deflection / plate.length, 1.0)
    return BENT[plate.clamps] * deflection * plate.thickness / plate.length


def not_bounded(scene: Scene, n: Numbers) -> str:
    """Why nothing bounds the structure's part; empty where something does."""
    what = scene.goal.statistic
    if not of_a_body(scene):
        return ""
    if what in UNBOUNDED and n.plate.model not in RIGID_MODELS:
        return f"no bound is known of a structure's {what}; a mean, peak or period has one"
    if never_moves(scene, n.plate):
        return "its point is held by a clamp: of a displacement that is nothing there is no relative error"
    if (drag := damping_drag(scene, plates_body(scene, n.plate))) > DRAG_MOST:
        return f"solid.damping drags what its clamps carry by {drag:.2g} of its weight and inertia"
    if n.plate.squeeze >= 1.0:
        return f"pressed by {n.plate.squeeze:.3g} of Euler's load it buckles, and small differences decide how far"
    if n.plate.squeeze >= AT_ONCE_MOST and what not in STEADY and rings_along(scene, n.plate):
        return f"pressed at once by {n.plate.squeeze:.3g} of Euler's load, it rings along, up to twice as much: a ramp"
    if math.inf in (law_error(n.plate.model, n.plate.strain), _with_law(scene, n.plate, 0.0)):
        return (
            f"pressed by {-n.plate.strain:.2g} of its modulus it may give way: St. Venant-Kirchhoff's law is soft there"
        )
    if n.plate.model == "beam" and goals_quantity(scene) in ("stress-xx", "stress-yy") and not axial(scene, n.plate):
        return "a beam has no stress across it; total-lagrangian has"
    if why := lost_stress(scene, n.plate):
        return why
    if why := fast(scene, n.plate):
        return why
    if rivals(scene, n):
        return f"its peaks are as high as one another, and little decides {what}: judge a period, or end early"
    if what in PERIODS and (seen := periods(scene, n)) is not None and seen < LEAST_PERIODS:
        longer = scene.end_time * LEAST_PERIODS / seen
        return f"{seen:.2g} periods until the end show no {what}; end_time = {longer:.2g} or more"
    return ""


def periods(scene: Scene, n: Numbers) -> float | None:
    """Periods of the plate's swing until the end; None where they are not known."""
    held = n.plate.clamps > 0 or n.plate.model == "spring"  # a free body moves as a whole first
    first = swing(scene, n) if held else None
    return None if first is None else scene.end_time * first.omega / (2.0 * math.pi) * overtone(scene, n.plate)


def overtone(scene: Scene, plate: Plate) -> float:
    """Frequency of the bending mode that the plate starts in over that of the first; 1 where it starts in none."""
    started = next(body.velocity_mode for body in scene.solid.bodies if body.name == plate.name)
    if started is None or started.mode == 1:
        return 1.0
    return ((started.mode - 0.5) * math.pi / FIRST_ROOT[1]) ** 2  # cos βL cosh βL = −1, to a thousandth


def of_displacement(scene: Scene) -> bool:
    """Whether the goal is of a displacement."""
    return goals_quantity(scene) in ("displacement-x", "displacement-y")


def stepped(scene: Scene, plate: Plate) -> float:
    """Relative error of a swing by its steps: two in place of one leave a quarter of it."""
    if plate.model != "beam":
        return 0.0
    step = min(plate.step, scene.end_time / probe_rows(scene))
    return BEAM_STEPPED * (BEAM_STEPS * step * plate.frequency * overtone(scene, plate)) ** 2
