"""Variants of a chart on a Dask cluster, one a task: sweeps are what outgrows one machine first."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from coupler.chart.outcome import Result, told, without_result
from coupler.chart.variants import Variant
from coupler.chart.worker import RUN_FOLDER, run_variant
from shared.commands import case_name
from shared.contract import BadInput
from shared.run.results import write_result
from shared.scene.reading import dump_scene

if TYPE_CHECKING:
    from distributed import Client, Future

ANSWER_WITHIN_S = 20.0
"""How long a scheduler may take to answer."""
WORKER_WITHIN_S = 60.0
"""How long a cluster may be without any worker before what is left is given up."""
_LOOK_EVERY_S = 0.2
_ASK_EVERY_S = 5.0  # for the workers

Task = tuple[list[str], str, str]


@contextlib.contextmanager
def connected(address: str) -> Iterator[Client]:
    """The cluster's client; what it has sent and is not yet done is given up when the context ends."""
    try:
        from distributed import Client
        from distributed.utils import silence_logging_cmgr
    except ImportError:
        raise BadInput(
            "--scheduler needs Dask's scheduler, which is not installed: pip install 'shearwater-fsi[dask]' here and "
            "wherever scheduler and workers run"
        ) from None
    with silence_logging_cmgr(logging.CRITICAL + 1):  # what fails is told here, in words
        try:
            asyncio.run(asyncio.wait_for(_knock(address), ANSWER_WITHIN_S))
            client = Client(address, timeout=ANSWER_WITHIN_S, set_as_default=False)
        except Exception as error:  # whatever sits at the address answers as it likes
            raise BadInput(
                f"--scheduler {address}: no Dask scheduler answered there within {ANSWER_WITHIN_S:g} s "
                f"({str(error).partition(chr(10))[0] or 'nothing came back'}); start one with `dask "
                "scheduler` and workers with `dask worker ADDRESS`, and give the address that it prints, like "
                "tcp://HOST:8786"
            ) from error
        with client:
            yield client


async def _knock(address: str) -> None:
    """Raises where no scheduler is at the address: a client that finds none takes twice its timeout to give up, or
    waits for ever."""
    from distributed import rpc
    from distributed.security import Security

    async with rpc(address, connection_args=Security().get_connection_args("client")) as peer:
        kind = (await peer.identity())["type"]
    if kind != "Scheduler":
        raise ValueError(f"a {kind} is there")


def run_on_cluster(
    tasks: Sequence[tuple[Variant, Task]], address: str, folder: Path, say: Callable[[str], None]
) -> dict[str, Result]:
    """Results by the variants' folders; what finished or failed by itself is kept in `folder` at once. A variant whose
    worker was lost has status "lost" and a reason, and does not disturb the others."""
    results: dict[str, Result] = {}
    with connected(address) as client:
        waiting = {client.submit(run_variant, *task, pure=False): variant for variant, task in tasks}
        say(f"sent {len(waiting)} variants to {address}, {len(client.nthreads())} workers")
        alone_since = asked = time.monotonic()
        while waiting:
            for future in [f for f in waiting if f.done()]:
                variant = waiting.pop(future)
                result = results[variant.folder] = _collected(future, folder / variant.folder)
                _report(variant, result, say)
            now = time.monotonic()
            if now - asked > _ASK_EVERY_S:
                asked = now
                alone_since = now if _has_workers(client) else alone_since
            if now - alone_since > WORKER_WITHIN_S:
                break
            time.sleep(_LOOK_EVERY_S if waiting else 0.0)
        for variant in waiting.values():
            reason = f"the cluster at {address} has had no worker for {WORKER_WITHIN_S:g} s"
            results[variant.folder] = {"status": "lost", "reason": reason}
            _report(variant, results[variant.folder], say)
    return results


def task_of(case: str, variant: Variant, words: Sequence[str]) -> Task:
    """What a worker needs to run the variant: `words` after `python -m`, and the scene as it is, without what lies in
    files here and no run needs: curves to compare with, and the study."""
    references = [one for one in variant.scene.references if one.curve is None]
    scene = variant.scene.model_copy(update={"references": references, "study": None})
    return ["-m", *words, "--out", RUN_FOLDER], f"{case_name(case)}.toml", dump_scene(scene)


def _has_workers(client: Client) -> bool:
    try:
        return bool(client.nthreads())
    except OSError:  # the scheduler is gone, and with it the futures
        return False


def _collected(future: Future, run_dir: Path) -> Result:
    """A task's result; of a run that ended by itself, result and probes are kept in `run_dir`."""
    if future.status != "finished":
        return {"status": "lost", "reason": _why_lost(future)}
    found = future.result()
    if found["result"] is None:
        return without_result(found["log"], found["code"])
    result = json.loads(found["result"])
    if result["status"] not in ("finished", "failed"):
        return {"status": "lost", "reason": f"its run was {result['status']}: {result['reason']}"}
    run_dir.mkdir(parents=True, exist_ok=True)
    if found["probes"] is not None:
        (run_dir / "probes.csv").write_text(found["probes"], encoding="utf-8")
    result["chart"] = {"alone": False}
    write_result(run_dir, result)
    return result


def _why_lost(future: Future) -> str:
    from distributed import KilledWorker

    if future.status == "cancelled":
        return "the scheduler dropped it or is gone"
    error = future.exception()
    if isinstance(error, KilledWorker):
        return "its worker was lost, and so was every other that took it; the worker's log says more"
    what = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"
    return f"its worker could not run it ({what}); scheduler and workers need the same Shearwater as is installed here"


def _report(variant: Variant, result: Result, say: Callable[[str], None]) -> None:
    say(f"{variant.family}: {variant.settings}")
    say(f"  {told(result)}")
