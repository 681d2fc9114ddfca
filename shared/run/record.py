"""The record of a run: probes as they come, then result.json and pictures, whatever ends the run."""

from __future__ import annotations

import contextlib
import re
import shutil
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TextIO

from shared.contract import BadInput, ParticipantLost, ShearwaterError
from shared.run.checkpoint import Checkpoint, way_on
from shared.run.claims import claim
from shared.run.curves import FOLDER as CURVES
from shared.run.curves import keep_curves
from shared.run.probes import ProbeTable, probe_units
from shared.run.progress import Progress
from shared.run.results import environment, make_result, write_result
from shared.run.whole import write_whole
from shared.scene.reading import dump_scene
from shared.schema.scene import Scene
from shared.stopping import STOP
from shared.streams import say
from shared.unwritable import cannot_write, met_limit

_OF_THE_SYSTEM = re.compile(r"\[Errno \d+\]")


class Record:
    """Context of a run in `run_dir`: writes `case.toml` first, `probes.csv` on the way, `result.json` at the end.

    The run adds to `cost`, `ledger`, `preflight` and `programs`, the commands of sides that are not ours. An error or
    Ctrl-C that leaves the context is written down as the run's status and reason, and goes on, whatever else goes wrong
    meanwhile; the command that goes on with a run that was cut short is printed. Status: "finished"; "failed", by what
    was computed; "lost", by the machine (a process killed, a full disk): the same run may finish another time;
    "interrupted".

    `last`: the checkpoint that the run goes on from, with the `held` claim to it. What is there beyond it, and the
    result, stay until the run has gone on: one that cannot changes nothing.
    """

    def __init__(
        self,
        run_dir: Path,
        scene: Scene,
        case: str,
        threads: Mapping[str, int],
        quiet: bool,
        last: Checkpoint | None = None,
        held: TextIO | None = None,
    ):
        self.run_dir = run_dir
        self.cost: dict[str, Any] = {}
        self.ledger: dict[str, float] = {}
        self.preflight: dict[str, float] = {}
        self.programs: dict[str, list[str]] = {}
        self.pictures: list[Path] = []
        self.result: dict[str, Any] = {}
        self._scene, self._case, self._threads = scene, case, dict(threads)
        self._time = 0.0 if last is None else last.time
        self._wall_before = 0.0 if last is None else last.notes["wall_s"]
        self._moved = last is None
        case_file = run_dir / "case.toml"
        if last is None:
            try:
                with case_file.open("x", encoding="utf-8") as file, _all_or_nothing(run_dir):
                    self._scene = keep_curves(scene, run_dir)
                    file.write(dump_scene(self._scene, run_dir))
                    file.flush()
            except FileExistsError:
                raise BadInput(f"Another run has just begun in {run_dir}: name another place with --out DIR.") from None
            except OSError as error:
                raise cannot_write("The scene", case_file, error) from error
        self._text = case_file.read_text(encoding="utf-8")
        self.claim = held or claim(run_dir)
        self._table = ProbeTable(run_dir / "probes.csv", probe_units(scene), last and last.notes["probe_rows"])
        self._progress = Progress(scene.title, scene.end_time, quiet)

    def __enter__(self) -> Record:
        self._begun = time.perf_counter()
        self._progress.__enter__()
        return self

    def at(self, now: float, probes: Mapping[str, float] | None) -> None:
        """The run has reached time `now` [s]; `probes` is the row due, or None."""
        self._time, self._moved = now, True
        if probes is not None:
            self._table.append(now, probes)
        self._progress.update(now)

    def notes(self) -> dict[str, Any]:
        """What a checkpoint has to know of the record, for one that goes on with it."""
        return {
            "case": self._case,
            "scene": self._text,
            "threads": self._threads,
            "probe_rows": self._table.rows,
            "wall_s": self._wall(),
            "preflight": self.preflight,
            "programs": self.programs,
            "environment": environment(self._threads),
        }

    def _wall(self) -> float:
        return self._wall_before + time.perf_counter() - self._begun

    def __exit__(self, kind, error, trace) -> None:
        STOP.ending = True  # a second or two, and all is kept
        self._progress.__exit__(None, None, None)
        self._table.close()
        status, reason = _status(error)
        if self._moved:
            try:
                self._conclude(status, reason)
            except (ShearwaterError, OSError) as another:
                if error is None:
                    raise
                say(f"warning: {another}")
        self.claim.close()
        # That of a lost participant is part of its error.
        cut = status == "interrupted" or (status == "lost" and not isinstance(error, ParticipantLost))
        if cut and (way := way_on(self.run_dir)):
            say(way)
        STOP.ending = status == "interrupted"

    def _conclude(self, status: str, reason: str) -> None:
        """Write the result and draw the pictures."""
        self.result = make_result(
            self._scene,
            self._text,
            self._table,
            case=self._case,
            status=status,
            reason=reason,
            t_end=self._time,
            cost={"wall_s": self._wall(), **self.cost},
            threads=self._threads,
            ledger=self.ledger,
            preflight=self.preflight,
        )
        write_result(self.run_dir, self.result)
        keep_scene(self.run_dir, self._text)
        from shared.run.pictures import draw_pictures  # loads for half a second

        self.pictures = draw_pictures(self.run_dir, self._scene)


@contextlib.contextmanager
def _all_or_nothing(run_dir: Path) -> Iterator[None]:
    """The scene and its curves: a directory without them is empty again, and may be named another time."""
    try:
        yield
    except BaseException:
        shutil.rmtree(run_dir / CURVES, ignore_errors=True)
        (run_dir / "case.toml").unlink(missing_ok=True)
        raise


def keep_scene(run_dir: Path, text: str) -> None:
    """A scene that another program has removed since its run began stands again, for whoever goes on with the run."""
    case_file = run_dir / "case.toml"
    if run_dir.exists() and not case_file.exists():
        write_whole("The scene", case_file, text.encode())
        say(f"warning: {case_file} was gone, removed by another program since the run began: it is written again.")


def _status(error: BaseException | None) -> tuple[str, str]:
    if error is None:
        return "finished", ""
    if isinstance(error, KeyboardInterrupt):
        return "interrupted", "interrupted by the user"
    error = met_limit(error) or error
    text = str(error) if isinstance(error, (ShearwaterError, OSError)) else f"{type(error).__name__}: {error}"
    return "lost" if of_the_machine(error) else "failed", text


def of_the_machine(error: BaseException) -> bool:
    """Whether a run ended by its machine, and not by what was computed."""
    # What the system refused a solver comes as words, which hold its number.
    refused = met_limit(error) or error
    return isinstance(refused, (ParticipantLost, OSError)) or bool(_OF_THE_SYSTEM.search(str(refused)))
