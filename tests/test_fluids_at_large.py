"""Fluids alone in walls that ship with nobody, each judged by a balance that its physics must keep."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from fluid_solver.models import make_model
from shared.run.vtkhdf import read_frame
from shared.solo import run_alone
from tests.scenes import scene_of

pytestmark = pytest.mark.timeout(240)  # the first run compiles

G = 9.81

FUNNEL = """\
schema = 1
title = "Water at rest between slanted walls"
end_time = 0.2
gravity = [0.0, -9.81]

[fluid]
model = "ctvf"
dx = 0.01
bodies = [{ name = "water", polygon = [[-0.05, 0.0], [0.05, 0.0], [0.20, 0.15], [-0.15, 0.15]] }]

[[walls]]
name = "tank"
polyline = [[-0.25, 0.3], [-0.05, 0.0], [0.05, 0.0], [0.35, 0.3]]

[[probes]]
name = "fastest"
quantity = "max-speed"
body = "water"

[[probes]]
name = "weight"
quantity = "force-y"
body = "tank"

[[probes]]
name = "sideways"
quantity = "force-x"
body = "tank"

[[probes]]
name = "leaked"
quantity = "leaked"

[output]
frames = 1
average_from = 0.1
"""

PISTON = """\
schema = 1
title = "A wall pushes water along a channel with a slanted end"
end_time = 0.4
gravity = [0.0, -9.81]

[fluid]
model = "wcsph"
dx = 0.01
bodies = [{ name = "water", polygon = [[0.0, 0.0], [0.4, 0.0], [0.5, 0.1], [0.0, 0.1]] }]

[[walls]]
name = "channel"
polyline = [[-0.1, 0.0], [0.4, 0.0], [0.7, 0.3]]

[[walls]]
name = "piston"
polyline = [[0.0, 0.3], [0.0, 0.0]]
motion = { times = [0.0, 0.4], translation = [[0.0, 0.0], [0.1, 0.0]] }

[[probes]]
name = "leaked"
quantity = "leaked"

[output]
frames = 1
"""


def test_slanted_walls_hold_still_water(tmp_path):
    """Faces cut the lattice anywhere; no particle may start on one, where it is shot off at a good part of √(2gH)."""
    run_alone(scene_of(FUNNEL, tmp_path), "mine", "fluid", make_model, tmp_path / "run", 1, quiet=True)
    probes = json.loads((tmp_path / "run" / "result.json").read_text())["probes"]
    weight = 1000.0 * G * 0.15 * 0.5 * (0.1 + 0.35)
    assert probes["fastest"]["max"] < 0.2 * math.sqrt(2.0 * G * 0.15)
    assert probes["weight"]["mean"] == pytest.approx(-weight, rel=0.03)
    assert abs(probes["sideways"]["mean"]) < 0.02 * weight
    assert probes["leaked"]["max"] == 0.0


def test_a_piston_drives_no_water_through_walls(tmp_path):
    """A moving wall over a fixed floor, and a beach of 45°: all particles stay before both."""
    run_alone(scene_of(PISTON, tmp_path), "mine", "fluid", make_model, tmp_path / "run", 1, quiet=True)
    _, frame = read_frame(tmp_path / "run" / "fluid.vtkhdf")
    x, y = frame.position.T
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert result["probes"]["leaked"]["final"] == 0.0
    assert x.min() > 0.1
    assert y.min() > 0.0
    assert np.all(y > x - 0.4 - 0.2 * 0.01)  # a fifth of a particle, of those that crowd on the slanted face
    # The channel is 0.1 m shorter, so the level has risen; the volume has not changed.
    assert y.max() > 0.11
    assert frame.fields["density"].mean() == pytest.approx(1000.0, rel=0.01)
