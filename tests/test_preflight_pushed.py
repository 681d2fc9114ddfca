"""Pre-flight of structures that are pushed along their length, all at once, or that their particles do not fill."""

from __future__ import annotations

import math

import pytest

from coupler.preflight.bounds.error import error_bound
from coupler.preflight.bounds.solid import not_bounded, of_structure
from coupler.preflight.ladder import ladder
from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.measures.pressed import law_error, with_law
from coupler.preflight.rules.findings import findings
from tests.preflights import verdicts_of
from tests.scenes import scene_of
from tests.test_preflight_structures import AT_ONE_END, CLAMPED

BAR = (*AT_ONE_END, "solid.youngs_modulus=1e7", "solid.damping=0", "end_time=0.0816", "output.average_from=0")
PULLED = 'solid.loads=[{ body = "plate", face = "right", traction = [1000.0, 0.0] }]'
SIDEWAYS = ("probes.p.quantity=displacement-x", PULLED)
FINE = "solid.dx=0.0125"
ENERGY = "probes=[{ name = 'p', quantity = 'strain-energy', body = 'plate' }]"
FLIES = (
    "solid.bodies.plate.rectangle=[0.0, 0.0, 1.0, 0.05]",
    "solid.bodies.plate.velocity=[-0.1, 0.0]",
    "solid.poisson_ratio=0.3",
    "solid.loads=[]",
    "probes.p.quantity=displacement-x",
    "probes.p.point=[1.0, 0.025]",
    "solid.dx=0.0125",
    "end_time=0.01717",
)
GEL = (
    "solid.bodies.plate.rectangle=[0.0, 0.0, 1.0, 0.25]",
    'solid.clamps=[{ body = "plate", face = "bottom" }]',
    "probes.p.point=[0.5, 0.25]",
)
BLOCK = (
    "solid.bodies.plate.rectangle=[0.0, 0.0, 0.1, 0.1]",
    'solid.clamps=[{ body = "plate", face = "bottom" }]',
    "probes.p.point=[0.05, 0.1]",
    'solid.loads=[{ body = "plate", face = "right", traction = [-10.0, 0.0] }]',
    "probes.p.quantity=displacement-x",
)
LEDGES = (
    'solid.bodies=[{ name = "plate", polygon = [[0, 0], [0.06, 0], [0.94, 0], [1, 0], [1, 0.1], [0, 0.1]] }]',
    'solid.clamps=[{ body = "plate", face = "edge-0" }, { body = "plate", face = "edge-2" }]',
    "solid.poisson_ratio=0.3",
)
AS_POLYGON = (
    'solid.bodies=[{ name = "plate", polygon = [[0, 0], [1, 0], [1, 0.1], [0, 0.1]] }]',
    'solid.clamps=[{ body = "plate", face = "edge-1" }, { body = "plate", face = "edge-3" }]',
)
IN_A_MODE = (
    *AT_ONE_END,
    "solid.bodies.plate.velocity_mode={ clamped = 'left', mode = 1, tip_speed = 0.01 }",
    "solid.loads=[]",
    "solid.damping=0",
    "solid.poisson_ratio=0.3",
    "solid.youngs_modulus=1e7",
    "end_time=2.0",
)
DISC = (
    'solid.bodies=[{ name = "plate", circle = { centre = [0.0, 0.0], radius = 0.1 }, free = true }]',
    "solid.clamps=[]",
    "solid.loads=[]",
    "gravity=[0.0, -9.81]",
    "solid.dx=0.02",
    "solid.damping=0",
    "goal.statistic=final",
)


def numbers(folder, *sets):
    scene = scene_of(CLAMPED, folder, sets)
    return scene, scene_numbers(scene)


def test_a_bar_swings_along_its_length(tmp_path):
    """c/4L, not the bending frequency, a fifteenth of it: two periods are seen, and its stretch is its deflection."""
    scene, n = numbers(tmp_path, *BAR, *SIDEWAYS, "solid.loads[0].traction=[100.0, 0.0]", "goal.statistic=period", FINE)
    assert n.plate.frequency == pytest.approx(25.0)
    assert n.plate.deflection == pytest.approx(1e-5)
    assert "refuse" not in {f.verdict for f in findings(scene, n)}
    assert 0.00126 <= error_bound(scene, n) <= 4.0 * 0.00126
    bent = numbers(tmp_path, *BAR, "gravity=[0.0, -1.0]", "solid.loads=[]")[1].plate
    assert bent.frequency == pytest.approx(1.615, rel=0.001)


@pytest.mark.parametrize(
    ("sets", "error"),
    [
        (("goal.statistic=max",), 0.0291),
        (("goal.statistic=max", FINE), 0.0238),
        (("goal.statistic=max", FINE, "solid.model=beam"), 0.0100),
        (("goal.statistic=max", "solid.model=beam", "output.probe_interval=0.00204"), 0.0736),
        (("goal.statistic=t_max", FINE, "end_time=0.05"), 0.0078),
        (("goal.statistic=t_max", FINE, "solid.model=beam", "end_time=0.05"), 0.0078),
    ],
)
def test_fronts_are_worn_round(tmp_path, sets, error):
    """A bar that is pulled at once: its end goes to and fro as a saw's tooth, to twice the stretch at rest."""
    assert error <= error_bound(*numbers(tmp_path, *BAR, *SIDEWAYS, *sets)) <= 3.2 * error


@pytest.mark.parametrize(
    ("sets", "error"),
    [
        (("goal.statistic=min",), 0.0361),
        (("goal.statistic=min", "solid.model=ctvf"), 0.0529),
        (("goal.statistic=min", "solid.model=beam"), 0.0125),
        (("goal.statistic=t_min",), 0.0170),
        (("goal.statistic=t_min", "solid.model=beam"), 0.0116),
        (("goal.statistic=max", ENERGY), 0.0500),
        (("goal.statistic=max", ENERGY, "solid.model=ctvf"), 0.0760),
        (("goal.statistic=max", ENERGY, "solid.model=beam"), 0.0113),
    ],
)
def test_a_bar_that_flies_into_its_clamp_is_a_front(tmp_path, sets, error):
    """d'Alembert: v L/c at L/c, all its energy stored."""
    assert error <= error_bound(*numbers(tmp_path, *BAR, *FLIES, *sets)) <= 4.0 * error


def test_fast_modes_of_a_cantilever_that_starts_at_a_speed(tmp_path):
    """The time of its peak was 1.1 % off (beam) and 1.7 %; its reaction 7 to 21 %, under 3 %, and a stress 17 %."""
    start = (*AT_ONE_END, "solid.bodies.plate.velocity=[0.0, 0.01]", "solid.loads=[]", "solid.damping=0")
    start += ("solid.youngs_modulus=1e7", "solid.poisson_ratio=0.3", "end_time=0.36", "output.average_from=0")
    for model, error in (("beam", 0.0107), ("total-lagrangian", 0.0172)):
        found = error_bound(*numbers(tmp_path, *start, "goal.statistic=t_max", f"solid.model={model}"))
        assert error <= found <= 4.0 * error
    for quantity in ("reaction-y", "stress-xx"):
        point = ", point = [0.25, 0.1]" if quantity == "stress-xx" else ""
        probe = f"probes=[{{ name = 'p', quantity = '{quantity}', body = 'plate'{point} }}]"
        for statistic in ("min", "period"):
            assert math.isinf(error_bound(*numbers(tmp_path, *start, f"goal.statistic={statistic}", probe)))
    assert math.isinf(error_bound(*numbers(tmp_path, *start, "goal.statistic=max", ENERGY)))


def test_fast_modes_of_a_cantilever_that_starts_in_a_mode(tmp_path):
    """Of the thin cantilever, against 150 modes of 2-D elasticity: reactions 30 to 37 % low, stresses 2 to 7 %."""
    for quantity in ("reaction-y", "stress-xx"):
        point = ", point = [0.25, 0.1]" if quantity == "stress-xx" else ""
        probe = f"probes=[{{ name = 'p', quantity = '{quantity}', body = 'plate'{point} }}]"
        assert math.isinf(error_bound(*numbers(tmp_path, *IN_A_MODE, "goal.statistic=max", probe)))
    found = error_bound(*numbers(tmp_path, *IN_A_MODE, "goal.statistic=max", "solid.model=beam"))
    assert 0.0057 <= found <= 4.0 * 0.0057


def test_stresses_under_a_sudden_pressure_show_fast_modes(tmp_path):
    """A beam between two clamps, ten and five times as long as thick: peaks 4.0 and 9.8 % low, told as 2.0 and 7.0; the
    stress crosses the middle of its extremes half as often again as it swings."""
    sudden = ("solid.damping=0", "solid.model=beam", "end_time=1.0")
    for length, nu, error in ((1.0, 0.0, 0.0401), (0.5, 0.3, 0.098)):
        body = (f"solid.bodies.plate.rectangle=[0.0, 0.0, {length}, 0.1]", f"solid.poisson_ratio={nu}")
        probe = f"probes=[{{ name = 'p', quantity = 'stress-xx', body = 'plate', point = [{0.5 * length}, 0.1] }}]"
        assert error <= error_bound(*numbers(tmp_path, *sudden, *body, probe, "goal.statistic=min")) <= 2.0 * error
        assert math.isinf(error_bound(*numbers(tmp_path, *sudden, *body, probe, "goal.statistic=period")))


def test_what_swings_about_nothing_has_no_mean(tmp_path):
    """20 % were told of a mean that was half a percent of the swing, and 51 % off."""
    scene, n = numbers(tmp_path, *IN_A_MODE)
    assert math.isinf(error_bound(scene, n))
    assert any("swings about nothing" in rung.reason for rung in ladder(scene))
    assert math.isfinite(error_bound(*numbers(tmp_path, *IN_A_MODE, ENERGY)))


@pytest.mark.parametrize(("sets", "known"), [(("end_time=1.5",), True), ((), False), (("solid.damping=2",), True)])
def test_times_of_peaks_as_high_as_one_another_have_no_bound(tmp_path, sets, known):
    """0.51 Hz: a second peak may be the largest, or the fifth; 1 to 3 % was told of a time three times as long."""
    sets = (*AT_ONE_END, "solid.damping=0", "end_time=4", "goal.statistic=t_min", "probes.p.point=[1.0, 0.05]", *sets)
    assert math.isfinite(error_bound(*numbers(tmp_path, *sets))) == known


def test_a_ramp_leaves_a_swing_that_feels_the_frequency(tmp_path):
    """Of 1.5 periods, with clamps that hold the width of a beam: 3.2 % off, its energy 4.9, told as 2.8 and 3.4."""
    ramp = 'solid.loads=[{ body = "plate", face = "top", traction = [0.0, -0.1], ramp = 0.393 }]'
    sets = ("solid.bodies.plate.rectangle=[0.0, 0.0, 1.2, 0.1]", "probes.p.point=[0.6, 0.05]", "solid.damping=0")
    sets += ("solid.poisson_ratio=0.45", "solid.model=beam", "end_time=1.3", ramp, "goal.statistic=min")
    assert 0.0319 <= error_bound(*numbers(tmp_path, *sets)) <= 0.06
    assert 0.0492 <= error_bound(*numbers(tmp_path, *sets, "goal.statistic=max", ENERGY)) <= 0.09


def test_a_period_feels_what_clamps_hold_more_than_by_half(tmp_path):
    """A beam between two clamps, ν 0.49, fifteen times as long as thick: 1.45 % too slow, told as 1.38."""
    sets = ("solid.bodies.plate.rectangle=[0.0, 0.0, 1.5, 0.1]", "probes.p.point=[0.75, 0.05]", "solid.damping=0")
    sets += ("solid.poisson_ratio=0.49", "solid.model=beam", "end_time=3.0", "goal.statistic=period")
    assert 0.0145 <= error_bound(*numbers(tmp_path, *sets)) <= 0.03


@pytest.mark.parametrize("load", ["", ", ramp = 1e-4", ", ramp = 1.0"])
def test_a_force_at_the_tip_that_comes_at_once_bears_fast_modes(tmp_path, load):
    """A peak of the reaction was 13 % off at 6 across, under 7 %."""
    sets = (*AT_ONE_END, "goal.statistic=max", "probes=[{ name = 'p', quantity = 'reaction-y', body = 'plate' }]")
    load = f'solid.loads=[{{ body = "plate", face = "right", traction = [0.0, -1.0]{load} }}]'
    assert math.isinf(error_bound(*numbers(tmp_path, *sets, load))) == ("1.0 " not in load.partition("ramp")[2])


def test_a_ramp_starts_less_of_a_swing(tmp_path):
    """A strip pulled at both ends over six of its lengths of sound: 0.9 % off (its edges) under 14 %."""
    pull = 'body = "plate", face = "{}", traction = [{}, 0.0], ramp = 0.06'
    loads = ", ".join(f"{{ {pull.format(*side)} }}" for side in (("left", -100.0), ("right", 100.0)))
    sets = (*BAR, "solid.clamps=[]", "solid.bodies.plate.free=true", f"solid.loads=[{loads}]", SIDEWAYS[0])
    rest, early = (
        error_bound(*numbers(tmp_path, *sets, "end_time=0.14", f"output.average_from={start}"))
        for start in (0.08, 0.05)
    )
    assert rest < 0.025 < 0.09 < early


@pytest.mark.parametrize("model", ["beam", "total-lagrangian"])
def test_what_jumps_with_a_front_has_no_bound(tmp_path, model):
    sets = ("probes.p.quantity=stress-xx", PULLED, "goal.statistic=max", f"solid.model={model}")
    scene, n = numbers(tmp_path, *BAR, *sets)
    assert math.isinf(error_bound(scene, n))
    assert any("give the load a ramp" in rung.reason for rung in ladder(scene))
    assert math.isfinite(error_bound(*numbers(tmp_path, *BAR, *sets, "solid.loads[0].ramp=0.02")))


def test_a_peak_of_a_reaction_shows_fast_modes(tmp_path):
    """A cantilever under a sudden pressure: 3.4 % off with particles, 1.1 % with a beam, by 60 modes in 2-D."""
    sets = (*AT_ONE_END, "solid.youngs_modulus=1e7", "solid.damping=0", "goal.statistic=max", "end_time=1.37")
    probe = "probes=[{ name = 'p', quantity = 'reaction-y', body = 'plate' }]"
    for model, error in (("total-lagrangian", 0.0336), ("beam", 0.0112)):
        found = error_bound(*numbers(tmp_path, *sets, probe, f"solid.model={model}", "solid.dx=0.0166667"))
        assert error <= found <= 4.0 * error


@pytest.mark.parametrize(("share", "verdict"), [(0.3, None), (0.8, "ok"), (0.95, "warn"), (1.1, "warn")])
def test_a_pressed_cantilever_is_soft_and_buckles(tmp_path, share, verdict):
    """Euler's load π² D/4 L²: the swing slows by √(1 − s), errors count 1/(1 − s) times, past it there is no bound."""
    plain, pressure = numbers(tmp_path, *AT_ONE_END)[1].plate, 10.0 * math.pi**2 / 4.0 * 1e6 * 0.1**3 / 12.0
    loads = f'{{ body = "plate", face = "right", traction = [{-share * pressure}, 0.0] }}'
    loads += ', { body = "plate", face = "top", traction = [0.0, 0.01] }'
    scene, n = numbers(tmp_path, *AT_ONE_END, f"solid.loads=[{loads}]")
    assert n.plate.squeeze == pytest.approx(share)
    assert verdicts_of(scene).get("Euler") == verdict
    if share > 1.0:
        assert math.isinf(error_bound(scene, n))
        assert any("buckles" in rung.reason for rung in ladder(scene))
        return
    assert n.plate.frequency == pytest.approx(plain.frequency * math.sqrt(1.0 - share))
    straight = scene_of(CLAMPED, tmp_path, [*AT_ONE_END, "solid.loads[0].traction=[0.0, 0.01]"])
    bent = of_structure(straight, scene_numbers(straight)) / (1.0 - share)
    assert of_structure(scene, n) == pytest.approx(with_law("total-lagrangian", n.plate.strain, bent))


@pytest.mark.parametrize(
    ("modulus", "model", "error", "verdict"),
    [
        (1.5e4, "total-lagrangian", 0.268, "warn"),
        (1.5e4, "ctvf", 0.057, "warn"),
        (5e4, "total-lagrangian", 0.0766, None),
        (1.13e4, "total-lagrangian", math.inf, "refuse"),
    ],
)
def test_a_gel_pressed_by_its_weight_feels_the_law_of_its_model(tmp_path, modulus, model, error, verdict):
    """Four times as wide as high, 8 across, against linear elasticity, s = ρ g H/M; at s = 0.195 it collapsed, by a law
    that bears 0.192."""
    sets = (*GEL, "solid.loads=[]", "gravity=[0.0, -9.81]", "solid.dx=0.03125", "solid.poisson_ratio=0.2")
    scene, n = numbers(tmp_path, *sets, f"solid.youngs_modulus={modulus}", f"solid.model={model}")
    assert verdicts_of(scene).get("strain") == verdict
    assert error <= of_structure(scene, n) <= 4.0 * error


@pytest.mark.parametrize(
    ("modulus", "poisson", "error"), [(1.2e4, 0.0, 0.2521), (1.1e4, 0.2, 0.2460), (1e4, 0.3, 0.2265)]
)
def test_a_clamp_gives_way_more_where_the_law_is_soft(tmp_path, modulus, poisson, error):
    """A bed of gel 4 across under 10 cm of water at rest; the sum of both was bound by 2 % too little."""
    load = 'solid.loads=[{ body = "plate", face = "top", traction = [0.0, -981.0] }]'
    of_gel = (f"solid.youngs_modulus={modulus}", f"solid.poisson_ratio={poisson}", "solid.dx=0.0625")
    scene, n = numbers(tmp_path, *GEL, load, *of_gel)
    assert error <= of_structure(scene, n) <= 4.0 * error


def test_two_clamps_bear_half_of_a_weight_each(tmp_path):
    """Of a bar that its weight pushes along its length; its strain was counted twice."""
    weight = ("solid.loads=[]", "gravity=[9.81, 0.0]")
    one, two = (numbers(tmp_path, *held, *weight)[1].plate for held in (AT_ONE_END, ()))
    assert (one.clamps, two.clamps) == (1, 2)
    assert two.strain == pytest.approx(0.5 * one.strain)


def test_the_law_of_a_model_makes_nothing_of_what_rounding_presses(tmp_path):
    """A plate on edge that is turned to lie: its weight along it is 1e-16 of it, and no bound was left."""
    assert law_error("total-lagrangian", 6e-23) < 1e-12
    assert law_error("total-lagrangian", 0.0) < 1e-12
    assert law_error("total-lagrangian", -1e-8) == pytest.approx(1.5e-8, rel=1e-6)
    drop = (*DISC, "solid.youngs_modulus=1e4", "gravity=[-98.1, 0.0]", "probes.p.point=[0.0, 0.0]")
    assert "strain" not in verdicts_of(numbers(tmp_path, *drop)[0])  # what falls is not pressed


def test_a_peak_of_what_presses_at_once_has_its_reason(tmp_path):
    sets = (*GEL, "solid.loads=[]", "gravity=[0.0, -9.81]", "solid.dx=0.03125", "solid.youngs_modulus=2.5e4")
    scene, n = numbers(tmp_path, *sets, "goal.statistic=min", "solid.damping=0")
    assert of_structure(scene, n) == math.inf
    assert "may give way" in not_bounded(scene, n)


def test_a_cantilever_pressed_at_once_rings_along(tmp_path):
    """By 0.8 of Euler's load: twice that at times, and a period was 23 % off for 5.5 % told; its mean 4.6 for 10.7."""
    pressed = 0.8 * 10.0 * math.pi**2 / 4.0 * 1e6 * 0.1**3 / 12.0
    loads = '{{ body = "plate", face = "right", traction = [{}, 0.0]{} }}, '
    loads += '{{ body = "plate", face = "top", traction = [0.0, 0.01] }}'
    sets = (*AT_ONE_END, "goal.statistic=period", "end_time=10", "solid.damping=0")
    at_once, grown = (f"solid.loads=[{loads.format(-pressed, ramp)}]" for ramp in ("", ", ramp = 0.5"))
    assert "rings along" in not_bounded(*numbers(tmp_path, *sets, at_once))
    assert not not_bounded(*numbers(tmp_path, *sets, grown))


def test_a_hanging_cantilever_is_stiffer_and_a_standing_one_softer(tmp_path):
    """It buckles under 7.837 D/L² of its own weight."""
    for sense in (-1.0, 1.0):
        weight = sense * 0.5 * 7.837 * 1e6 * 0.1**3 / 12.0 / (1000.0 * 0.1)
        squeeze = numbers(tmp_path, *AT_ONE_END, f"gravity=[{weight}, 0.0]")[1].plate.squeeze
        assert squeeze == pytest.approx(-0.5 * sense, rel=0.01)


@pytest.mark.parametrize(
    ("sets", "error"),
    [
        ((*GEL, 'solid.loads=[{ body = "plate", face = "top", traction = [10.0, 0.0] }]', "solid.dx=0.05"), 0.0410),
        ((*GEL, 'solid.loads=[{ body = "plate", face = "top", traction = [10.0, 0.0] }]'), 0.0182),
        ((*GEL, 'solid.loads=[{ body = "plate", face = "top", traction = [0.0, -10.0] }]'), 0.0137),
        ((*BLOCK, "solid.dx=0.0166667"), 0.110),
        ((*BLOCK, "solid.poisson_ratio=0.45", "solid.dx=0.00833333"), 0.0774),
        ((*LEDGES, "solid.dx=0.02"), 0.1858),
        ((*LEDGES, "solid.dx=0.01"), 0.0881),
    ],
)
def test_clamps_on_long_faces_and_ledges(tmp_path, sets, error):
    """Errors of runs that came to rest, against quadratic elements."""
    scene = scene_of(CLAMPED, tmp_path, sets)
    assert error <= of_structure(scene, scene_numbers(scene)) <= 2.5 * error


@pytest.mark.parametrize(("height", "error"), [(0.25, 0.2988), (0.2375, 0.1185), (0.2, 0.0782), (0.125, 0.002)])
def test_a_face_that_bears_a_traction_takes_it_over_three_rows(tmp_path, height, error):
    """A pad pressed by 10 Pa: 7.0, 8.8, 10.8 Pa on its face, half a spacing and two below, at any spacing; pushed along
    it, or of the stress across, nothing is known."""
    pressed = (*GEL, "goal.statistic=final", f"probes.p.point=[0.5, {height}]")
    across = "probes.p.quantity=stress-xx"
    found = of_structure(*numbers(tmp_path, *pressed, "probes.p.quantity=stress-yy"))
    assert error <= found <= max(4.0 * error, 0.15)
    assert math.isinf(of_structure(*numbers(tmp_path, *pressed, across))) == (height > 0.18)
    aside = 'solid.loads=[{ body = "plate", face = "top", traction = [10.0, 0.0] }]'
    assert "judge a way" in not_bounded(*numbers(tmp_path, *pressed, aside, across))


def test_a_pressed_block_swings_over_its_thickness(tmp_path):
    """c_p/4t, and sheared c_s/4t less what bending adds; not a quarter of it, the bending frequency of a free beam."""
    bends = 1.25 * 0.25**2
    for traction, speed in (("[0.0, -10.0]", 10.0 * 10.0**0.5), ("[10.0, 0.0]", 10.0 * (5.0 / (1.0 + bends)) ** 0.5)):
        load = f'solid.loads=[{{ body = "plate", face = "top", traction = {traction} }}]'
        assert numbers(tmp_path, *GEL, load)[1].plate.frequency == pytest.approx(speed)


def test_an_edge_that_is_a_side_holds_as_that_side_does(tmp_path):
    drawn, named = (numbers(tmp_path, *sets)[1].plate for sets in (AS_POLYGON, ()))
    assert (drawn.clamps, drawn.frequency, drawn.deflection) == (2, named.frequency, named.deflection)


def test_area_that_particles_hold_too_much_is_mass(tmp_path):
    """A disc ten particles across is 1.9 % too heavy, rigid or not; where it flies to is not felt."""
    probe = 'probes=[{ name = "p", quantity = "kinetic-energy", body = "plate" }]'
    for model in ("spring", "total-lagrangian"):
        assert 0.0186 <= error_bound(*numbers(tmp_path, *DISC, probe, f"solid.model={model}")) <= 0.04
        flight = 'probes=[{ name = "p", quantity = "displacement-y", body = "plate", point = [0.0, 0.0] }]'
        assert error_bound(*numbers(tmp_path, *DISC, flight, f"solid.model={model}")) <= 1e-9


def test_a_peak_near_resonance_feels_more_of_an_error(tmp_path):
    """Driven at nine tenths of its frequency, damped by a tenth of the critical: 1.4 to 1.6 % off at 6 across."""
    times = [k * 0.01 for k in range(375)]
    factors = [round(math.sin(0.9 * 2.0 * math.pi * 1.605 * t), 4) for t in times]
    load = '{ body = "plate", face = "right", traction = [0.0, 1.0], table = { times = %s, factors = %s } }'
    sets = (*AT_ONE_END, "solid.youngs_modulus=1e7", "solid.damping=2.02", "solid.dx=0.0166667", "end_time=3.74")
    sets += ("goal.statistic=max", "output.average_from=0", f"solid.loads=[{load % (times, factors)}]")
    driven = error_bound(*numbers(tmp_path, *sets))
    still = error_bound(*numbers(tmp_path, *sets[:-1]))
    assert 0.0163 <= driven <= 4.0 * 0.0139
    assert driven > 1.5 * still


@pytest.mark.parametrize(("model", "errors"), [("beam", (0.0160, 0.0307)), ("total-lagrangian", (0.0651, 0.0904))])
def test_a_clamp_that_shakes_a_plate_near_resonance_is_counted(tmp_path, model, errors):
    """At nine tenths of its frequency for 13 periods, damped by a fifteenth of the critical and not at all: errors of
    the tip's peak against modes of quadratic elements."""
    driven = 0.9 * 1.6836
    times = [k / (20.0 * driven) for k in range(int(8.528 * 20.0 * driven) + 1)]
    way = [[0.0, round(1e-3 * (1.0 - math.cos(2.0 * math.pi * driven * t)), 9)] for t in times]
    clamp = f'solid.clamps=[{{ body = "plate", face = "left", motion = {{ times = {times}, translation = {way} }} }}]'
    sets = (*AT_ONE_END, "solid.loads=[]", "solid.poisson_ratio=0.3", "solid.youngs_modulus=1e7", "goal.statistic=max")
    sets += (clamp, f"solid.model={model}", "end_time=8.528", "output.average_from=0")
    for damping, error in zip((0.7036, 0.0), errors, strict=True):
        assert error <= error_bound(*numbers(tmp_path, *sets, f"solid.damping={damping}")) <= 4.0 * error


def test_a_plate_that_bends_draws_in_by_the_square(tmp_path):
    """Tip forces of EI/L² and 4 EI/L²: a beam's way along is wrong by 0.2 to 0.4 %, across by 0.03 to 0.1 %."""
    load = 'solid.loads=[{ body = "plate", face = "right", traction = [0.0, 100.0] }]'
    across, along = (
        of_structure(*numbers(tmp_path, *AT_ONE_END, load, "solid.model=beam", f"probes.p.quantity=displacement-{d}"))
        for d in "yx"
    )
    assert along == pytest.approx(2.0 * across)


@pytest.mark.parametrize("model", ["total-lagrangian", "ctvf"])
def test_particles_of_a_spun_ring_have_too_much_inertia(tmp_path, model):
    """A ring 40 particles across: 1.17 % more angular momentum than its shape has, with 0.6 % more area."""
    circles = ", ".join(f"{{ circle = {{ centre = [0, 0], radius = {radius} }} }}" for radius in (0.2, 0.1))
    body = f'solid.bodies=[{{ name = "plate", difference = [{circles}], free = true, spin = 20.0 }}]'
    probe = "probes=[{ name = 'p', quantity = 'angular-momentum', body = 'plate' }]"
    sets = (*DISC, body, probe, "gravity=[0, 0]", "solid.dx=0.01", f"solid.model={model}")
    found = error_bound(*numbers(tmp_path, *sets))
    assert 0.01171 <= found <= 0.03


@pytest.mark.parametrize(
    ("quantity", "height", "sets", "error", "most"),
    [
        ("stress-xy", 0.05, ("solid.dx=0.025", "solid.poisson_ratio=0.45"), 0.1636, 4.0),
        ("stress-xy", 0.075, ("solid.dx=0.0125",), 0.0680, 4.0),
        ("stress-xy", 0.05, ("solid.dx=0.0125",), 0.0178, 8.0),
        ("stress-yy", 0.075, ("solid.dx=0.025",), 0.0976, 4.0),
        ("von-mises", 0.05, ("solid.dx=0.025",), 0.1654, 4.0),
        ("stress-yy", 0.075, ("solid.model=beam",), 1.02, math.inf),
    ],
)
def test_stresses_across_a_plate_and_sheared_are_bound_wider(tmp_path, quantity, height, sets, error, most):
    """Half-way along a cantilever under a pressure that has come to rest, against σ_xy = 3V/2t (1 − 4y²/t²) and σ_yy =
    −q/2 (1 + 3y/t − 4y³/t³); the outer fibre's σ_xx is 0.5 % off."""
    sets = (*AT_ONE_END, "solid.poisson_ratio=0.3", *sets, f"probes.p.quantity={quantity}")
    sets += (f"probes.p.point=[0.5, {height}]",)
    assert error <= of_structure(*numbers(tmp_path, *sets)) <= most * error
    along = of_structure(*numbers(tmp_path, *sets, "probes.p.quantity=stress-xx", "probes.p.point=[0.5, 0.1]"))
    assert 0.0046 <= along <= 0.05


def test_a_beam_has_no_stress_across_it(tmp_path):
    scene = numbers(tmp_path, *AT_ONE_END, "probes.p.quantity=stress-yy", "solid.model=beam")[0]
    assert any("no stress across it" in rung.reason for rung in ladder(scene) if rung.solid == "beam")
    upright = 'solid.bodies=[{ name = "plate", rectangle = [0.0, 0.0, 0.1, 1.0] }]'
    foot = (
        'solid.clamps=[{ body = "plate", face = "bottom" }]',
        "solid.loads[0].face=left",
        "probes.p.point=[0.05, 0.5]",
    )
    turned = numbers(tmp_path, *AT_ONE_END, upright, *foot, "probes.p.quantity=stress-yy", "solid.model=beam")
    assert of_structure(*turned) < 0.05
    at_its_tip = (*AT_ONE_END, upright, *foot[:2], "probes.p.point=[0.05, 1.0]", "probes.p.quantity=stress-yy")
    assert of_structure(*numbers(tmp_path, *at_its_tip, "solid.model=beam")) == math.inf  # where none is left


@pytest.mark.parametrize("model", ["beam", "total-lagrangian"])
def test_what_clamps_bear_of_dead_loads_is_their_sum(tmp_path, model):
    """Found: 4e-10 of 2 N/m or less at the end of runs of both models, 4 across, that came to rest; a hanging bar's
    mean, swing and all, is 0.07 % off."""
    probe = "probes=[{ name = 'p', quantity = 'reaction-y', body = 'plate' }]"
    assert of_structure(*numbers(tmp_path, *AT_ONE_END, probe, f"solid.model={model}")) <= 0.003
    follows = "solid.loads[0].following=true"
    assert of_structure(*numbers(tmp_path, *AT_ONE_END, probe, follows)) > 0.01
