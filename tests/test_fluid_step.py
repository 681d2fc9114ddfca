"""The fluid time step: least of its limits, one rule for solver and pre-flight, warned of when a scene asks more."""

import logging

import numpy as np
import pytest

from coupler.preflight.measures.water import measure_water
from fluid_solver.fields import U, V
from fluid_solver.models import make_model
from fluid_solver.parameters import gradient_factor
from shared.fluid_step import BORNE, COURANT, FORCE_STEP, LARGEST_COURANT, VISCOUS_STEP, fluid_step
from shared.geometry.motion_table import largest_speed
from shared.kernels import evaluate, kernel_named
from shared.schema.geometry import Motion
from shared.schema.scene import Scene
from tests.fluid_models import begun, dam, fluid_rows, run
from tests.test_fluid_periodic import box


def test_the_step_is_the_least_of_its_limits():
    assert fluid_step(1.3, 0.01, 20.0, 0.0, 0.0) == pytest.approx(1.3 * 0.01 / 20.0)
    assert fluid_step(1.3, 0.01, 20.0, 1.0, 0.0) == pytest.approx(VISCOUS_STEP * 1e-4, rel=1e-3)
    assert fluid_step(1.3, 0.01, 20.0, 0.0, 1e6) == pytest.approx(FORCE_STEP * 1e-4)


def test_a_step_with_viscosity_bears_sound_that_wears_out():
    """(Δt/Δt_s)² + Δt/Δt_ν = 1 where viscosity limits it, whatever their ratio; none of it where it does not."""
    for viscosity in (0.02, 0.05, 10.0):
        step = fluid_step(1.3, 0.01, 20.0, viscosity, 0.0)
        sound, viscous = BORNE * 0.01 / 20.0, VISCOUS_STEP * 1e-4 / viscosity
        assert (step / sound) ** 2 + step / viscous == pytest.approx(1.0)
    assert fluid_step(1.3, 0.01, 20.0, 1e-3, 0.0) == 1.3 * 0.01 / 20.0


@pytest.mark.parametrize(("name", "h_over_dx"), [("wendland-c2", 1.0), ("wendland-c2", 3.0), ("quintic-spline", 2.0)])
def test_the_viscous_step_bears_any_motion_of_a_lattice(name, h_over_dx):
    """No motion wears out faster than at the rate 8 ν Σ V_b |F|; Euler's rule bears steps of two over it."""
    kernel = kernel_named(name)
    r = np.hypot(*np.meshgrid(np.arange(-10, 11), np.arange(-10, 11)))
    F = evaluate(kernel, r[r > 0.0], h_over_dx)[1] * gradient_factor(kernel, h_over_dx)
    assert VISCOUS_STEP * h_over_dx**2 < 2.0 / (8.0 * np.abs(F).sum())


def test_honey_that_is_shaken_comes_to_rest():
    """After a hundred steps of 0.125 h²/ν, more than a checkerboard bears, nothing of it was left."""
    honey = begun(box({"x": (0.0, 1.0), "y": (0.0, 1.0)}, dx=0.1, viscosity=20.0, shake=0.2))
    run(honey, 150 * honey.stable_step(), windows=1)
    assert np.abs(fluid_rows(honey, U, V)).max() < 1e-3 * honey.c.c0


@pytest.mark.parametrize("model", ["ctvf", "wcsph"])
def test_solver_and_preflight_take_the_same_step(model):
    case = dam(model)
    assert make_model(case, False, 1).stable_step() == pytest.approx(measure_water(case).step, rel=1e-9)


def test_a_step_beyond_what_was_measured_is_warned_of(caplog):
    case = dam("ctvf")
    for courant, warned in ((COURANT["ctvf"], False), (1.05 * LARGEST_COURANT["ctvf"], True)):
        caplog.clear()
        with caplog.at_level(logging.WARNING, logger="shearwater"):
            make_model(case.model_copy(update={"fluid": case.fluid.model_copy(update={"courant": courant})}), False, 1)
        assert ("stable" in caplog.text) == warned


def test_a_turning_wall_is_as_fast_as_its_farthest_corner():
    turn = Motion(times=[0.0, 1.0], rotation=[0.0, 90.0], about=(0.0, 0.0))
    assert largest_speed(turn, [(0.5, 0.0), (2.0, 0.0)]) == pytest.approx(2.0 * 1.5708, rel=1e-3)


@pytest.mark.parametrize("model", ["ctvf", "wcsph"])
def test_a_speed_that_all_share_costs_no_shorter_steps(model):
    """Steps of a block of water in flight: as at rest; two halves that meet cost what each is fast."""
    sound, speed = 20.0, 5.0

    def step(*velocities):
        bodies = [
            {"name": f"half{k}", "rectangle": [0.2 * k, 0.0, 0.2 * (k + 1), 0.2], "velocity": velocity}
            for k, velocity in enumerate(velocities)
        ]
        fluid = {"model": model, "dx": 0.01, "sound_speed": sound, "bodies": bodies}
        scene = {"schema": 1, "title": "block", "end_time": 0.1, "gravity": [0.0, 0.0], "fluid": fluid}
        water = make_model(Scene.model_validate(scene), False, 1)
        water.begin(None)
        return water.stable_step()

    still = step((0.0, 0.0), (0.0, 0.0))
    assert step((0.0, speed), (0.0, speed)) == pytest.approx(still, rel=1e-12)
    assert step((speed, 0.0), (-speed, 0.0)) == pytest.approx(still * sound / (sound + speed), rel=1e-12)


def test_a_jet_at_a_wall_takes_steps_for_its_speed():
    """Nothing of it until the wall is in reach; then what stands in the wall moves against the jet as fast."""
    sound, speed = 20.0, 4.0

    def step(distance):
        scene = {
            "schema": 1, "title": "jet", "end_time": 0.1, "gravity": [0.0, 0.0],
            "fluid": {
                "model": "wcsph", "dx": 0.01, "sound_speed": sound,
                "bodies": [{"name": "jet", "rectangle": [-0.2, 0.0, 0.0, 0.2], "velocity": [speed, 0.0]}],
            },
            "walls": [{"name": "wall", "polyline": [[distance, -0.2], [distance, 0.4]]}],
        }  # fmt: skip
        water = make_model(Scene.model_validate(scene), False, 1)
        water.begin(None)
        return water.stable_step()

    assert step(0.1) == pytest.approx(step(0.0) * (sound + speed) / sound, rel=1e-9)
