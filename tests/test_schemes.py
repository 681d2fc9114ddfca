"""The serial explicit scheme on toy sides with exact answers; the ledger's balance."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from coupler.ledger import Ledger
from coupler.prediction import Predictor
from coupler.vectors import Measure
from shared.clock import Clock
from shared.contract import Loads, SolverFailed
from shared.schema.coupling import Coupling, Limits
from tests.coupled_models import couple_models


def coupled(spring, weight, windows, order, folder, end=1.0, **coupling):
    """Run both toys; returns the structure's model and the ledger's rows and summary."""
    ledger = Ledger(folder / "ledger.csv", Limits())
    table = Coupling(**{"scheme": "serial-explicit", "predictor": order, **coupling})
    couple_models(weight, spring, Clock(end, windows), table, ledger=ledger)
    ledger.close()
    with (folder / "ledger.csv").open() as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return spring, rows, ledger.summary()


def test_constant_load_gives_the_exact_step_response(toy_spring, toy_weight, tmp_path):
    spring, _, _ = coupled(toy_spring(2.0, 50.0), toy_weight(3.0), 40, 0, tmp_path)
    assert spring.y == pytest.approx(-3.0 / 50.0 * (1.0 - np.cos(5.0)), rel=1e-12)


@pytest.mark.parametrize(("order", "expected"), [(0, 1.0), (1, 2.0)])
def test_order_in_time_with_a_load_that_depends_on_motion(toy_spring, toy_weight, tmp_path, order, expected):
    """m y'' = −w − c y' − k y: lagged loads are first order, extrapolated ones second order."""
    m, k, c, w = 2.0, 50.0, 1.5, 3.0
    decay = c / (2 * m)
    omega = np.sqrt(k / m - decay**2)
    exact = -w / k * (1 - np.exp(-decay) * (np.cos(omega) + decay / omega * np.sin(omega)))
    counts = (200, 400, 800)
    errors = [abs(coupled(toy_spring(m, k), toy_weight(w, c), n, order, tmp_path)[0].y - exact) for n in counts]
    measured = np.log2(np.array(errors[:-1]) / errors[1:])
    assert measured[-1] == pytest.approx(expected, abs=0.15)


def test_action_equals_reaction_in_every_window(toy_spring, toy_weight, tmp_path):
    _, rows, summary = coupled(toy_spring(), toy_weight(3.0, 2.0), 50, 0, tmp_path)
    assert len(rows) == 50
    for row in rows:
        assert row["force_mapped_y"] == pytest.approx(row["force_fluid_y"], rel=1e-12)
        assert row["force_mapped_x"] == pytest.approx(row["force_fluid_x"], abs=1e-12 * abs(row["force_fluid_y"]))
    assert summary["mapping_error"] < 1e-12


def test_lag_energy_vanishes_with_the_window(toy_spring, toy_weight, tmp_path):
    """With a constant load nothing lags; with drag the lag energy falls in proportion to the window."""
    assert abs(coupled(toy_spring(), toy_weight(3.0), 50, 0, tmp_path)[2]["work_error"]) < 1e-12
    coarse, fine = (coupled(toy_spring(), toy_weight(3.0, 2.0), n, 0, tmp_path)[2]["work_error"] for n in (100, 200))
    assert coarse / fine == pytest.approx(2.0, rel=0.2)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_predictor_is_exact_for_polynomials_of_its_order(order):
    def load(n):
        return Loads(np.full(2, float(n**order)), np.full((2, 2), float((n + 1) ** order)))

    predictor = Predictor(order, load(0))
    for n in range(1, 5):
        predictor.add(load(n))
    np.testing.assert_allclose(predictor.predict(Clock(1.0, 10).window(5)).pressure, 5.0**order)
    np.testing.assert_allclose(predictor.predict(Clock(1.0, 10).window(5)).force, 6.0**order)


def test_a_side_that_lag_throws_about_fails_after_the_ledger(toy_spring, toy_weight, tmp_path):
    """Loads that lag strongly overshoot; what a side says of it then is not the cause."""
    error = SolverFailed("the moment of turning forces was not found")
    told = []
    for drag in (0.0, 400.0):
        ledger = Ledger(tmp_path / "ledger.csv", Limits())
        table = Coupling(scheme="serial-explicit", predictor=0)
        couple_models(toy_weight(3.0, drag), toy_spring(), Clock(1.0, 15), table, ledger=ledger)
        ledger.close()
        told.append(ledger.explained(error))
    assert told[0] is error
    assert str(told[1]).index("window is too long") < str(told[1]).index("turning forces")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1.0, 1e200])
def test_a_change_beside_no_load_at_all_is_huge_and_without_numpys_warning(size):
    measure, load, none = Measure(1e-3, 1e-9, "force"), Loads(np.zeros(1), np.full((1, 2), size)), Loads.zero(1)
    assert measure.change(load, none) > 1e300
    assert not measure.agrees((none,), (load,))
