"""The benchmark of the exchange runs over both links and says what it measured."""

from __future__ import annotations

import pytest

from coupler.bench import time_windows


@pytest.mark.parametrize("link", ["inprocess", "zenoh"])
def test_the_benchmark_counts_points_and_windows(link):
    found = time_windows(link, 100, 60)
    assert found["points"] == found["ghosts"] == 100
    assert found["models_ms"] > 0.0
    assert 0.0 < found["median_ms"] <= found["p95_ms"] < 200.0
