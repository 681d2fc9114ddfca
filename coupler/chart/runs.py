"""Runs the variants of a chart through the ordinary command lines; a variant that has finished is not run again."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from coupler.chart.cluster import run_on_cluster, task_of
from coupler.chart.outcome import Result, kept, told, without_result
from coupler.chart.variants import Variant
from coupler.guard import PATIENCE_S, end
from coupler.supervisor import PACKAGES
from shared.commands import case_name
from shared.contract import BadInput
from shared.run.checkpoint import newest
from shared.run.claims import is_claimed, is_free
from shared.run.results import write_result
from shared.run.resume import other_environment
from shared.run.words import word
from shared.schema.scene import Scene

_LOOK_EVERY_S = 0.2
_ENDING_S = 2.0 * PATIENCE_S  # the guard is patient first


def run_variants(
    case: str,
    variants: Sequence[Variant],
    folder: Path,
    jobs: int,
    say: Callable[[str], None],
    scheduler: str | None = None,
) -> list[Result]:
    """The variants' results in order, from `folder`, where missing ones are run first.

    With one job they run one after the other, each on one core alone, so that their times mean something; with more, or
    on the cluster of a Dask `scheduler`, side by side, where only errors are wanted. An error or Ctrl-C ends all runs,
    each between two windows with a checkpoint, from which another chart goes on with it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with claimed(folder) as lock:
        known = {variant.folder: kept(variant, folder / variant.folder) for variant in variants}
        missing = list({v.folder: v for v in variants if known[v.folder] is None}.values())
        if scheduler is not None and missing:
            tasks = [(v, task_of(case, v, command("run", v.scene, f"{case_name(case)}.toml"))) for v in missing]
            return _in_order(variants, known | run_on_cluster(tasks, scheduler, folder, say))
        runner = _Runner(case, folder, jobs == 1, say, lock.fileno(), threading.Event())
        with ThreadPoolExecutor(jobs) as pool:
            try:
                known |= zip((v.folder for v in missing), pool.map(runner.run, missing), strict=True)
            finally:
                runner.stop.set()
        return _in_order(variants, known)


def _in_order(variants: Sequence[Variant], known: dict[str, Result]) -> list[Result]:
    return [known[variant.folder] for variant in variants]


@contextlib.contextmanager
def claimed(folder: Path) -> Iterator[TextIO]:
    """Keep other charts from `folder` while this lasts, and while runs last that inherit the file yielded: those of a
    chart that was killed are waited for. Raises BadInput."""
    with (folder / "chart.lock").open("a+", encoding="utf-8") as file:
        deadline = time.monotonic() + _ENDING_S
        while not is_free(file):
            file.seek(0)
            other = file.read().strip()
            if _lives(other) or time.monotonic() > deadline:
                raise BadInput(
                    f"Another chart (process {other}) is at work in {folder}: wait for it or end it, or name "
                    "another place with --out DIR."
                )
            time.sleep(_LOOK_EVERY_S)
        file.truncate(0)
        file.write(f"{os.getpid()}\n")
        file.flush()
        yield file


def _lives(process: str) -> bool:
    try:
        os.kill(int(process), 0)
    except (ValueError, ProcessLookupError):
        return False
    except PermissionError:
        pass
    return True


def was_alone(result: Result) -> bool:
    """Whether this variant ran in one go and nothing else of the chart beside it, so that its times mean something."""
    return result.get("chart", {}).get("alone", True)


def command(verb: str, scene: Scene, what: str) -> list[str]:
    """What runs or resumes `scene`, the case or the run directory `what`, on one thread per side: the words after
    `python -m`."""
    if scene.fluid is not None and scene.solid is not None:
        program, threads = "coupler", "fluid=1,solid=1"
    else:
        program, threads = PACKAGES["solid" if scene.fluid is None else "fluid"], "1"
    return [program, verb, word(what), "--quiet", "--threads", threads]


@dataclass(frozen=True)
class _Runner:
    """Runs variants of a case in folders below `folder`; `lock`: descriptor of the claim that its runs share."""

    case: str
    folder: Path
    alone: bool
    say: Callable[[str], None]
    lock: int
    stop: threading.Event

    def run(self, variant: Variant) -> Result:
        """The variant's result; it goes on from a checkpoint where an earlier run left one that fits."""
        out = self.folder / variant.folder
        log = out.with_suffix(".log")
        resumed = _can_go_on(out)
        self.say(f"{'going on with' if resumed else 'running'} {variant.family}: {variant.settings}")
        code = self._ended(command("resume", variant.scene, str(out)), log) if resumed else BadInput.exit_code
        if code == BadInput.exit_code:  # nothing to go on from, or not after all
            _clear(out)
            resumed = False
            sets = (part for text in variant.sets for part in ("--set", text))
            code = self._ended([*command("run", variant.scene, self.case), "--out", str(out), *sets], log)
        result = kept(variant, out)
        if self.stop.is_set() and result is None:
            result = {"status": "interrupted"}
        elif result is None:
            result = without_result(log.read_text(encoding="utf-8", errors="replace"), code)
        elif resumed or not self.alone:
            result["chart"] = {"alone": False}
            write_result(out, result)
        self.say(f"  {told(result)}")
        return result

    def _ended(self, words: list[str], log: Path) -> int:
        """Run Python with `-m` and `words` to its end, or until the chart stops; its exit code."""
        python = [sys.executable, "-m"]
        with log.open("w") as file:
            # A session of its own: Ctrl-C reaches the chart alone, which asks the run to end, once.
            child = subprocess.Popen(
                [*python, "coupler.guard", *python, *words],
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=file,
                start_new_session=True,
                pass_fds=(self.lock,),
            )
            try:
                if self.alone and hasattr(os, "sched_setaffinity"):
                    os.sched_setaffinity(child.pid, {max(os.sched_getaffinity(0))})
                while child.poll() is None and not self.stop.wait(_LOOK_EVERY_S):
                    pass
            finally:
                end(child, _ENDING_S)
        return child.returncode


def _can_go_on(run_dir: Path) -> bool:
    """Whether there is a checkpoint, written by the same programs on the same machine."""
    try:
        return not other_environment(newest(run_dir))
    except (BadInput, KeyError):
        return False


def _clear(run_dir: Path) -> None:
    """Make room for a run. Raises BadInput where another still goes on there."""
    if is_claimed(run_dir):
        raise BadInput(f"The run in {run_dir} is still going on: wait for it, or end it, and chart again.")
    if run_dir.exists():
        shutil.rmtree(run_dir)
