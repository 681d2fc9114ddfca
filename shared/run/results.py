"""What a run leaves behind besides frames and probes: its directory and result.json."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import resource
import sys
import tempfile
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from shared import jit
from shared.contract import BadInput
from shared.run.plain import plain
from shared.run.probes import ProbeTable, compare, goal_value
from shared.run.whole import write_whole
from shared.schema.scene import Scene

RESULT_SCHEMA = 1

_KEYS = ("case", "status", "reason", "t_end", "probes", "references", "cost", "environment")
_ANEW = "Run its case.toml again, with --out in a new directory."
_SIDES = ("fluid", "solid")
_SIDE_KEYS = ("model", "particles", "steps", "particle_steps_per_s", "peak_MiB")
_COUPLING_KEYS = ("scheme", "windows", "iterations_mean", "wait_s", "overhead_fraction")
_LEDGER_KEYS = ("impulse_error", "work_error", "energy_injected_fraction")
_DISTRIBUTIONS = {
    "shearwater": "shearwater-fsi",
    "numpy": "numpy",
    "numba": "numba",
    "h5py": "h5py",
    "zenoh": "eclipse-zenoh",
}
_PACKAGES = ("shared", "fluid_solver", "solid_solver", "coupler")


def new_run_directory(out: Path | None, case: str) -> Path:
    """Create the directory of a new run: `out`, or the first free of runs/CASE, runs/CASE-2, …

    Raises BadInput if `out` holds something already, or cannot be made.
    """
    try:
        if out is not None:
            out = Path(out)
            out.mkdir(parents=True, exist_ok=True)
            if any(out.iterdir()):
                raise BadInput(
                    f"The run directory {out} is not empty; runs are never overwritten. Name a new one with "
                    f"--out DIR, remove the old one, or leave --out away to get the next free name under runs/."
                )
            return out
        number = 1
        while True:
            path = Path("runs") / (case if number == 1 else f"{case}-{number}")
            try:
                path.mkdir(parents=True)
            except FileExistsError:
                number += 1
            else:
                return path
    except OSError as error:
        raise BadInput(
            f"The run directory {out or 'runs/' + case} cannot be made ({error}). "
            f"Name a place that can be written with --out DIR."
        ) from error


def output_folder(folder: Path) -> Path:
    """Make the `folder` of a command's results, and try it before anything is computed. Raises BadInput."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"tried")
    except OSError as error:
        raise BadInput(
            f"The folder {folder} cannot be made or written to ({error}). Name a place that can be with --out DIR."
        ) from error
    return folder


def make_result(
    scene: Scene,
    case_text: str,
    table: ProbeTable,
    *,
    case: str,
    status: str,
    reason: str,
    t_end: float,
    cost: Mapping[str, Any],
    threads: Mapping[str, int],
    ledger: Mapping[str, float] | None = None,
    preflight: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """The content of result.json, for a coupled run and for one side alone.

    Its keys are in cases/RESULT.md; all are there, and None what a run does not have. `case_text`: the run's case.toml,
    whose digest is `case_hash`. `cost`: wall_s, core_s, and what is known of fluid, solid and coupling.
    """
    return {
        "schema": RESULT_SCHEMA,
        "case": case,
        "case_hash": hashlib.sha256(case_text.encode()).hexdigest(),
        "status": status,
        "reason": reason,
        "t_end": t_end,
        "probes": table.summary(scene.output.average_from),
        "references": compare(scene, table),
        "goal": None if scene.goal is None else _goal(scene, table),
        "cost": {
            "wall_s": cost.get("wall_s"),
            "core_s": cost.get("core_s"),
            **{side: _complete(cost.get(side), _SIDE_KEYS) for side in _SIDES},
            "coupling": _complete(cost.get("coupling"), _COUPLING_KEYS),
        },
        "ledger": _complete(ledger, _LEDGER_KEYS),
        "preflight": dict(preflight or {}),
        "environment": environment(threads),
    }


def loss(result: Mapping[str, Any]) -> str:
    """One sentence about the fluid that has left the domain, and what to do about it; empty where none has."""
    fluid = result["cost"].get("fluid") or {}
    if not fluid.get("lost"):
        return ""
    share, (x, y) = 100.0 * fluid["lost_fraction"], fluid["lost_near"]
    return (
        f"{fluid['lost']} fluid particles ({share:.3g} % of all) have left the domain, one of the first near "
        f"({x:.4g}, {y:.4g}) m, and are missing since: look for a gap in the walls there, or a wall that has the fluid "
        "on its right; make domain larger where water is meant to go that far."
    )


def unsettled(result: Mapping[str, Any]) -> str:
    """One sentence about windows that were accepted before they had converged; empty where all had."""
    coupling = result["cost"].get("coupling") or {}
    if not coupling.get("not_converged"):
        return ""
    return (
        f"{coupling['not_converged']} of {coupling['windows']} coupling windows were accepted before they had "
        f"converged, their loads still changing by up to {coupling['change_left']:.2g} of themselves: what comes of "
        "these windows is as unsure. Shorten coupling.window, or raise coupling.max_iterations."
    )


def missed(result: Mapping[str, Any]) -> str:
    """One sentence about a goal that the run has no value of; empty where it has one, or there is no goal."""
    goal = result.get("goal")
    if not goal or goal["value"] is not None:
        return ""
    nothing = result["probes"][goal["probe"]]["final"] is None
    why = "its model has no such probe" if nothing else "what it is made of did not happen, or not in the time judged"
    return f"this run has no value of its goal, the {goal['statistic']} of {goal['probe']}: {why}."


def _goal(scene: Scene, table: ProbeTable) -> dict[str, Any]:
    return {**scene.goal.model_dump(), "value": goal_value(scene, table.time, table.values(scene.goal.probe))}


def _complete(given: Mapping[str, Any] | None, keys: tuple[str, ...]) -> dict[str, Any] | None:
    """`given` with None for what is missing of `keys`."""
    return {**dict.fromkeys(keys), **given} if given else None


def write_result(run_dir: Path, result: Mapping[str, Any]) -> Path:
    """Write `result` to result.json: all of it or nothing, strict JSON (what is not finite becomes null)."""
    path = Path(run_dir) / "result.json"
    text = json.dumps(plain(result), indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    # A file name that is not text has parts that UTF-8 has not; JSON can escape them.
    write_whole("The result", path, text.encode(errors="backslashreplace"))
    return path


def read_result(run_dir: Path) -> dict[str, Any]:
    """What `write_result` wrote. Raises BadInput."""
    path = Path(run_dir) / "result.json"
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path} cannot be read ({error}). {_ANEW}") from None
    missing = [key for key in _KEYS if key not in result] if isinstance(result, dict) else _KEYS
    if missing:
        raise BadInput(f"{path} is not a run's result, for it lacks {', '.join(missing)}. {_ANEW}")
    return result


def environment(threads: Mapping[str, int]) -> dict[str, Any]:
    """What a result depends on besides its case: versions, a digest of the sources, processor, threads per side,
    compiler flags."""
    versions = {"python": platform.python_version(), "sources": _sources()}
    for name, distribution in _DISTRIBUTIONS.items():
        try:
            versions[name] = metadata.version(distribution)
        except metadata.PackageNotFoundError:  # run from a source tree
            versions[name] = None
    flags = {k: sorted(v) if isinstance(v, set) else v for k, v in jit.FLAGS.items()}
    return {
        "versions": versions,
        "platform": platform.platform(),
        "cpu": _cpu_model(),
        "cores": os.cpu_count(),
        "threads": dict(threads),
        "numba": flags,
    }


@cache
def _sources() -> str:
    """Digest of the programs, whatever their version is called."""
    root, digest = Path(__file__).resolve().parents[2], hashlib.sha256()
    for path in sorted(path for package in _PACKAGES for path in (root / package).rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, platform.processor() or platform.machine())


def peak_mib() -> float:
    """Largest memory this process has held, in MiB."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage would count what the process that started this one held, too
        kib = next(line.split()[1] for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return int(kib) / 1024.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)  # macOS counts bytes, others KiB
