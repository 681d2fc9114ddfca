"""What the three command lines share: exit codes, errors without tracebacks, common options, the closing words."""

from __future__ import annotations

import logging
import os
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from shared.contract import ShearwaterError
from shared.run.record import Record
from shared.run.results import loss, missed, unsettled
from shared.scene.warnings import scene_warnings
from shared.schema.scene import Scene
from shared.start import INTERRUPTED, on_stop_signals
from shared.stopping import STOP, ask_once_more
from shared.streams import lost_output, say
from shared.unwritable import met_limit

Case = Annotated[str, typer.Argument(help="A scene file, or the name of a shipped case.", show_default=False)]
Out = Annotated[Path | None, typer.Option(help="Run directory to make; default runs/CASE.", show_default=False)]
Sets = Annotated[
    list[str] | None, typer.Option("--set", help="path.to.key=value; may be repeated.", metavar="KEY=VALUE")
]
RunDir = Annotated[Path, typer.Argument(help="Directory of a run.", show_default=False)]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress, no table.")]


def new_app(about: str) -> typer.Typer:
    """A command line whose errors are handled by `run_app`."""
    return typer.Typer(help=about, add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)


def run_app(app: typer.Typer) -> None:
    """Run the command line and exit: 0 finished, 2 bad input, 3 solver failed, 4 participant lost, 130 interrupted."""
    for stream in (sys.stdout, sys.stderr):  # a terminal, or a file's name, may not know every character
        stream.reconfigure(errors="backslashreplace")
    logging.getLogger("shearwater").addHandler(logging.NullHandler())
    logging.raiseExceptions = False  # a log that cannot be written is no reason for tracebacks
    os.environ["MPLBACKEND"] = "agg"  # pictures are files; a notebook names what may not be installed here
    on_stop_signals(STOP.ask)
    sys.unraisablehook = ask_once_more
    try:
        app()
        code = 0
    except SystemExit as end:  # usage errors end with 2, Ctrl-C with 130
        code = end.code
    except ShearwaterError as error:
        say(f"error: {error}")
        code = error.exit_code
    except (OSError, MemoryError, RuntimeError) as error:
        limit = met_limit(error)
        if limit is None and not isinstance(error, OSError):
            raise
        check = f"{error}; check the disk's free space and the rights on the run directory, then run again"
        say(f"error: {limit or check}")
        code = 3
    if not code and (lost := lost_output()):
        say(f"error: not all could be printed ({lost}); free some space there and ask again (of a run all is kept)")
        code = 3
    if code == INTERRUPTED:
        say("interrupted; what was computed is kept")
    on_stop_signals(signal.SIG_IGN)
    sys.exit(code)


def default_threads() -> int:
    """The cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


def case_name(case: str) -> str:
    """The name a run directory gets: the file's stem, or the shipped case's name."""
    return Path(case).stem


def warn(scene: Scene) -> None:
    """Print the scene's warnings."""
    for text in scene_warnings(scene):
        say(f"warning: {text}")


def conclude(record: Record, quiet: bool) -> None:
    """Print the probes against their references, the cost, and where everything is; even if `quiet`, what is
    missing."""
    result = record.result
    for wrong in filter(None, (loss(result), unsettled(result), missed(result))):
        say(f"warning: {wrong}")
    if quiet:
        return
    console = Console()
    if result["references"]:
        table = Table(title="probes against references")
        for heading in ("probe", "reference", "statistic", "reference value", "computed", "error"):
            table.add_column(heading, justify="left" if heading in ("probe", "reference", "statistic") else "right")
        for row in result["references"]:
            numbers = [_shown(row[k], ".5g") for k in ("value", "computed")]
            table.add_row(row["probe"], row["name"], row["statistic"], *numbers, _shown(row["error"], "+.2%"))
        console.print(table)
    else:
        for name, p in result["probes"].items():
            console.print(f"{name}: mean {_shown(p['mean'], '.5g')}, final {_shown(p['final'], '.5g')} {p['unit']}")
    cost = result["cost"]
    console.print(f"finished t = {result['t_end']:g} s in {cost['wall_s']:.1f} s; results in {record.run_dir}")
    for picture in record.pictures:
        console.print(f"  {picture}")


def _shown(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)
