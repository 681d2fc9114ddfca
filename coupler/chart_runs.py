"""Runs the variants of a chart through the ordinary command lines; a variant that has finished is not run again."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from coupler.chart_variants import Variant
from coupler.supervisor import PACKAGES

_PATIENCE_S = 10.0  # between asking a run to end and killing it


def run_variants(
    case: str, variants: Sequence[Variant], folder: Path, jobs: int, say: Callable[[str], None]
) -> list[dict[str, Any]]:
    """The variants' results in order, from `folder`, where missing ones are run first.

    With one job they run one after the other, each on one core alone, so that their times mean something; with more,
    side by side, where only errors are wanted.
    """
    folder.mkdir(parents=True, exist_ok=True)

    def one(variant: Variant) -> dict[str, Any]:
        result = _finished(folder / variant.folder)
        if result is None:
            say(f"running {variant.family}: {variant.label or 'as it stands'}")
            result = _run(case, variant, folder / variant.folder, pinned=jobs == 1)
            say(f"  {result['status']} {result.get('reason', '')}".rstrip())
        return result

    if jobs == 1:
        return [one(variant) for variant in variants]
    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, variants))


def command(case: str, variant: Variant, out: Path) -> list[str]:
    """The command line that runs a variant on one thread per side."""
    scene = variant.scene
    words = [word for text in variant.sets for word in ("--set", text)]
    if scene.fluid is not None and scene.solid is not None:
        program, threads = "coupler", "fluid=1,solid=1"
    else:
        program, threads = PACKAGES["solid" if scene.fluid is None else "fluid"], "1"
    return [sys.executable, "-m", program, "run", case, "--out", str(out), "--quiet", "--threads", threads, *words]


def _finished(run_dir: Path) -> dict[str, Any] | None:
    """The result of a run that ended by itself, finished or failed; None if there is none."""
    path = run_dir / "result.json"
    if not path.exists():
        return None
    result = json.loads(path.read_text(encoding="utf-8"))
    return result if result["status"] in ("finished", "failed") else None


def _run(case: str, variant: Variant, out: Path, pinned: bool) -> dict[str, Any]:
    if out.exists():  # what an interrupted chart left behind
        shutil.rmtree(out)
    log = out.with_suffix(".log")
    with log.open("w") as file:
        child = subprocess.Popen(command(case, variant, out), stdin=subprocess.DEVNULL, stdout=file, stderr=file)
        try:
            if pinned and hasattr(os, "sched_setaffinity"):
                os.sched_setaffinity(child.pid, {max(os.sched_getaffinity(0))})
            child.wait()
        finally:
            _end(child)
    result = _finished(out)
    if result is None:
        reason = log.read_text(errors="replace").strip()
        result = {"status": "refused", "reason": reason.splitlines()[0] if reason else "no result"}
    return result


def _end(child: subprocess.Popen) -> None:
    if child.poll() is None:
        child.terminate()
        try:
            child.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
