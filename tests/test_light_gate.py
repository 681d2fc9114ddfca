"""The box closed by a light gate: particles on both sides, where one exchange a window cannot work."""

from __future__ import annotations

import numpy as np
import pytest

from coupler.ledger import Ledger, LedgerExceeded
from shared.scene.reading import load_scene
from tests.coupled_models import couple

pytestmark = pytest.mark.timeout(400)
PRESSURE = 200.0 * 2.775e-7 / (2.775e-7 + 0.72e-7)  # cases/reference/light_gate


def gate(ledger=None, windows=None, **coupling):
    return couple(load_scene("light_gate", [f"coupling.{k}={v}" for k, v in coupling.items()]), windows, ledger=ledger)


def counts(history) -> np.ndarray:
    return np.array([len(outcome.changes) for outcome in history.outcomes])


def test_explicit_exchange_is_stopped_within_fifty_windows(tmp_path):
    scene = load_scene("light_gate")
    with pytest.raises(LedgerExceeded, match="serial-implicit"):
        gate(Ledger(tmp_path / "ledger.csv", scene.coupling.limits), 50, scheme="serial-explicit")


def test_iqn_ils_runs_two_hundred_windows_at_six_iterations_or_less(tmp_path):
    scene = load_scene("light_gate")
    newton = gate(Ledger(tmp_path / "ledger.csv", scene.coupling.limits))
    assert len(newton.outcomes) >= 200
    assert all(outcome.converged for outcome in newton.outcomes)
    assert counts(newton).max() <= 6
    assert counts(newton).mean() < 2.5
    load = np.array([outcome.found.force[:, 0].sum() for outcome in newton.outcomes])
    assert load[200:].mean() / 0.06 == pytest.approx(PRESSURE, rel=0.06)  # still swinging
    aitken = gate(acceleration="aitken")
    assert counts(aitken).sum() > counts(newton).sum()
    np.testing.assert_allclose(aitken.points, newton.points, atol=0.02 * np.abs(newton.points).max())


def test_auto_iterates_and_says_why():
    found = gate(windows=20, scheme="auto", window="auto")
    assert found.plan.scheme == "serial-implicit"
    assert "iterating over whole steps costs less" in found.plan.reasons[0]
