"""The `coupler` command line."""

from __future__ import annotations

import json
import shlex
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from coupler.bench import exchange_line
from coupler.chart.files import summary, write_chart
from coupler.chart.study import make_chart
from coupler.one_side import resume_one_side, run_one_side
from coupler.preflight.auto import chosen
from coupler.preflight.check import actual, preflight, stop_if_refused, warn_of
from coupler.preflight.table import print_preflight
from coupler.run import resume_coupled, run_coupled
from coupler.stability.boundaries import find_boundaries, write_map
from coupler.stability.map import load_map
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
    run_app,
    warn,
)
from shared.contract import BadInput
from shared.run.plain import plain
from shared.run.record import Record
from shared.run.results import write_result
from shared.run.resume import unfinished
from shared.run.words import word
from shared.scene.reading import load_scene, shipped_cases
from shared.schema.scene import Scene

app = new_app("Couples a fluid and a solid solver: fluid-structure interaction with smoothed particle hydrodynamics.")


class LinkKind(StrEnum):
    """How participants are reached."""

    zenoh = "zenoh"
    inprocess = "inprocess"


class Models(StrEnum):
    """Which models a run takes."""

    scene = "scene"
    auto = "auto"


@app.command()
def run(
    case: Case,
    out: Out = None,
    sets: Sets = None,
    threads: Annotated[
        list[str] | None, typer.Option(help="Like fluid=2,solid=1; default: all cores for each.")
    ] = None,
    link: Annotated[
        LinkKind, typer.Option(help="Two processes over zenoh, or both sides in this one.")
    ] = LinkKind.zenoh,
    quiet: Quiet = False,
    models: Annotated[
        Models, typer.Option(help="As the scene says, or the smallest pair that meets its goal.")
    ] = Models.scene,
    force: Annotated[
        bool, typer.Option("--force", help="Run although pre-flight refuses the scene, or --models auto its cost.")
    ] = False,
    fluid_command: Annotated[
        str | None, typer.Option(help="A fluid of your own: what starts it.", metavar="COMMAND", show_default=False)
    ] = None,
    solid_command: Annotated[
        str | None, typer.Option(help="A structure of your own: what starts it.", metavar="COMMAND", show_default=False)
    ] = None,
) -> None:
    """Start both solvers, couple them, and write a run directory."""
    counts = parse_threads(",".join(threads or ()))
    programs = parse_programs(fluid=fluid_command, solid=solid_command)
    scene = load_scene(case, sets or ())
    warn(scene)
    found = preflight(scene)
    if models is Models.auto:
        scene = chosen(found, force)
        found = preflight(scene)
    warn_of(found)
    if not force:
        stop_if_refused(found)
    if models is Models.auto and (scene.fluid is None or scene.solid is None):
        raise SystemExit(run_one_side(scene, case_name(case), out, counts, quiet, found))
    record = run_coupled(scene, case_name(case), out, counts, quiet, link.value, found.as_dict(), programs)
    conclude_coupled(record, scene, quiet)


@app.command()
def resume(
    run_dir: RunDir,
    threads: Annotated[list[str] | None, typer.Option(help="Like fluid=2,solid=1; default: as it ran.")] = None,
    link: Annotated[
        LinkKind, typer.Option(help="Two processes over zenoh, or both sides in this one.")
    ] = LinkKind.zenoh,
    quiet: Quiet = False,
) -> None:
    """Go on with a run that was cut short, from its last checkpoint, to the same bytes as without the break."""
    cut = unfinished(run_dir)
    ran = cut.last.notes["threads"]
    if len(ran) == 1:
        cut.held.close()  # that side's own program claims the run
        raise SystemExit(resume_one_side(run_dir, cut.scene, *ran, ",".join(threads or ()), quiet))
    counts = parse_threads(",".join(threads)) if threads else ran
    conclude_coupled(resume_coupled(cut, counts, link.value, quiet), cut.scene, quiet)


def conclude_coupled(record: Record, scene: Scene, quiet: bool) -> None:
    """Set what pre-flight had predicted beside what came of it, and say how the run went."""
    record.result["preflight"]["actual"] = actual(record.result, scene)
    write_result(record.run_dir, record.result)
    conclude(record, quiet)


@app.command()
def check(
    case: Case,
    sets: Sets = None,
    as_json: Annotated[bool, typer.Option("--json", help="The report as JSON.")] = False,
) -> None:
    """Look at a scene without running it: its numbers, verdicts, and the smallest models that meet its goal."""
    scene = load_scene(case, sets or ())
    found = preflight(scene)
    if as_json:
        print(json.dumps(plain(found.as_dict()), indent=1, allow_nan=False, ensure_ascii=False))
    else:
        warn(scene)
        print_preflight(found, scene, Console())
    if found.verdict == "refuse":
        raise SystemExit(BadInput.exit_code)


@app.command()
def chart(
    case: Case,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the chart and its runs; default runs/chart-CASE.", show_default=False)
    ] = None,
    sets: Sets = None,
    jobs: Annotated[
        int,
        typer.Option(help="Variants at once; more than one where only errors are wanted, times then mislead.", min=1),
    ] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="Dask scheduler whose workers run the variants, like tcp://HOST:8786; times then mislead.",
            metavar="ADDRESS",
            show_default=False,
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Chart error against cost over the variants of the case's study; what has been run is not run again."""
    if scheduler is not None and jobs > 1:
        raise BadInput(f"--jobs {jobs} is how many run at once here; on a cluster its workers say so: leave one away")
    folder = out or Path("runs") / f"chart-{case_name(case)}"
    say = (lambda text: None) if quiet else (lambda text: print(text, flush=True))
    found = make_chart(case, sets or (), folder, jobs, say, scheduler)
    words = ["coupler", "chart", word(case), *(part for text in sets or () for part in ("--set", text))]
    words += ["--jobs", str(jobs)] if jobs > 1 else ["--scheduler", scheduler] if scheduler else []
    paths = write_chart(found, folder, shlex.join(words))
    if not quiet:
        for line in (*summary(found), *map(str, paths)):
            print(line)


@app.command()
def stability(
    map_file: Annotated[str, typer.Argument(metavar="MAP", help="A map's file, or the name of a shipped map.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder of the map; default runs/map-MAP.", show_default=False)
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Draw a stability map from runs, with theory's boundary over it; what has been run is not run again."""
    given = load_map(map_file)
    folder = out or Path("runs") / f"map-{case_name(map_file)}"
    found = find_boundaries(given, folder, (lambda text: None) if quiet else lambda text: print(text, flush=True))
    paths = write_map(given, found, folder)
    if not quiet:
        for path in paths:
            print(path)


@app.command()
def report(
    run_dir: RunDir,
    out: Annotated[
        Path | None, typer.Option(help="File to write; default RUN_DIR/report.html.", show_default=False)
    ] = None,
) -> None:
    """Write a run as one HTML page: pictures, probes against references, ledger, cost, pre-flight."""
    from coupler.report import write_report  # loads for half a second

    print(write_report(run_dir, out))


@app.command()
def cases() -> None:
    """List the cases that ship, with what each shows."""
    table = Table("case", "sides", "title")
    for name, path in shipped_cases().items():
        scene = load_scene(path)
        sides = " + ".join(
            f"{side} {part.model}" for side, part in (("fluid", scene.fluid), ("solid", scene.solid)) if part
        )
        table.add_row(name, sides, scene.title)
    Console().print(table)


@app.command()
def bench(
    points: Annotated[int, typer.Option(help="Interface points on each side.", min=10)] = 1000,
    windows: Annotated[int, typer.Option(help="Windows timed.", min=10)] = 2000,
) -> None:
    """Time the exchange itself: windows of models that compute next to nothing, over both links."""
    for link in LinkKind:
        print(exchange_line(link.value, points, windows), flush=True)


def parse_threads(text: str) -> dict[str, int]:
    """Threads per side from text like "fluid=2,solid=1"."""
    counts = dict.fromkeys(("fluid", "solid"), default_threads())
    for part in filter(None, text.split(",")):
        side, _, count = part.partition("=")
        if side not in counts or not count.isdecimal() or int(count) < 1:
            raise BadInput(f"--threads {text!r}: {part!r} is not fluid=N or solid=N with N at least 1")
        counts[side] = int(count)
    return counts


def parse_programs(**commands: str | None) -> dict[str, list[str]]:
    """Words of each side's command, as a shell takes them apart."""
    programs = {}
    for side, command in commands.items():
        try:
            words = shlex.split(command or "")
        except ValueError as error:
            raise BadInput(f"--{side}-command {command!r} is not a command: {error}") from None
        if words:
            programs[side] = words
        elif command is not None:
            raise BadInput(f"--{side}-command is empty: name the program that serves the {side} side")
    return programs


def main() -> None:
    """Entry point."""
    run_app(app)
