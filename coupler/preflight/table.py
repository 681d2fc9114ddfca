"""Pre-flight on a terminal."""

from __future__ import annotations

import math

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from coupler.preflight.check import Preflight
from coupler.preflight.ladder import Rung
from coupler.preflight.measures.numbers import Numbers, scene_numbers
from coupler.preflight.measures.window import expected_plan, expected_window
from shared.schema.scene import Scene

_COLOURS = {"ok": "green", "warn": "yellow", "refuse": "red", "smallest": "green", "enough": "", "not enough": "yellow"}


def print_preflight(report: Preflight, scene: Scene, console: Console) -> None:
    """The numbers, the ladder, and the verdict in words."""
    table = Table("number", "value", "verdict", "reason, and the way out", title=f"pre-flight: {escape(scene.title)}")
    for f in report.findings:
        text = f"{f.reason} → {f.way_out}" if f.way_out else f.reason
        table.add_row(f.rule, f"{f.value:.3g}", _coloured(f.verdict), escape(text))
    console.print(table)
    if scene.goal is None:
        console.print(escape("No [goal], so no model can be called enough."))
    else:
        _print_ladder(report, scene, console)
    for line in verdict_lines(report, scene):
        console.print(escape(line))


def _print_ladder(report: Preflight, scene: Scene, console: Console) -> None:
    goal = scene.goal
    wanted = f"{goal.statistic} of {goal.probe} within {100 * goal.error:g} %"
    table = Table("models", "error bound", "core-s", "standing", title=f"the ladder: {wanted}")
    shown = [rung for rung in report.ladder if rung.standing != "cannot"]
    for rung in shown:
        error = f"{100 * rung.error:.2g} %" if math.isfinite(rung.error) else "–"
        cost = f"{report.slower * rung.cost.core_s:.3g}" if rung.cost else "–"
        table.add_row(rung.name, error, cost, _coloured(rung.standing))
    console.print(table)
    _print_reasons(shown, "", console)
    _print_reasons([rung for rung in report.ladder if rung.standing == "cannot"], "left out: ", console)


def _print_reasons(rungs: list[Rung], before: str, console: Console) -> None:
    """Why, once for all pairs of models that share a reason."""
    for reason in dict.fromkeys(rung.reason for rung in rungs):
        names = ", ".join(rung.name for rung in rungs if rung.reason == reason)
        console.print(f"[dim]{escape(before + names)}: {escape(reason)}[/dim]")


def verdict_lines(report: Preflight, scene: Scene) -> list[str]:
    """The verdict in words: this scene's own prediction, the smallest pair, and how it is coupled."""
    lines = []
    bound = (
        f", error bound {100 * report.error:.2g} %" if report.error is not None and math.isfinite(report.error) else ""
    )
    coupled = f" {_coupling_line(scene, report.numbers)}" if report.numbers.joint is not None else ""
    lines.append(f"As it stands: about {report.cost.core_s:.3g} core-seconds{bound}.{coupled}")
    choice = report.choice
    if choice is not None:
        sets = " ".join(f"--set {s}" for s in choice.sets)
        numbers = scene_numbers(choice.scene)
        coupled = f" {_coupling_line(choice.scene, numbers)}" if numbers.joint is not None else ""
        how = f"by {sets}" if sets else "as it stands"
        lines.append(f"Smallest that meets the goal: {choice.name} {how}.{coupled}")
        if report.near_miss is not None:
            lines.append(near_miss_line(report))
    elif report.ladder:
        costed = reversed([rung for rung in report.ladder if rung.cost is not None])  # of no bounds, the largest pair's
        closest = min(costed, key=lambda rung: rung.error, default=None)
        why = f": {closest.reason}" if closest is not None else ""
        lines.append(f"No pair of models is known to meet the goal{why}.")
    return lines


def near_miss_line(report: Preflight) -> str:
    """The near miss, by how much it misses, and both costs."""
    near, choice = report.near_miss, report.choice
    costs = [report.slower * rung.cost.core_s for rung in (near, choice)]
    wanted = near.scene.goal.error
    return (
        f"Near miss: {near.name}, bound {100 * near.error:.3g} % for {100 * wanted:.3g} %, misses by "
        f"{100 * (near.error - wanted):.2g} %, for {costs[0]:.3g} core-seconds in place of {costs[1]:.3g}."
    )


def _coupling_line(scene: Scene, n: Numbers) -> str:
    """Scheme, window, and each side's steps in it."""
    plan, window = expected_plan(scene, n), expected_window(scene, n)
    scheme = f"{plan.scheme} with {scene.coupling.acceleration}" if plan.scheme.endswith("implicit") else plan.scheme
    steps = [max(1, math.ceil(window / step * (1 - 1e-9))) for step in (n.water.step, n.plate.step)]
    return f"Coupled {scheme}, window {window:.3g} s, in it {steps[0]} fluid and {steps[1]} solid steps."


def _coloured(word: str) -> str:
    colour = _COLOURS.get(word, "")
    return f"[{colour}]{word}[/{colour}]" if colour else word
