"""How the variants of a chart came out: which result of an earlier run counts, and in words why one is missing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from coupler.chart.truth import charted_value
from coupler.chart.variants import Variant
from shared.contract import BadInput
from shared.run.results import environment, read_result

Result = dict[str, Any]

_ERROR = re.compile(r"^[\s\0]*error: (.+(?:\n +.+)*)", re.MULTILINE)
_KILLED = 128  # exit codes above are of signals
_VERSIONS = ("shearwater", "sources", "numpy", "numba")  # that a chart's values depend on


def kept(variant: Variant, run_dir: Path) -> Result | None:
    """The result of a run that ended by itself, finished or failed; None where there is none whose result and probes
    can be read, or where the machine was at fault."""
    try:
        result = read_result(run_dir)
        charted_value(variant, result, run_dir)
    except BadInput:
        return None
    return result if result["status"] in ("finished", "failed") else None


def without_result(log: str, code: int) -> Result:
    """What stands for the result of a run that left none to keep: refused, or lost by the machine's fault."""
    found = _ERROR.search(log)
    if found:
        reason = " ".join(line.strip() for line in found[1].splitlines())
    elif code > _KILLED:
        reason = f"its run was ended by signal {code - _KILLED}"
    else:
        last = [line.strip() for line in log.splitlines() if line.strip() and not line.startswith("warning:")][-1:]
        reason = f"its run ended with exit code {code}: {last[0] if last else 'no word in its log'}"
    return {"status": "refused" if code == BadInput.exit_code else "lost", "reason": reason}


def missing(variants: Sequence[Variant], results: Sequence[Result], values: Sequence, runs: Path) -> list[str]:
    """A sentence for every variant that has no value: why, and the way out."""
    return [
        f"Missing: {v.family}, {v.settings}: {_why(v, result)}: {_way_out(v, result, runs)}."
        for v, result, value in zip(variants, results, values, strict=True)
        if value is None
    ]


def of_other_code(results: Sequence[Result]) -> list[str]:
    """A sentence where results were computed by other code than a run would be now."""
    now = {name: environment({})["versions"][name] for name in _VERSIONS}
    then = [{n: r["environment"]["versions"].get(n) for n in _VERSIONS} for r in results if "environment" in r]
    other = [versions for versions in then if versions != now]
    if not other:
        return []
    olds = {name: sorted({str(versions[name]) for versions in other} - {str(now[name])}) for name in _VERSIONS}
    named = "; ".join(f"{name} {', '.join(old)} then, {now[name]} now" for name, old in olds.items() if old)
    return [
        f"{len(other)} of {len(results)} variants were computed by other code ({named}): to compare like with like, "
        "chart anew into an empty folder."
    ]


def told(result: Result) -> str:
    """Status and reason in one line."""
    return f"{result['status']} {(result.get('reason') or '').partition(chr(10))[0]}".strip()


def _why(variant: Variant, result: Result) -> str:
    if result["status"] == "finished":
        return f"finished, but {variant.scene.goal.probe} has no {variant.scene.goal.statistic}"
    return told(result).replace(" ", ", ", 1).rstrip(".:")


def _way_out(variant: Variant, result: Result, runs: Path) -> str:
    if result["status"] == "lost":
        return "the same command runs it again"
    if result["status"] == "refused":
        return "mend the scene or the study, and chart again"
    return f"it is not run again unless {runs / variant.folder} is removed"
