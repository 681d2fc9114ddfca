"""The fluid time step: least of its limits, one rule for solver and pre-flight, warned of when a scene asks more."""

import logging

import pytest

from coupler.preflight.water import measure_water
from fluid_solver.models import make_model
from shared.fluid_step import COURANT, FORCE_STEP, LARGEST_COURANT, VISCOUS_STEP, fluid_step
from shared.motion_table import largest_speed
from shared.schema import Scene
from shared.schema_geometry import Motion
from tests.test_fluid_model import dam


def test_the_step_is_the_least_of_its_limits():
    assert fluid_step(1.3, 0.01, 20.0, 0.0, 0.0) == pytest.approx(1.3 * 0.01 / 20.0)
    assert fluid_step(1.3, 0.01, 20.0, 1.0, 0.0) == pytest.approx(VISCOUS_STEP * 1e-4)
    assert fluid_step(1.3, 0.01, 20.0, 0.0, 1e6) == pytest.approx(FORCE_STEP * 1e-4)


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
