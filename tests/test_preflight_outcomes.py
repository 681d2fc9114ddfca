"""What pre-flight predicts against what comes of it. The wall and the flap had no part in making its rules; the gel dam
broke the rule of its time and led to the one for clamps, so that it only guards that one."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from coupler.preflight.check import preflight
from shared.scene.reading import load_scene

WALL = """\
schema = 1
title = "An acrylic wall holds back water at rest"
end_time = 0.06
gravity = [0.0, -9.81]
[fluid]
model = "ctvf"
dx = 4e-3
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.2, 0.12] }]
[[walls]]
name = "floor"
polyline = [[0.0, 0.2], [0.0, 0.0], [0.212, 0.0]]
[solid]
model = "total-lagrangian"
dx = 2e-3
density = 1190.0
youngs_modulus = 3.3e9
poisson_ratio = 0.37
damping = 1300.0
bodies = [{ name = "sheet", rectangle = [0.2, 0.0, 0.212, 0.15] }]
clamps = [{ body = "sheet", face = "bottom" }]
[[probes]]
name = "top"
body = "sheet"
point = [0.206, 0.15]
quantity = "displacement-x"
[goal]
probe = "top"
statistic = "mean"
error = 0.05
[output]
frames = 1
average_from = 0.03
"""
GEL = """\
schema = 1
title = "A dam of gel"
end_time = 0.5
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 1e-2
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.3, 0.18] }]
[[walls]]
name = "floor"
polyline = [[0.0, 0.3], [0.0, 0.0], [0.55, 0.0]]
[solid]
model = "total-lagrangian"
dx = 1e-2
density = 1100.0
youngs_modulus = 2e5
poisson_ratio = 0.45
damping = 60.0
gravity = false
bodies = [{ name = "dam", polygon = [[0.3, 0.0], [0.5, 0.0], [0.42, 0.2], [0.3, 0.2]] }]
clamps = [{ body = "dam", face = "edge-0" }]
[[probes]]
name = "crest"
body = "dam"
point = [0.3, 0.2]
quantity = "displacement-x"
[goal]
probe = "crest"
statistic = "mean"
error = 0.05
[output]
frames = 1
average_from = 0.3
"""
FLAP = """\
schema = 1
title = "A smaller dam break on a stiffer flap"
end_time = 0.3
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 2.5e-3
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.1, 0.2] }]
[[walls]]
name = "tank"
polyline = [[0.0, 0.8], [0.0, 0.0], [0.5, 0.0], [0.5, 0.8]]
[solid]
model = "total-lagrangian"
dx = 2.5e-3
density = 1200.0
youngs_modulus = 2e6
poisson_ratio = 0.3
bodies = [{ name = "flap", rectangle = [0.22, 0.0, 0.23, 0.06] }]
clamps = [{ body = "flap", face = "bottom" }]
[[probes]]
name = "tip"
body = "flap"
point = [0.225, 0.06]
quantity = "displacement-x"
[goal]
probe = "tip"
statistic = "max"
error = 0.1
[output]
frames = 1
"""
SCENES = {"wall": WALL, "gel": GEL, "flap": FLAP}
# The wall, of particles 2 and 1 mm apart, and the gel, of 20, 10, 5 and 2.5 mm, extrapolated: each half as far off as
# the one before. The flap: 11.371, 11.587, 11.945, 12.106 mm by particles 5/3, 5/4, 5/6, 5/8 mm apart, on a line to 0.
TRUTH = {"wall": 1.9538e-5, "gel": 1.574e-3, "flap": 1.254e-2}
STILL = ("fluid.model=still", "coupling.scheme=serial-explicit")


def scene_file(folder, name):
    path = folder / f"{name}.toml"
    path.write_text(SCENES[name], encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("name", "fluid", "solid"),
    [("wall", "still", "beam"), ("gel", "still", "total-lagrangian"), ("flap", "wcsph", None)],
)
def test_the_smallest_pair_is_sensible(tmp_path, name, fluid, solid):
    """Water at rest is not computed; what is no beam is no beam."""
    found = preflight(load_scene(scene_file(tmp_path, name)))
    assert found.verdict == "ok"
    assert found.choice.fluid == fluid
    assert found.choice.solid == solid or solid is None


def test_a_thick_body_feels_its_clamp(tmp_path):
    """Half the error or less at half the spacing, whatever its many particles across."""
    path = scene_file(tmp_path, "gel")
    bounds = [preflight(load_scene(path, [*STILL, f"solid.dx={dx}"])).error for dx in (1e-2, 5e-3)]
    assert bounds[0] >= 0.048
    assert bounds[1] >= 0.024
    assert 2.0 <= bounds[0] / bounds[1] <= 2.5


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    ("name", "sets"),
    [
        ("wall", (*STILL, "solid.model=beam", "coupling.window=0.0075")),
        ("wall", (*STILL, "coupling.window=0.0075")),
        ("gel", (*STILL, "coupling.window=0.01")),
        ("gel", (*STILL, "coupling.window=0.01", "fluid.dx=5e-3", "solid.dx=5e-3")),
        ("flap", ()),
    ],
)
def test_cost_and_error_come_out_as_predicted(tmp_path, name, sets):
    """Cost within a factor of 1.5; the bound at least the error, at most four times it or 0.3 %."""
    words = [word for text in sets for word in ("--set", text)]
    command = [sys.executable, "-m", "coupler", "run", str(scene_file(tmp_path, name)), "--out", str(tmp_path / "run")]
    subprocess.run([*command, "--quiet", "--threads", "fluid=1,solid=1", *words], check=True, timeout=500)
    result = json.loads((tmp_path / "run" / "result.json").read_text(encoding="utf-8"))
    scene, predicted = load_scene(tmp_path / "run" / "case.toml"), result["preflight"]["predicted"]
    assert predicted["core_s"] / 1.5 <= result["cost"]["core_s"] <= 1.5 * predicted["core_s"]
    error = abs(result["probes"][scene.goal.probe][scene.goal.statistic] / TRUTH[name] - 1.0)
    assert error <= predicted["error_bound"] <= max(4.0 * error, 0.003)
