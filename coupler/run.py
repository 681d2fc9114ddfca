"""A coupled run from a scene to a run directory."""

from __future__ import annotations

import contextlib
import logging
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from coupler.choice import make_taker
from coupler.inprocess import inprocess_sides
from coupler.ledger import Ledger
from coupler.mapping import Mapping, build_mapping
from coupler.memory import recall, remember
from coupler.prediction import Predictor
from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.measures.window import longest_window
from coupler.recording import recording
from coupler.remote import Remote, RemoteError
from coupler.schemes import Coupled, probes
from coupler.supervisor import PACKAGES, solver_processes
from coupler.tally import Tally, coupling_cost
from coupler.touching import Touching
from coupler.window import Plan, alpha_rate, make_plan, mass_ratio
from shared.clock import Clock
from shared.contract import BadInput, Description, ParticipantLost, SolverFailed
from shared.run.checkpoint import Checkpoint, Checkpoints, way_on
from shared.run.record import Record
from shared.run.results import new_run_directory
from shared.run.resume import Unfinished
from shared.scene.sides import own_probes, probe_rows
from shared.schema.scene import Scene
from shared.stopping import stopping_between_windows
from shared.warm import fill_cache
from shared.wire import BadMessage

log = logging.getLogger("shearwater")

_ROUNDED = 1e-9  # of a length


def run_coupled(
    scene: Scene,
    case: str,
    out: Path | None,
    threads: dict[str, int],
    quiet: bool,
    link: str = "zenoh",
    preflight: dict[str, Any] | None = None,
    programs: dict[str, list[str]] | None = None,
) -> Record:
    """Couple the two sides of `scene`; returns the finished record.

    `link`: "zenoh" for two processes, "inprocess" for both sides in this one. `preflight`: what the record is to hold
    of it beside what the two sides say of themselves. `programs`: words of the command of a side that is not ours.
    """
    if programs and link == "inprocess":
        raise BadInput("A side with a command of its own is a process: leave --link inprocess away.")
    for side in ("fluid", "solid"):
        if getattr(scene, side) is None:
            other = "solid" if side == "fluid" else "fluid"
            raise BadInput(
                f"scene {case!r} has no [{side}] table, so there is nothing to couple: run it with {other}-solver, "
                "or add the table"
            )
    run_dir = new_run_directory(out, case)
    with Record(run_dir, scene, case, threads, quiet) as record:
        record.preflight |= preflight or {}
        record.programs |= programs or {}
        _run(scene, threads, link, record)
    return record


def resume_coupled(cut: Unfinished, threads: dict[str, int], link: str, quiet: bool) -> Record:
    """Go on with a run of `run_coupled` from its last checkpoint, to the same bytes."""
    scene, last = cut.scene, cut.last
    with Record(cut.run_dir, scene, last.notes["case"], threads, quiet, last, cut.held) as record:
        record.preflight |= last.notes["preflight"]
        record.programs |= last.notes.get("programs", {})
        _run(scene, threads, link, record, last)
    return record


def _run(scene: Scene, threads: dict[str, int], link: str, record: Record, last: Checkpoint | None = None) -> None:
    """Start both sides, march them from t = 0 or from a checkpoint, and end them."""
    run_dir, run = record.run_dir, uuid.uuid4().hex[:12]
    with (
        _logging_to(run_dir / "log"),
        _naming_the_way_on(run_dir),
        threadpool_limits(1, "blas"),  # vectors are short: more threads only take cores from the two sides
        _sides(scene, threads, link, run, record) as both,
    ):
        couple(scene, both["fluid"], both["solid"], record, last)


@contextlib.contextmanager
def _naming_the_way_on(run_dir: Path) -> Iterator[None]:
    """A run that loses a side can go on from its last checkpoint, if it has one, and its error says how."""
    try:
        yield
    except ParticipantLost as error:
        way = way_on(run_dir) or "there is no checkpoint yet to go on from: run it again from the start"
        raise ParticipantLost(f"{error}\n{way}") from error


def _sides(scene: Scene, threads: dict[str, int], link: str, run: str, record: Record):
    """The context that holds both participants as remotes, their compiled code ready."""
    run_dir = record.run_dir
    ours = {side: package for side, package in PACKAGES.items() if side not in record.programs}
    fill_cache(ours, run_dir / "case.toml", scene)
    if link == "inprocess" and not record.programs:
        return inprocess_sides(scene, threads, run, run_dir)
    stall_after, claim = scene.coupling.stall_after, record.claim.fileno()
    return solver_processes(run, run_dir, threads, stall_after, claim, record.programs)


def couple(scene: Scene, fluid: Remote, structure: Remote, record: Record, last: Checkpoint | None = None) -> None:
    """Describe, map, plan, start, march, finish."""
    described_fluid, described_structure = fluid.describe(), structure.describe()
    mapping = build_mapping(described_structure, described_fluid, scene.gravity)
    check_pressures(scene, described_structure, described_fluid)
    r = mass_ratio(scene, described_structure)
    longest = longest_window(scene, scene_numbers(scene))
    plan = make_plan(scene.coupling, described_fluid, described_structure, r, longest)
    clock = Clock.fitting(scene.end_time, plan.window)
    record.preflight |= {
        "window": clock.window_length,
        "alpha": alpha_rate(described_fluid, described_structure) * clock.window_length,
        "mass_ratio": r,
        "fluid_step": described_fluid.stable_step,
        "solid_step": described_structure.stable_step,
        "ghosts": len(described_fluid.position),
        "interface_points": len(mapping.selection),
    }
    log.info("window %.4g s, %d windows, r = %.4g", clock.window_length, clock.count, r)
    for reason in plan.reasons:
        log.info("%s", reason)
    c = start(scene, clock, mapping, fluid, structure, record, last)
    counts = march(scene, plan, clock, c, record, last)
    described = {"fluid": described_fluid, "solid": described_structure}
    costs = {side.name: {"model": described[side.name].model, **side.finish()} for side in (fluid, structure)}
    sides = [cost.pop("core_s") for cost in costs.values()]
    record.cost |= {
        "core_s": counts["core_s"] + sum(sides) if fluid.apart else max(sides),
        **costs,
        "coupling": coupling_cost(counts, plan, clock),
    }


def check_pressures(scene: Scene, structure: Description, fluid: Description) -> None:
    """Pressures are integrated over faces that feel their own side's water alone."""
    reach, thickness = fluid.numbers["support"], structure.numbers["thickness"]
    if scene.coupling.loads == "pressure" and thickness < reach * (1.0 - _ROUNDED):
        raise BadInput(
            f'coupling.loads = "pressure": the structure is {thickness:.3g} m thick, the kernel of the fluid reaches '
            f"{reach:.3g} m, so that its dry side would feel the water on the other. Use loads = force, or fluid.dx at "
            f"most {scene.fluid.dx * thickness / reach:.3g} m."
        )


def check_probes(scene: Scene, side: str, row: dict[str, float]) -> None:
    """A side tells its own probes alone: what it says of the other's would stand in their place."""
    own = {probe.name for probe in own_probes(scene, side).probes}
    if foreign := sorted(row.keys() - own):
        raise BadMessage(f"start from {side}: its probes {foreign} are none of its own, which are {sorted(own)}")


def start(
    scene: Scene,
    clock: Clock,
    mapping: Mapping,
    fluid: Remote,
    structure: Remote,
    record: Record,
    last: Checkpoint | None,
) -> Coupled:
    """Both sides at t = 0, or where the checkpoint `last` left them."""
    rollback = not scene.coupling.scheme.endswith("explicit")
    options = {"rollback": rollback, "resumed": last is not None, **outputs(scene, clock)}
    points, first = structure.start(clock, mapping.selection, **options)
    ghosts = mapping.motion(points)
    loads, more = fluid.start(clock, range(mapping.matrix.shape[0]), ghosts, **options)
    order = scene.coupling.predictor
    predictors = Predictor(order, mapping.loads(loads, points, ghosts)), Predictor(order, points)
    check_probes(scene, structure.name, first)
    check_probes(scene, fluid.name, more)
    if last is None:
        record.at(0.0, first | more)
    else:
        fluid.load(last.part(fluid.name))
        structure.load(last.part(structure.name))
    return Coupled(fluid, structure, mapping, points, ghosts, *predictors)


def march(
    scene: Scene, plan: Plan, clock: Clock, c: Coupled, record: Record, last: Checkpoint | None = None
) -> dict[str, float]:
    """All windows, or those that the checkpoint `last` leaves; returns their counts, see tally.py."""
    first, tally = last.window if last else 0, Tally(c.fluid, c.structure)
    take = make_taker(plan, scene.coupling)
    rows, prescribed = first if last else None, c.structure.description.model == "rigid"
    ledger = Ledger(record.run_dir / "ledger.csv", scene.coupling.limits, rows, prescribed)
    touching = None if prescribed else Touching(scene, c.fluid.description)
    checkpoints = Checkpoints(record.run_dir, scene.output.checkpoint_every, last)
    memory = {"coupled": c, "taker": take, "ledger": ledger}
    try:
        with recording(record.run_dir, scene.output.exchange, last) as told, stopping_between_windows() as stop:
            if last is None:
                told.begin(c, clock, **outputs(scene, clock))
            else:
                tally.go_on(recall(memory, plan, last))
            for window in map(clock.window, range(first, clock.count)):
                if checkpoints.due(stop.asked):
                    ledger.flush()
                    told.flush()
                    remember(memory, plan, checkpoints, window, record.notes() | {"counts": tally.counts()})
                stop.here()
                outcome = take(c, window)
                tally.add(outcome)
                row = probes(c)
                record.at(window.t1, row)
                if take.heed(window, ledger.record(window, outcome)):
                    ledger.excuse()
                told.add(window, outcome)
                if row is not None:
                    ledger.flush()
                    if touching:
                        touching.check(window.t1, c.ghosts.position)
    except RemoteError as error:
        raise (ledger.explained(error) if error.exit_code == SolverFailed.exit_code else error) from error
    finally:
        ledger.close()
        record.ledger |= ledger.summary()
    return tally.counts()


def outputs(scene: Scene, clock: Clock) -> dict[str, int]:
    """How many frames and rows of probes either side writes after the first."""
    return {"frames": scene.output.frames, "probe_rows": min(probe_rows(scene), clock.count)}


@contextlib.contextmanager
def _logging_to(log_dir: Path) -> Iterator[None]:
    """The coupler's log in `log_dir/coupler.txt`."""
    log_dir.mkdir(exist_ok=True)
    handler = logging.FileHandler(log_dir / "coupler.txt", encoding="utf-8", errors="backslashreplace")
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        yield
    except BaseException as error:
        log.error("%s: %s", type(error).__name__, error)
        raise
    finally:
        log.removeHandler(handler)
        handler.close()
