"""The command line of one solver: `run` alone, or `serve` a coupler."""

from __future__ import annotations

import json
import logging
import sys
from pathlib import Path
from typing import Annotated

import typer

from shared.commands import (
    Case,
    Out,
    Quiet,
    RunDir,
    Sets,
    case_name,
    conclude,
    default_threads,
    new_app,
    warn,
)
from shared.contract import BadInput
from shared.link_serve import serve
from shared.participant import Participant, own_faces
from shared.run.resume import unfinished
from shared.scene.reading import load_scene
from shared.scene.sides import own_probes
from shared.service import Service
from shared.slices import set_slice
from shared.solo import Factory, replay_alone, resume_alone, run_alone
from shared.stopping import end_with
from shared.warm import take_a_tiny_step

Parent = Annotated[int | None, typer.Option(help="End when this process ends.")]


def solver_app(side: str, factory: Factory) -> typer.Typer:
    """The command line of the `side` ("fluid" or "solid") whose models `factory` makes."""
    app = new_app(f"The {side} solver of Shearwater: run it alone, or let it serve a coupler.")

    @app.command("run")
    def run(
        case: Case,
        out: Out = None,
        sets: Sets = None,
        threads: Annotated[int, typer.Option(help="Threads, at most one for each core.", min=1)] = default_threads(),
        replay: Annotated[
            Path | None,
            typer.Option(help="Directory of a coupled run, recorded with output.exchange: its partner is played."),
        ] = None,
        quiet: Quiet = False,
        preflight: Annotated[
            Path | None, typer.Option(hidden=True, help="JSON for the result, of the coupler.")
        ] = None,
    ) -> None:
        """Run this side of a scene alone and write a run directory."""
        scene = load_scene(case, sets or ())
        warn(scene)
        given = (scene, case_name(case), side, factory, out, threads, quiet)
        known = {} if preflight is None else json.loads(preflight.read_text(encoding="utf-8"))
        conclude(run_alone(*given, known) if replay is None else replay_alone(*given, replay), quiet)

    @app.command("resume")
    def resume(
        run_dir: RunDir,
        threads: Annotated[int | None, typer.Option(help="Threads; default: as it ran.", min=1)] = None,
        quiet: Quiet = False,
    ) -> None:
        """Go on with a run of this side alone from its last checkpoint, to the same bytes."""
        cut = unfinished(run_dir)
        if set(cut.last.notes["threads"]) != {side}:
            raise BadInput(f"{run_dir} is not a run of the {side} side alone: coupler resume {run_dir}")
        conclude(resume_alone(cut, side, factory, threads, quiet), quiet)

    @app.command("warm", hidden=True)
    def warm(
        case: Case,
        sweeps: Annotated[bool, typer.Option(help="With a model's sweeps alone.")] = False,
        parent: Parent = None,
    ) -> None:
        """Fill the cache of compiled code for a scene."""
        end_with(parent)
        scene = own_probes(load_scene(case), side)
        model = factory(scene, True, 1)
        if sweeps:
            model.compile_sweeps()
        else:
            take_a_tiny_step(model, scene, side)

    @app.command("serve")
    def serve_coupler(
        case: Annotated[Path, typer.Argument(help="The run's case.toml.")],
        connect: Annotated[str, typer.Option(help="The coupler's endpoint, like tcp/127.0.0.1:7447.")],
        run: Annotated[str, typer.Option(help="The run's identity.")],
        out: Annotated[Path | None, typer.Option(help="File for the frames (VTKHDF).")] = None,
        threads: Annotated[int, typer.Option(help="Threads.", min=1)] = default_threads(),
        parent: Parent = None,
    ) -> None:
        """Be the participant of a coupled run."""
        end_with(parent)
        set_slice(0.0)  # the coupler's own are inherited
        logging.basicConfig(stream=sys.stderr, level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
        scene = own_probes(load_scene(case), side)
        model = factory(scene, True, threads)
        participant = Participant(model, side, out, own_faces(scene, model))
        try:
            serve(connect, run, side, Service(participant, run), attended=parent is not None)
        finally:
            participant.close()

    return app
