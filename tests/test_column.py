"""Columns of water: exact whatever the steps, where they stand, what they weigh; they do not run where they cannot."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from coupler.run import run_coupled
from fluid_solver.delay_line import DelayLine
from fluid_solver.models import make_model
from shared.contract import BadInput, Kinematics
from shared.scene.reading import load_scene
from tests.coupled_models import couple, piston
from tests.scenes import SPRUNG, scene_of

AROUND = [[-0.1, -0.1], [1.1, -0.1], [1.1, 0.2], [1.0, 0.2], [1.0, 0.0], [0.0, 0.0], [0.0, 0.2], [-0.1, 0.2]]
RHO, C, LENGTH, HEIGHT = 1000.0, 50.0, 1.0, 0.2


def swung(model, times, x, v, a=None, substeps=1):
    """Total force along x and end pressure in every window of a face that moves as x(t), v(t)."""
    feet = model.describe().position
    rest = Kinematics.at_rest(feet)

    def at(t):
        along = [np.tile([value, 0.0], (len(feet), 1)) for value in (x(t), v(t), a(t) if a else 0.0)]
        return Kinematics(feet + along[0], along[1], along[2], rest.velocity, rest.velocity)

    model.begin(at(times[0]))
    forces, pressures = [], []
    for t0, t1 in itertools.pairwise(times):
        loads = model.advance(t0, t1, substeps, at(t1))
        forces.append(loads.force.sum(axis=0))
        pressures.append(loads.pressure[0])
    return np.array(forces), np.array(pressures)


@pytest.mark.parametrize(
    ("far_end", "d", "R"), [("open", 1.0, -1.0), ("closed", 1.0, 1.0), ("closed", 0.4, 0.4), ("open", 0.0, 0.0)]
)
def test_waves_are_exact_for_a_cubic_motion(far_end, d, R):
    """p = ρ c (v + 2 Σ R^k v(t − kτ)): a face that moves as t³ is followed to rounding, mean force and all."""
    model = make_model(piston([f"fluid.column.far_end={far_end}", f"fluid.column.reflection={d}"]), True, 1)
    times = np.arange(0, 121) * 1e-3
    tau = 2.0 * LENGTH / C

    def echoes(of):
        return lambda t: of(t) + sum(2.0 * R**k * of(t - k * tau) * (t > k * tau) for k in range(1, 4))

    forces, pressures = swung(model, times, lambda t: t**3, lambda t: 3.0 * t**2)
    impulse = RHO * C * HEIGHT * np.array([echoes(lambda s: s**3)(t) for t in times])
    np.testing.assert_allclose(forces[:, 0], -np.diff(impulse) / 1e-3, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(pressures, RHO * C * np.array([echoes(lambda s: 3.0 * s**2)(t) for t in times[1:]]))


@pytest.mark.parametrize("window", [1e-3, 0.7e-3])
def test_steps_within_a_window_change_nothing(window):
    times = np.arange(0, 200) * window
    motion = (lambda t: 1.0 - np.cos(9.0 * t), lambda t: 9.0 * np.sin(9.0 * t))
    whole, parts = (swung(make_model(piston(), True, 1), times, *motion, substeps=n)[0] for n in (1, 32))
    np.testing.assert_allclose(whole, parts, rtol=1e-9 if window == 1e-3 else 2e-3, atol=1e-3)


def test_memory_between_its_times_is_of_fourth_order():
    errors = []
    for step in (0.1, 0.05, 0.025):
        line = DelayLine(1)
        for t in np.arange(0.0, 20.0, step):
            line.append(t, np.array([np.sin(t)]), np.array([np.cos(t)]))
            line.forget(t - 3.0)
        errors.append(max(abs(line.at(18.0 + s * step)[0][0] - np.sin(18.0 + s * step)) for s in (0.3, 0.5, 0.8)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.2)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.2)


def test_incompressible_water_is_a_mass():
    model = make_model(piston(["fluid.column.compressible=false"]), True, 1)
    times = np.arange(0, 30) * 1e-2
    forces, pressures = swung(model, times, lambda t: t**2, lambda t: 2.0 * t, lambda t: 2.0)
    np.testing.assert_allclose(forces[:, 0], -RHO * LENGTH * HEIGHT * 2.0)
    np.testing.assert_allclose(pressures, RHO * LENGTH * 2.0)


PLATE = """
schema = 1
title = "1 m of water on a plate a twenty-fifth of its weight"
end_time = 0.15
gravity = [0.0, -9.81]
[fluid]
model = "column"
dx = 0.02
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.4, 1.0] }]
column = { far_end = "open", compressible = false }
[solid]
model = "beam"
dx = 0.01
density = 2000.0
youngs_modulus = 2.1e9
poisson_ratio = 0.3
bodies = [{ name = "plate", rectangle = [0.0, -0.02, 0.4, 0.0] }]
clamps = [{ body = "plate", face = "left" }, { body = "plate", face = "right" }]
"""


@pytest.mark.parametrize("window", [3e-4, 1e-3, 3e-3])
@pytest.mark.parametrize(("model", "error"), [("beam", 0.06), ("total-lagrangian", 0.09)])  # this one 4 across
def test_incompressible_water_holds_on_a_plate_whatever_the_window(tmp_path, model, error, window):
    """It swings about q L⁴/(720 D), the mean deflection, from 0 to twice that: no mode of the plate is driven."""
    scene = scene_of(PLATE, tmp_path, [f"solid.model={model}", f"coupling.window={window}", "solid.dx=5e-3"])
    moved = couple(scene, along=(0.0, 1.0)).points
    stiffness = 2.1e9 * 0.02**3 / (12.0 * (1.0 - 0.3**2))
    static = (1000.0 * 1.0 + 2000.0 * 0.02) * 9.81 * 0.4**4 / (720.0 * stiffness)
    assert -2.2 * static < moved.min() < -1.8 * static
    assert moved.max() < 0.1 * static
    assert np.mean(moved) == pytest.approx(-static, rel=error)


def test_an_automatic_window_resolves_the_swing_and_the_rows(tmp_path):
    """T = 2π √((m + ρ L b)/k) = 0.435 s: a spring that the water does not push against has no say."""
    scene = scene_of(SPRUNG, tmp_path)
    run = run_coupled(scene, "sprung", tmp_path / "run", {"fluid": 1, "solid": 1}, True, "inprocess")
    assert run.result["preflight"]["window"] <= 0.01
    assert run.result["probes"]["y"]["min"] == pytest.approx(-2.0 * 240.0 * 9.81 / 5e4, rel=1e-3)
    assert run.result["probes"]["y"]["t_min"] % 0.4353 == pytest.approx(0.2177, abs=0.006)


def test_water_at_rest_weighs_what_it_weighs_and_shows_its_pressure():
    """The columns replace the particles of another scene by one line, and carry the same static load."""
    scene = load_scene("hydrostatic_plate", ["fluid.model=column", "fluid.dx=0.05", "solid.model=beam"])
    model = make_model(scene, True, 1)
    described = model.describe()
    assert len(described.position) == 20
    assert np.all(described.position[:, 1] == 0.0)
    loads = model.begin(Kinematics.at_rest(described.position))
    np.testing.assert_allclose(loads.force.sum(axis=0), [0.0, -1000.0 * 9.81 * 2.0 * 1.0], atol=1e-9)
    assert model.probe_values()["bottom_pressure"] == pytest.approx(19620.0)
    frame = model.frame()
    np.testing.assert_allclose(frame.fields["pressure"], 9810.0 * (2.0 - frame.position[:, 1]))


def test_pressure_along_the_column_is_that_of_the_wave():
    """A face that moves at 1 m/s for 10 ms: water up to 0.5 m away carries ρ c v, none beyond."""
    model = make_model(piston(), True, 1)
    times = np.arange(0, 11) * 1e-3
    swung(model, times, lambda t: t, lambda t: 1.0)
    frame = model.frame()
    reached = frame.position[:, 0] < 0.5
    np.testing.assert_allclose(frame.fields["pressure"], np.where(reached, RHO * C, 0.0), atol=1e-6)
    np.testing.assert_allclose(frame.fields["velocity"][:, 0], np.where(reached, 1.0, 0.0), atol=1e-9)


@pytest.mark.parametrize(
    ("sets", "what"),
    [
        (["fluid.bodies.water.rectangle=[0.2,0,1,0.2]"], "touches no face"),
        ([f"solid.bodies=[{{name='piston',polygon={AROUND}}}]"], "at two opposite faces"),
        (["fluid.bodies=[{name='water',circle={centre=[0.5,0.1],radius=0.1}}]"], "no rectangle"),
    ],
)
def test_columns_refuse_where_they_cannot_stand(sets, what):
    with pytest.raises(BadInput, match=rf"fluid\.bodies\[0\]: 'water' .*{what}"):
        piston(sets)


def test_closed_incompressible_water_is_refused():
    with pytest.raises(BadInput, match="other water cannot move"):
        piston(["fluid.column.compressible=false", "fluid.column.far_end=closed"])


@pytest.mark.parametrize(("shape", "rel"), [([1.0], 1e-12), ([0.0, 1.0], 1e-12), ([0.0, 0.0, 1.2, -1.0], 1e-4)])
def test_columns_on_a_face_that_bends_do_the_work_of_the_pressure(tmp_path, shape, rel):
    """Force, moment, and work on a cantilever, x² (3 L − x): ten columns by the midpoint rule were 0.4 % off."""
    model = make_model(scene_of(PLATE, tmp_path, ["fluid.dx=0.04", "gravity=[-1.0, -9.81]"]), True, 1)
    x, fy, shape = model.describe().position[:, 0], -model.begin(None).force[:, 1], np.polynomial.Polynomial(shape)
    assert len(x) == 10
    pressure = 1000.0 * np.polynomial.Polynomial([9.81 + 0.4, -1.0])
    assert fy @ shape(x) == pytest.approx((pressure * shape).integ()(0.4), rel=rel)
