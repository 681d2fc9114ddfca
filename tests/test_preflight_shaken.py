"""Pre-flight of water in which something is moved by a time table: its sound speed, and forces on what is moved."""

from __future__ import annotations

import math

import pytest

from coupler.preflight.ladder import ladder
from shared.expected_speed import driven_speed, sound_speed
from shared.geometry.motion_table import largest_speed
from shared.geometry.shakers import shakers
from tests.preflights import bound_of, said_of, verdicts_of
from tests.scenes import scene_of

SHAKEN = """\
schema = 1
title = "A block shaken in a box of water"
end_time = 2.0
[fluid]
model = "wcsph"
dx = 0.01
h_over_dx = 2.0
alpha = 0.05
bodies = [{ name = "water", difference = [{ rectangle = [-0.1, -0.1, 0.1, 0.1] },
  { rectangle = [-0.04, -0.04, 0.04, 0.04] }] }]
[[walls]]
name = "box"
polyline = WALL
[solid]
model = "rigid"
dx = 0.01
density = 1000.0
bodies = [{ name = "block", rectangle = [-0.04, -0.04, 0.04, 0.04] }]
[solid.motion]
times = TIMES
translation = WAYS
[[probes]]
name = "push"
body = "block"
quantity = "force-x"
[goal]
probe = "push"
statistic = "max"
error = 0.3
"""
TWO = """\
[solid]
model = "total-lagrangian"
dx = 0.01
density = 1000.0
youngs_modulus = 1e6
bodies = [{ name = "flap", rectangle = [-0.04, -0.04, 0.04, 0.04] },
  { name = "far", rectangle = [10.0, 0.0, 10.08, 0.08] }]
clamps = [{ body = "flap", face = "left", motion = { times = [0.0, 1.0, 2.0], rotation = [0.0, 90.0, 0.0] } },
  { body = "far", face = "left" }]
"""
BOX = "[[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]\nclosed = true"
TANK = "[[-0.1, 0.3], [-0.1, -0.1], [0.1, -0.1], [0.1, 0.3]]"
OMEGA = 4.0 * math.pi


def eased(time: float) -> float:
    """A sine that starts gently, over a period."""
    grown = min(time, 1.0)
    return math.sin(OMEGA * time) * grown**3 * (10.0 - 15.0 * grown + 6.0 * grown**2)


def shaken(folder, way=0.005, start=eased, sets=(), wall=BOX):
    times = [0.0125 * k for k in range(161)]
    ways = [[way * start(time), 0.0] for time in times]
    return scene_of(SHAKEN.replace("TIMES", str(times)).replace("WAYS", str(ways)).replace("WALL", wall), folder, sets)


def test_water_that_is_shaken_tells_its_sound_speed(tmp_path):
    """At ten times the speed of the block, 0.63 m/s, runs ended, not weakly compressible any more, bound by 7 %."""
    pressed = math.sqrt(2.0 * OMEGA * 0.02 * OMEGA * 0.2)
    assert sound_speed(shaken(tmp_path, 0.02)) == pytest.approx(10.0 * pressed, rel=0.03)
    assert sound_speed(shaken(tmp_path, 1e-4)) == pytest.approx(2.5 * OMEGA * 0.2, rel=0.03), "crossed in 0.4 rad"
    assert verdicts_of(shaken(tmp_path))["Mach"] == "ok"
    assert verdicts_of(shaken(tmp_path, sets=["fluid.sound_speed=0.63"]))["Mach"] == "refuse"


def test_what_stands_still_shakes_nothing(tmp_path):
    found = said_of(shaken(tmp_path, 0.0, sets=["fluid.sound_speed=10.0"]))["Mach"]
    assert found.reason.startswith("up to 0 m/s")


def test_what_shakes_water_slowly_leaves_its_sound_speed(tmp_path):
    weighs = shaken(tmp_path, 1e-3, sets=["gravity=[0.0, -9.81]"], wall=TANK)
    assert sound_speed(weighs) == pytest.approx(10.0 * math.sqrt(2.0 * 9.81 * 0.2))


@pytest.mark.parametrize(
    ("start", "way", "found", "jolt"),
    [
        (eased, 1e-3, 0.0485, "ok"),
        (lambda time: 1.0 - math.cos(OMEGA * time), 1e-3, 0.535, "warn"),
        (lambda time: math.sin(OMEGA * time), 1e-3, 3.57, "warn"),
    ],
)
def test_a_motion_that_starts_with_a_jump_rings(tmp_path, start, way, found, jolt):
    """`found`: largest forces against 10.8 kg/m of added mass times the largest acceleration; 7.5 % were told."""
    scene = shaken(tmp_path, way, start)
    assert found <= bound_of(scene) < max(4.2 * found, 0.1)
    assert verdicts_of(scene)["jolt"] == jolt
    mean = shaken(tmp_path, way, start, ["goal.statistic=mean"])
    assert verdicts_of(mean)["jolt"] == "ok"


def test_a_steady_motion_has_no_push_to_ring_beside(tmp_path):
    """However its table is rounded: 3e10 was told, and a reason that was another's."""
    steady = shaken(tmp_path, 0.1, lambda time: time)
    assert max(one.jolt(sound_speed(steady)) for one in shakers(steady)) == math.inf
    assert any("jumps to its speed" in rung.reason for rung in ladder(steady))


def test_a_clamp_moves_its_own_body(tmp_path):
    """A flap that turns by a quarter in a second, and another 10 m away: 24 m/s were expected."""
    scene = scene_of(SHAKEN.split("[solid]")[0].replace("WALL", BOX) + TWO, tmp_path)
    assert driven_speed(scene) == pytest.approx(largest_speed(scene.solid.clamps[0].motion, [[0.04, 0.04]]))


def test_a_lattice_that_melts_makes_a_full_box_ring(tmp_path):
    """Largest forces were 75 % (wcsph), 40 % (ctvf) too large, and 30 % at half the spacing; 7.5, 2.5, 3.8 % told."""
    for sets in ([], ["fluid.model=ctvf"], ["fluid.dx=0.005"]):
        assert bound_of(shaken(tmp_path, sets=sets)) == math.inf
    assert any("full box rings" in rung.reason for rung in ladder(shaken(tmp_path, 0.011)))
    open_above = shaken(tmp_path, sets=["gravity=[0.0, -9.81]"], wall=TANK)
    assert 0.2 < bound_of(open_above) < 0.75, "its surface lets sound out; deeper blocks are dragged and held as told"


def test_a_full_box_that_a_wall_squeezes_is_pulled_apart(tmp_path):
    """Found: pressures on a closed column's end 22 % (wcsph), 100 % (ctvf) too large, 240 and 130 % with h = 2 dx,
    where a piston moves by a fifth of dx, and 10 % at a fiftieth; 12 and 7 % were told."""
    times = [0.0125 * k for k in range(161)]
    rest = '[[walls]]\nname = "rest"\npolyline = [[-0.12, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.12, 0.1]]\n[[probes]]'

    def squeezed(way, *sets):
        text = SHAKEN.split("[solid]")[0].replace(", difference", ", rectangle = [-0.1, -0.1, 0.1, 0.1] }]\n#")
        text = text.replace("\n  { rectangle", "\n# { rectangle").replace("WALL", "[[-0.1, 0.14], [-0.1, -0.14]]")
        motion = f"motion = {{ times = {times}, translation = {[[way * eased(time), 0.0] for time in times]} }}\n"
        probe = SHAKEN[SHAKEN.index("[[probes]]") :].replace('"block"', '"rest"')
        return scene_of(text + motion + probe.replace("[[probes]]", rest), tmp_path, sets)

    for sets in ([], ["fluid.model=ctvf"], ["fluid.h_over_dx=1.3"]):
        assert bound_of(squeezed(2e-3, *sets)) == math.inf
    assert any("a wall squeezes" in rung.reason for rung in ladder(squeezed(2e-3)))
    assert bound_of(squeezed(2e-4)) < 0.2


def test_what_shakes_water_faster_than_its_sound_has_no_bound(tmp_path):
    scene = shaken(tmp_path, 1e-3, sets=["fluid.sound_speed=1.5"])
    assert bound_of(scene) == math.inf
    assert any("faster than its sound" in rung.reason for rung in ladder(scene))


def test_what_is_moved_through_particles_that_nothing_shifts_has_no_bound(tmp_path):
    """Found: a cylinder in a deep tank whose force jumped to five times its size after 2.4 to 2.9 dx; 1.9 % told."""

    def told(way, *sets):
        scene = shaken(tmp_path, way, lambda time: (0.5 * time) ** 4, ["gravity=[0.0, -9.81]", *sets], TANK)
        return math.isfinite(bound_of(scene)), verdicts_of(scene)["h/dx"]

    assert told(0.015) == (True, "ok")
    assert told(0.025) == (False, "warn")
    assert told(0.025, "fluid.model=ctvf") == (True, "ok")
    assert told(0.025, "fluid.h_over_dx=1.3")[0]
    deep = shaken(tmp_path, 0.055, lambda time: (0.5 * time) ** 4, ["gravity=[0.0, -9.81]"], TANK)
    assert any("pressed into what is moved" in rung.reason for rung in ladder(deep))


DEEP = (
    SHAKEN.replace("[-0.1, -0.1, 0.1, 0.1]", "[-0.2, -0.2, 0.2, 0.2]")
    .replace("0.04", "0.05")
    .replace("WALL", "[[-0.2, 0.4], [-0.2, -0.2], [0.2, -0.2], [0.2, 0.4]]")
    .replace("end_time = 2.0", "end_time = 2.0\ngravity = [0.0, -9.81]")
    .replace("alpha = 0.05", "alpha = 0.1")
)


def moved_deep(folder, way, *sets):
    """`way` [m] of a time [s], of a block 10 spacings wide and 20 deep in a tank four times as wide."""
    times = [0.0125 * k for k in range(161)]
    text = DEEP.replace("TIMES", str(times)).replace("WAYS", str([[way(time), 0.0] for time in times]))
    return scene_of(text, folder, sets)


@pytest.mark.parametrize(
    ("rate", "way", "sets", "found"),
    [
        (1.0, 0.005, ["fluid.h_over_dx=1.3"], 2.64),
        (1.0, 0.005, [], 1.36),
        (4.0, 0.005, [], 0.266),
        (4.0, 0.001, [], 0.259),
        (4.0, 0.005, ["fluid.model=ctvf", "fluid.alpha=0.01"], 0.21),
        (4.0, 0.02, ["fluid.h_over_dx=1.3"], 0.357),
    ],
)
def test_water_holds_and_drags_a_block_that_is_moved_to_and_fro(tmp_path, rate, way, sets, found):
    """`found`: largest forces against potential flow's 1.276 ρ A times the largest acceleration; 0.2 to 0.89 told."""

    def swung(time):
        return way * eased(0.5 * rate * time) if time < 2.0 / rate else way * math.sin(2.0 * math.pi * rate * time)

    assert found <= bound_of(moved_deep(tmp_path, swung, *sets)) < 4.0 * found


def test_ways_either_way_press_particles_into_what_is_moved(tmp_path):
    """Found: a block moved by 1.5 spacings to and fro, whose largest force was 70 % too large; 0.6 told."""
    assert bound_of(moved_deep(tmp_path, lambda time: 0.015 * eased(time))) == math.inf


def test_what_goes_on_in_water_is_dragged_and_held(tmp_path):
    """Means found: the lift of a block 4.7 % (0.05 m/s) and 13 % (0.2 m/s, wcsph) off; 1.3 and 3.8 % told. Its drag is
    all artificial: 2.9 N/m at 0.05 m/s."""
    few = ["fluid.model=ctvf", "fluid.h_over_dx=1.3", "goal.statistic=mean", "output.average_from=0.6"]

    def slow(time):
        return 0.05 * time

    assert 0.047 < bound_of(moved_deep(tmp_path, slow, *few, "probes.push.quantity=force-y")) < 4 * 0.047
    drag = moved_deep(tmp_path, slow, *few)
    assert bound_of(drag) == math.inf
    assert any("all of the force is artificial" in rung.reason for rung in ladder(drag))


def test_what_falls_with_its_tank_weighs_less(tmp_path):
    """Found: the lift of a block in a tank that falls at g/2 0.08 % off; 320 % told, as if it went on in its water."""

    def told(acceleration):
        text = DEEP.replace("[solid]\n", "[walls.motion]\ntimes = TIMES\ntranslation = WAYS\n[solid]\n")
        times = [0.025 * k for k in range(81)]
        text = text.replace("TIMES", str(times))
        text = text.replace("WAYS", str([[0.0, -0.5 * acceleration * time**2] for time in times]))
        sets = ["fluid.model=ctvf", "goal.statistic=mean", "output.average_from=0.3", "probes.push.quantity=force-y"]
        return bound_of(scene_of(text, tmp_path, sets))

    assert 0.0008 < told(4.905) < 0.03
    assert told(9.0) == math.inf
