"""The structures' cases at coarse resolution: figures of the benchmark's table, in seconds."""

import numpy as np
import pytest

from shared.run.statistics import statistic
from shared.scene.reading import load_scene
from solid_solver.models import make_model
from tests.solid_scenes import run
from tests.structures_invariance import VIEWS, changed_answer

LAGRANGIAN, BEAM = ["solid.model=total-lagrangian"], ["solid.model=beam"]


def history(case, sets, probe, end, windows):
    """Times and values of a probe of a case up to `end` [s]."""
    model = make_model(load_scene(case, sets), False, 1)
    rows = [(0.0, model.probe_values()[probe])]
    rows += [(t, model.probe_values()[probe]) for t in run(model, end, windows)]
    return np.array(rows).T


@pytest.mark.parametrize(("sets", "error"), [([*LAGRANGIAN, "solid.dx=4e-3"], 0.02), ([*BEAM, "solid.dx=4e-3"], 0.01)])
def test_oscillating_plate_swings_in_its_period(sets, error):
    time, tip = history("oscillating_plate", sets, "tip_y", 0.3, 300)
    assert statistic("max", time, tip) == pytest.approx(0.1066, rel=error)
    down = time[np.flatnonzero((tip[1:] < 0.0) & (tip[:-1] >= 0.0))[0]]  # from up to down: half a period
    assert 2.0 * down == pytest.approx(0.2549, rel=error)


@pytest.mark.parametrize(("sets", "error"), [([*LAGRANGIAN, "solid.dx=3e-3"], 0.03), ([*BEAM, "solid.dx=3e-3"], 0.015)])
def test_plate_under_a_sudden_pressure(sets, error):
    time, tip = history("plate_step_load", sets, "tip_x", 0.12, 240)
    assert statistic("max", time, tip) == pytest.approx(0.04146, rel=error)
    assert statistic("t_max", time, tip) == pytest.approx(0.0845, rel=error)


@pytest.mark.parametrize(("sets", "error"), [([*LAGRANGIAN, "solid.dx=4e-3"], 0.03), ([*BEAM, "solid.dx=4e-3"], 0.002)])
def test_cantilever_hangs_as_the_exact_beam_does(sets, error):
    _, tip = history("cantilever_gravity", [*sets, "solid.damping=45.0"], "tip_y", 0.6, 60)
    assert tip[-1] == pytest.approx(-0.029166, rel=error)


@pytest.mark.parametrize("ratio", [0.3975, 0.47])
def test_a_pulled_strip_stays_whole(ratio):
    sets = ["solid.model=ctvf", "solid.dx=4e-3", f"solid.poisson_ratio={ratio}", "solid.loads[0].ramp=0.03"]
    _, gap = history("stretched_strip", sets, "gap", 0.06, 12)
    assert gap.max() < 1.3


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("model", ["total-lagrangian", "ctvf"])
def test_turned_mirrored_and_rescaled_scenes_give_the_same_answer(model, view):
    assert changed_answer(model, view) < 1e-8
