"""Scenes that ship with nobody: each from the documented keys alone, judged by a balance that its physics must keep."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from coupler.run import run_coupled
from fluid_solver.models import make_model
from shared.contract import ShearwaterError
from shared.geometry.particles import fill
from shared.run.vtkhdf import read_frame
from shared.schema.geometry import Domain
from shared.solo import run_alone
from tests.scenes import scene_of

pytestmark = pytest.mark.timeout(240)  # the first run compiles

THREADS = {"fluid": 1, "solid": 1}
G = 9.81

FLOATING_BOX = """\
schema = 1
title = "A box of half the density of water, let go at its draught"
end_time = 0.4
gravity = [0.0, -9.81]

[fluid]
model = "wcsph"
dx = 0.01

[[fluid.bodies]]
name = "water"
difference = [{ rectangle = [0.0, 0.0, 0.4, 0.15] }, { rectangle = [0.15, 0.11, 0.25, 0.19] }]

[[walls]]
name = "tank"
polyline = [[0.0, 0.4], [0.0, 0.0], [0.4, 0.0], [0.4, 0.4]]

[solid]
model = "spring"
dx = 0.01
density = 500.0
bodies = [{ name = "box", rectangle = [0.15, 0.11, 0.25, 0.19], free = true }]

[[probes]]
name = "x"
quantity = "displacement-x"
body = "box"
point = [0.2, 0.15]

[[probes]]
name = "y"
quantity = "displacement-y"
body = "box"
point = [0.2, 0.15]

[[probes]]
name = "lift"
quantity = "force-y"
body = "box"

[[probes]]
name = "leaked"
quantity = "leaked"

[output]
frames = 2
average_from = 0.1
"""

DROP_ON_A_BEAM = """\
schema = 1
title = "A round drop in free fall hits a clamped beam"
end_time = 0.06
gravity = [0.0, -9.81]

[fluid]
model = "ctvf"
dx = 4.0e-3
sound_speed = 20.0
initial_pressure = "zero"
bodies = [{ name = "drop", circle = { centre = [0.0, 0.05], radius = 0.03 }, velocity = [0.0, -1.0] }]

[solid]
model = "total-lagrangian"
dx = 4.0e-3
density = 1000.0
youngs_modulus = 1.0e7
bodies = [{ name = "beam", rectangle = [-0.12, -0.016, 0.12, 0.0] }]
clamps = [{ body = "beam", face = "left" }, { body = "beam", face = "right" }]
gravity = false

[[probes]]
name = "mid_y"
quantity = "displacement-y"
body = "beam"
point = [0.0, -0.008]

[[probes]]
name = "push"
quantity = "force-y"
body = "beam"

[[probes]]
name = "leaked"
quantity = "leaked"

[output]
frames = 2
"""

PLATE_BETWEEN_TWO_LEVELS = """\
schema = 1
title = "A plate between two levels of water"
end_time = 0.05
gravity = [0.0, -9.81]

[fluid]
model = "wcsph"
dx = {fluid_dx}
bodies = [
    {{ name = "high", rectangle = [0.0, 0.0, 0.09, 0.078] }},
    {{ name = "low", rectangle = [0.108, 0.0, 0.198, 0.048] }},
]

[[walls]]
name = "tank"
polyline = [[0.0, 0.2], [0.0, 0.0], [0.198, 0.0], [0.198, 0.2]]

[solid]
model = "total-lagrangian"
dx = {solid_dx}
density = 2000.0
youngs_modulus = 1.0e8
bodies = [{{ name = "plate", rectangle = [0.09, 0.0, 0.108, 0.12] }}]
clamps = [{{ body = "plate", face = "bottom" }}]

[[probes]]
name = "push"
quantity = "force-x"
body = "plate"

[[probes]]
name = "weight"
quantity = "force-y"
body = "tank"

[[probes]]
name = "leaked"
quantity = "leaked"

[output]
frames = 1
average_from = 0.01
"""

DROP_ON_A_GEL = """\
schema = 1
title = "A drop falls on a gel strip, a millimetre"
end_time = 1.5e-4
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 2.0e-5
viscosity = 1.0e-6
bodies = [{ name = "drop", circle = { centre = [5.0e-4, 4.0e-4], radius = 2.0e-4 }, velocity = [0.0, -1.0] }]
[[walls]]
name = "tray"
polyline = [[-1.0e-3, 1.0e-3], [-1.0e-3, -1.0e-3], [2.0e-3, -1.0e-3], [2.0e-3, 1.0e-3]]
[solid]
model = "ctvf"
dx = 2.0e-5
density = 1050.0
youngs_modulus = 5.0e4
poisson_ratio = 0.4
bodies = [{ name = "gel", rectangle = [0.0, 0.0, 1.0e-3, 1.0e-4] }]
clamps = [{ body = "gel", face = "left" }, { body = "gel", face = "right" }]
[[probes]]
name = "mid"
body = "gel"
point = [5.0e-4, 1.0e-4]
quantity = "displacement-y"
[[probes]]
name = "leaked"
quantity = "leaked"
[output]
frames = 1
"""

MERCURY_ON_RUBBER = """\
schema = 1
title = "Mercury on a rubber membrane floor"
end_time = 0.06
gravity = [0.0, -9.81]
[fluid]
model = "wcsph"
dx = 2.5e-3
density = 13600.0
h_over_dx = 2.0
bodies = [{ name = "mercury", rectangle = [0.0, 0.0, 0.1, 0.05] }]
[[walls]]
name = "left"
polyline = [[0.0, 0.1], [0.0, -0.012]]
[[walls]]
name = "right"
polyline = [[0.1, -0.012], [0.1, 0.1]]
[solid]
model = "total-lagrangian"
dx = 2.5e-3
density = 1200.0
youngs_modulus = 1.0e8
poisson_ratio = 0.45
damping = 100.0
bodies = [{ name = "floor", rectangle = [0.0, -0.01, 0.1, 0.0] }]
clamps = [{ body = "floor", face = "left" }, { body = "floor", face = "right" }]
[[probes]]
name = "mid"
body = "floor"
point = [0.05, -0.005]
quantity = "displacement-y"
[output]
frames = 1
average_from = 0.03
"""


def coupled(tmp_path, text: str) -> dict:
    run_coupled(scene_of(text, tmp_path), "mine", tmp_path / "run", THREADS, quiet=True, link="inprocess")
    return json.loads((tmp_path / "run" / "result.json").read_text())


def test_a_box_floats_at_its_draught(tmp_path):
    """Archimedes: the water carries the box's weight, and neither side gains from the other."""
    result = coupled(tmp_path, FLOATING_BOX)
    probes = result["probes"]
    weight = 0.1 * 0.08 * 500.0 * G
    assert probes["lift"]["mean"] == pytest.approx(weight, rel=0.05)
    assert abs(probes["y"]["final"]) < 0.006  # little over half a particle
    assert max(abs(probes["x"]["min"]), probes["x"]["max"]) < 1e-3
    assert probes["leaked"]["max"] == 0.0
    assert result["ledger"]["energy_injected_fraction"] < 0.2


def test_a_drop_gives_its_momentum_to_a_beam(tmp_path):
    """Impulse on the beam = momentum that the water has lost, weight included; nothing pulls before it touches."""
    result = coupled(tmp_path, DROP_ON_A_BEAM)
    with (tmp_path / "run" / "ledger.csv").open() as file:
        ledger = np.genfromtxt(file, delimiter=",", names=True)
    before = ledger["t"] < 0.012  # 20 mm less the kernel's reach, at 1 m/s
    assert np.all(ledger["force_fluid_y"][before] == 0.0)
    _, frame = read_frame(tmp_path / "run" / "fluid.vtkhdf")
    mass = 1000.0 * 4.0e-3**2  # of a particle, per metre
    momentum_end = mass * frame.fields["velocity"].sum(axis=0)
    total = mass * len(frame.position)
    assert total == pytest.approx(1000.0 * math.pi * 0.03**2, rel=0.05)
    lost = momentum_end[1] - (-1.0 * total - G * total * 0.06)
    assert -ledger["impulse_fluid_y"][-1] == pytest.approx(lost, rel=0.02)
    assert -ledger["impulse_fluid_y"][-1] > 0.5 * total
    assert abs(ledger["impulse_fluid_x"][-1]) < 1e-3 * lost
    assert result["probes"]["mid_y"]["min"] < -1e-4
    assert result["probes"]["leaked"]["max"] == 0.0


@pytest.mark.parametrize(("fluid_dx", "solid_dx"), [(2.0e-3, 6.0e-3), (6.0e-3, 2.0e-3)])
def test_resolutions_three_times_apart_either_way(tmp_path, fluid_dx, solid_dx):
    """Both levels press on the plate by ρ g (h₁² − h₂²)/2, the tank carries the water's weight."""
    result = coupled(tmp_path, PLATE_BETWEEN_TWO_LEVELS.format(fluid_dx=fluid_dx, solid_dx=solid_dx))
    probes = result["probes"]
    assert probes["push"]["mean"] == pytest.approx(0.5 * 1000.0 * G * (0.078**2 - 0.048**2), rel=0.06)
    assert probes["weight"]["mean"] == pytest.approx(-1000.0 * G * 0.09 * (0.078 + 0.048), rel=0.05)
    assert probes["leaked"]["max"] == 0.0
    assert result["ledger"]["mapping_error"] < 1e-12


def test_a_drop_of_millimetres_does_not_turn_a_gel_inside_out(tmp_path):
    """In an iterated window of four fluid steps the impact would throw the gel's face two particles far."""
    result = coupled(tmp_path, DROP_ON_A_GEL)
    assert result["cost"]["coupling"]["scheme"] == "serial-implicit"
    assert -5.0e-5 < result["probes"]["mid"]["min"] < -1.0e-6  # no further than the drop would come in 0.05 ms
    assert abs(result["ledger"]["work_error"]) < 1e-3


def test_an_impact_in_a_long_iterated_window_is_named(tmp_path):
    """The same in windows of four fluid steps."""
    with pytest.raises(ShearwaterError, match=r"The solid failed at t = .* reference position"):
        coupled(tmp_path, DROP_ON_A_GEL.replace("[output]", "[coupling]\nwindow = 1.02e-5\n\n[output]"))


def test_mercury_rests_on_a_membrane_lighter_than_a_layer_of_it(tmp_path):
    """A clamped Timoshenko beam under ρ g h and its own weight; the floor's acceleration is left out of its ghosts."""
    result = coupled(tmp_path, MERCURY_ON_RUBBER)
    load, length, thick = G * (13600.0 * 0.05 + 1200.0 * 0.01), 0.1, 0.01
    bending = load * length**4 / (384.0 * 1.0e8 / (1.0 - 0.45**2) * thick**3 / 12.0)
    shear = load * length**2 / (8.0 * 5.0 / 6.0 * 1.0e8 / 2.9 * thick)
    assert result["probes"]["mid"]["mean"] == pytest.approx(-bending - shear, rel=0.1)


def test_water_that_left_the_domain_is_not_shown(tmp_path):
    """Half of a drop has fallen out of the domain: it is counted as leaked and in no frame."""
    scene = scene_of(DROP_ON_A_BEAM, tmp_path)
    changes = {
        "solid": None,
        "end_time": 0.04,
        "domain": Domain(lower=(-0.1, 0.0), upper=(0.1, 0.2)),
        "probes": [probe for probe in scene.probes if probe.name == "leaked"],
    }
    scene = scene.model_copy(update=changes)
    run_alone(scene, "mine", "fluid", make_model, tmp_path / "run", 1, quiet=True)
    leaked = json.loads((tmp_path / "run" / "result.json").read_text())["probes"]["leaked"]["final"]
    _, frame = read_frame(tmp_path / "run" / "fluid.vtkhdf")
    count = len(fill(scene.fluid.bodies[0], scene.fluid.dx).position)
    assert 0.3 * count < leaked < 0.9 * count
    assert len(frame.position) == count - leaked
    assert frame.position[:, 1].min() > 0.0
