"""Stability maps: theory's limits, the search for a boundary, and runs that find theory's boundary."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

from coupler.stability import find_boundaries, write_map
from coupler.stability_map import load_map, shipped_maps
from coupler.stability_runs import boundary, cell_scene, growth_rate, rate_of
from coupler.stability_theory import growth, lagged_column, largest_stable_alpha
from shared.contract import BadInput


@pytest.mark.parametrize(("order", "limit"), [(0, 2.0), (1, 2.0 / math.sqrt(3.0)), (2, 0.709)])
def test_limits_of_the_serial_protocol_on_an_absorbing_column(order, limit):
    assert largest_stable_alpha(order, 0.0, 4) == pytest.approx(limit, rel=1e-3)


def simulate(alpha, order, reflection, k, windows):
    """The recurrence of stability_theory.py stepped in time: speed of the piston at each window's end."""
    weights = {0: (1.0,), 1: (2.0, -1.0), 2: (3.0, -3.0, 1.0)}[order]
    speed, speeds, loads, waves = 1.0, [], [0.0] * 3, [0.0] * k
    for _ in range(windows):
        gained = -alpha * sum(w * load for w, load in zip(weights, loads[::-1], strict=False))
        moved = speed + 0.5 * gained
        loads.append(moved - 2.0 * reflection * waves[-k])
        waves.append(moved - reflection * waves[-k])
        speed += gained
        speeds.append(speed)
    return np.array(speeds)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(("reflection", "k"), [(0.0, 2), (0.5, 3), (0.8, 10), (1.0, 5)])
def test_roots_tell_how_the_recurrence_grows(order, reflection, k):
    for alpha in (0.3, 1.0, 2.5):
        speeds = np.abs(simulate(alpha, order, reflection, k, 600))
        rate = growth(alpha, order, reflection, k)
        if rate > 1.02:
            measured = (np.max(speeds[550:]) / np.max(speeds[250:300])) ** (1.0 / 300.0)
            assert measured == pytest.approx(rate, rel=0.01)
        elif rate < 0.98:
            assert np.max(speeds[550:]) < np.max(speeds[:50])


def test_a_lossless_column_has_no_stable_window():
    assert largest_stable_alpha(0, 1.0, 20) < 0.05
    assert largest_stable_alpha(0, 0.9, 20) < largest_stable_alpha(0, 0.5, 20)


def test_a_boundary_is_found_to_its_tolerance_and_its_absence_too():
    assert boundary(lambda y: y > 3.7, 0.1, 100.0, 0.01) == pytest.approx(3.7, rel=0.01)
    assert boundary(lambda y: False, 0.1, 100.0, 0.01) is None
    assert boundary(lambda y: True, 0.1, 100.0, 0.01) == 0.1


@pytest.mark.parametrize("rate", [-0.02, 0.03])
def test_rate_of_a_swing(rate):
    windows = np.arange(400)
    assert rate_of(np.exp(2.0 * rate * windows) * np.cos(1.3 * windows) ** 2) == pytest.approx(rate, abs=1e-3)


def test_a_swing_that_died_out_does_not_grow():
    assert rate_of([1.0, *([1e-30, 3e-30] * 200)]) == -math.inf


@pytest.mark.parametrize("name", shipped_maps())
def test_shipped_maps_hold_valid_cells(name):
    given = load_map(name)
    for method in given.methods:
        for x in given.x.values:
            for y in given.y.range:
                assert cell_scene(given, method, x, y).coupling.window > 0.0


def test_runs_grow_past_the_boundary_and_not_before():
    """The first method of the map at one window: order 0 on an absorbing column, boundary α = A r = 2."""
    given = load_map("lagged_column")
    rates = [growth_rate(cell_scene(given, given.methods[0], 0.4, r), "swing") for r in (4.75, 5.25)]
    assert rates[0] < 0.0 < rates[1]
    assert lagged_column(0.4, 0, 0.0) == pytest.approx(5.0, rel=1e-6)


@pytest.mark.slow
def test_a_map_from_runs_lies_on_theory(tmp_path):
    given = load_map("lagged_column")
    small = given.model_copy(update={"x": given.x.model_copy(update={"values": [0.4, 1.0]})})
    found = find_boundaries(small, print)
    paths = write_map(small, found, tmp_path)
    assert all(abs(b.difference) < 0.05 for b in found)
    with paths[0].open() as file:
        assert len(list(csv.DictReader(file))) == len(given.methods) * 2
    assert paths[2].stat().st_size > 10_000


def test_mistakes_in_a_map_are_all_named(tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text(shipped_maps()["lagged_column"].read_text().replace('case = "piston"', "cse = 1\ncase = 2"))
    with pytest.raises(BadInput) as error:
        load_map(str(path))
    assert "cse" in str(error.value)
    assert "case" in str(error.value)
    with pytest.raises(BadInput, match="did you mean 'lagged_column'"):
        load_map("laged_column")
