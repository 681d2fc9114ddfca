"""Runs the variants of a chart through the ordinary command lines; a variant that has finished is not run again."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from coupler.chart_cluster import run_on_cluster, task_of
from coupler.chart_variants import Variant
from coupler.guard import end
from coupler.supervisor import PACKAGES
from shared.commands import case_name
from shared.contract import BadInput
from shared.results import read_result, write_result
from shared.schema import Scene


def run_variants(
    case: str,
    variants: Sequence[Variant],
    folder: Path,
    jobs: int,
    say: Callable[[str], None],
    scheduler: str | None = None,
) -> list[dict[str, Any]]:
    """The variants' results in order, from `folder`, where missing ones are run first.

    With one job they run one after the other, each on one core alone, so that their times mean something; with more, or
    on the cluster of a Dask `scheduler`, side by side, where only errors are wanted.
    """
    folder.mkdir(parents=True, exist_ok=True)
    known = {variant.folder: _finished(folder / variant.folder) for variant in variants}
    missing = [variant for variant in variants if known[variant.folder] is None]

    def one(variant: Variant) -> dict[str, Any]:
        say(f"running {variant.family}: {variant.label or 'as it stands'}")
        result = _run(case, variant, folder / variant.folder, alone=jobs == 1)
        say(f"  {result['status']} {result.get('reason', '')}".rstrip())
        return result

    if scheduler is not None and missing:
        tasks = [(v, task_of(case, v, command(v.scene, f"{case_name(case)}.toml"))) for v in missing]
        known |= run_on_cluster(tasks, scheduler, folder, say)
    elif jobs == 1:
        known |= {variant.folder: one(variant) for variant in missing}
    else:
        with ThreadPoolExecutor(jobs) as pool:
            known |= zip((v.folder for v in missing), pool.map(one, missing), strict=True)
    return [known[variant.folder] for variant in variants]


def was_alone(result: dict[str, Any]) -> bool:
    """Whether nothing else of the chart ran beside this variant, so that its times mean something."""
    return result.get("chart", {}).get("alone", True)


def command(scene: Scene, case: str) -> list[str]:
    """What runs `scene`, which `case` names, on one thread per side: the words after `python -m`."""
    if scene.fluid is not None and scene.solid is not None:
        program, threads = "coupler", "fluid=1,solid=1"
    else:
        program, threads = PACKAGES["solid" if scene.fluid is None else "fluid"], "1"
    return [program, "run", case, "--quiet", "--threads", threads]


def _finished(run_dir: Path) -> dict[str, Any] | None:
    """The result of a run that ended by itself, finished or failed; None if there is none that can be read."""
    try:
        result = read_result(run_dir)
    except BadInput:
        return None
    return result if result["status"] in ("finished", "failed") else None


def _run(case: str, variant: Variant, out: Path, alone: bool) -> dict[str, Any]:
    if out.exists():  # what an interrupted chart left behind
        shutil.rmtree(out)
    log = out.with_suffix(".log")
    sets = (word for text in variant.sets for word in ("--set", text))
    words = [sys.executable, "-m", *command(variant.scene, case), "--out", str(out), *sets]
    with log.open("w") as file:
        child = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=file, stderr=file)
        try:
            if alone and hasattr(os, "sched_setaffinity"):
                os.sched_setaffinity(child.pid, {max(os.sched_getaffinity(0))})
            child.wait()
        finally:
            end(child)
    result = _finished(out)
    if result is None:
        reason = log.read_text(errors="replace").strip()
        return {"status": "refused", "reason": reason.splitlines()[0] if reason else "no result"}
    if not alone:
        result["chart"] = {"alone": False}
        write_result(out, result)
    return result
