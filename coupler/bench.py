"""What an exchange costs: windows of two models that compute next to nothing, over either link.

coupler bench [--points N] [--windows N]
"""

from __future__ import annotations

import contextlib
import tempfile
import time
import uuid
from pathlib import Path

import numpy as np

from coupler.choice import make_taker
from coupler.inprocess import inprocess_sides
from coupler.ledger import Ledger
from coupler.mapping import build_mapping
from coupler.prediction import Predictor
from coupler.schemes import Coupled, probes
from coupler.supervisor import solver_processes
from coupler.window import Plan
from shared.clock import Clock
from shared.run.claims import claim
from shared.scene.reading import dump_scene
from shared.schema.scene import Scene

_WARM = 50  # windows before the clock starts


def still_piston(points: int) -> Scene:
    """A fixed plate of `points` points under as many columns of water; no two coincide, so that the map works."""
    face = 1.0
    dx = face / points
    return Scene.model_validate(
        {
            "schema": 1,
            "title": "exchange",
            "end_time": 1.0,
            "fluid": {
                "model": "column",
                "dx": dx,
                "column": {"compressible": False},
                "bodies": [{"name": "water", "rectangle": (0.0, 0.0, 10.0 * dx, face)}],
            },
            "solid": {
                "model": "rigid",
                "dx": 2.0 * dx,
                "density": 1000.0,
                "bodies": [{"name": "plate", "rectangle": (-4.0 * dx, 0.0, 0.0, face)}],
            },
            "coupling": {"scheme": "serial-explicit", "window": 1e-4},
        }
    )


def time_windows(link: str, points: int, windows: int) -> dict[str, float]:
    """Median and 95th percentile [ms] of a window, ledger included, and what of it the models took; points a side."""
    scene, run = still_piston(points), uuid.uuid4().hex[:12]
    threads = {"fluid": 1, "solid": 1}
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        run_dir = Path(folder)
        (run_dir / "case.toml").write_text(dump_scene(scene), encoding="utf-8")
        claimed = stack.enter_context(claim(run_dir))
        sides = (
            inprocess_sides(scene, threads, run, run_dir)
            if link == "inprocess"
            else solver_processes(run, run_dir, threads, scene.coupling.stall_after, claimed.fileno())
        )
        both = stack.enter_context(sides)
        fluid, structure = both["fluid"], both["solid"]
        mapping = build_mapping(structure.describe(), fluid.describe(), scene.gravity)
        clock = Clock(1.0, windows + _WARM)
        motion, _ = structure.start(clock, mapping.selection, frames=1, probe_rows=1)
        wall = mapping.motion(motion)
        loads, _ = fluid.start(clock, range(mapping.matrix.shape[0]), wall, frames=1, probe_rows=1)
        past = Predictor(0, mapping.loads(loads, motion, wall)), Predictor(0, motion)
        c = Coupled(fluid, structure, mapping, motion, wall, *past)
        take = make_taker(Plan("serial-explicit", clock.window_length), scene.coupling)
        ledger = Ledger(run_dir / "ledger.csv", scene.coupling.limits)
        spent = []
        for window in map(clock.window, range(clock.count)):
            begun = time.perf_counter()
            ledger.record(window, take(c, window))
            probes(c)
            spent.append(1e3 * (time.perf_counter() - begun))
        ledger.close()
        busy = 1e3 * sum(side.finish()["busy_s"] for side in (fluid, structure)) / clock.count
    return {
        "median_ms": float(np.median(spent[_WARM:])),
        "p95_ms": float(np.percentile(spent[_WARM:], 95)),
        "models_ms": busy,
        "points": len(mapping.selection),
        "ghosts": mapping.matrix.shape[0],
    }


def exchange_line(link: str, points: int, windows: int) -> str:
    """What `time_windows` found, in words."""
    found = time_windows(link, points, windows)
    return (
        f"{link:9}  {found['points']:.0f} points, {found['ghosts']:.0f} ghosts: {found['median_ms']:.3f} ms a window "
        f"(median), {found['p95_ms']:.3f} ms (95th percentile); of it {found['models_ms']:.3f} ms in the models"
    )
