"""The automatic window: whole fluid steps, few enough for the lagged exchange."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from coupler.stability.theory import acoustic, growth
from coupler.window import SPEED_UP, alpha_rate, make_plan, window_length
from shared.contract import Description
from shared.schema.coupling import Coupling

NOTHING = np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=np.int64)


def sides(step, thickness, sound_speed=20.0, wave_speed=5000.0):
    fluid = {"density": 1000.0, "sound_speed": sound_speed}
    solid = {"density": 2500.0, "thickness": thickness, "wave_speed": wave_speed}
    return (
        Description("fluid", "fluid", "wcsph", step, 1e-3, *NOTHING, fluid),
        Description("solid", "structure", "total-lagrangian", step, 1e-3, *NOTHING, solid),
    )


def test_heavy_plate_gets_four_steps_a_window():
    assert window_length(Coupling(), *sides(1e-5, 1.0)) == pytest.approx(4 * 1e-5 / (1 + SPEED_UP))


@pytest.mark.parametrize("thickness", [0.001, 0.004, 0.01, 0.03])
def test_light_plate_shortens_the_window(thickness):
    fluid, solid = sides(1e-4, thickness)
    window = window_length(Coupling(), fluid, solid)
    assert alpha_rate(fluid, solid) * window <= 0.07 * (1 + 1e-12)
    steps = window / (fluid.stable_step / (1 + SPEED_UP))
    assert steps < 1 or steps == pytest.approx(round(steps))


@pytest.mark.parametrize("order", [0, 1, 2])
def test_both_at_once_get_a_window_that_a_reflecting_column_pumps_no_faster(order):
    """Growth in a unit of α windows on a column that reflects nine tenths, r 2, k windows there and back."""
    fluid, solid = sides(1e-4, 0.004)
    parallel = Coupling(scheme="parallel-explicit", predictor=order)
    alphas = [alpha_rate(fluid, solid) * window_length(c, fluid, solid) for c in (Coupling(), parallel)]
    pumped = [
        math.log(growth(acoustic(alpha, p, 0.9, round(4.0 / alpha), scheme))) / alpha
        for alpha, p, scheme in zip(alphas, (0, order), ("serial", "parallel"), strict=True)
    ]
    assert pumped[1] <= pumped[0] + 1e-3


def test_alpha_is_the_documented_ratio():
    assert alpha_rate(*sides(1e-4, 0.012)) == pytest.approx(1000.0 * 20.0 / (2500.0 * 0.012))


def test_window_of_the_scene_is_kept():
    assert window_length(Coupling(window=0.01), *sides(1e-5, 1.0)) == 0.01


@pytest.mark.parametrize(("wave_speed", "steps"), [(20.0, 1), (5000.0, 4)])
def test_a_soft_plate_of_many_layers_gets_the_window_that_one_layer_bears(wave_speed, steps):
    """dam_break_plate with 24 layers of 0.5 mm: in two steps its outermost layer ripples, and the run fails."""
    fluid, solid = sides(2.44e-5, 0.012, 24.0, wave_speed)
    solid = replace(solid, spacing=5e-4)
    assert window_length(Coupling(), fluid, solid) == pytest.approx(steps * 2.44e-5 / (1 + SPEED_UP))


@pytest.mark.parametrize("scheme", ["auto", "serial-implicit", "parallel-implicit"])
def test_an_iterated_window_holds_one_fluid_step(scheme):
    plan = make_plan(Coupling(scheme=scheme), *sides(1e-4, 0.001), r=100.0)
    assert plan.scheme.endswith("implicit")
    assert plan.window == pytest.approx(1e-4 / (1 + SPEED_UP))
    assert make_plan(Coupling(scheme=scheme, window=0.01), *sides(1e-4, 0.001), r=100.0).window == 0.01


@pytest.mark.parametrize("scheme", ["auto", "serial-implicit"])
def test_no_automatic_window_is_longer_than_the_longest(scheme):
    heavy = sides(1.0, 1.0)
    assert make_plan(Coupling(scheme=scheme), *heavy, r=0.01, longest=1e-3).window <= 1e-3
    assert make_plan(Coupling(scheme=scheme, window=0.01), *heavy, r=0.01, longest=1e-3).window == 0.01


def test_an_iterated_window_on_columns_resolves_the_plate():
    fluid, solid = sides(1e-3, 0.001)
    plan = make_plan(Coupling(scheme="serial-implicit"), replace(fluid, model="column"), solid, r=100.0)
    assert alpha_rate(fluid, solid) * plan.window == pytest.approx(0.25)
