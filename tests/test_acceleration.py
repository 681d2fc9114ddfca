"""Accelerations on plain vectors: linear problems x = b − g x with known modes g, as added mass makes them."""

from __future__ import annotations

import numpy as np
import pytest

from coupler.acceleration import Aitken, Constant, IqnIls
from coupler.schemes import Iteration
from coupler.vectors import Measure
from shared.clock import Window


def evaluations(acceleration, g, b, x, tolerance, weight=None, cap=400):
    """Evaluations until |b − g x − x| is below `tolerance` |b|, and the x reached."""
    weight = np.ones(len(g)) if weight is None else weight
    acceleration.begin()
    for count in range(1, cap + 1):
        found = b - g * x
        if np.linalg.norm(weight * (found - x)) <= tolerance * np.linalg.norm(weight * b):
            return count, x
        x = acceleration.next(x, found, weight)
    return cap, x


def windows(acceleration, g, count=10):
    """Evaluations in each of several windows whose loads change by tens of per cent, each begun from the last."""
    spread, x, found = np.random.default_rng(0).normal(size=len(g)), np.zeros(len(g)), []
    for window in range(count):
        b = spread * np.cos(0.3 * window + 0.1 * np.arange(len(g)))
        n, x = evaluations(acceleration, g, b, x, 1e-8)
        found.append(n)
    return found


@pytest.mark.parametrize("g", [0.5, 3.0, 100.0])
@pytest.mark.parametrize("omega", [0.5, 0.01])
def test_aitken_solves_one_mode_at_the_third_evaluation(g, omega):
    assert evaluations(Aitken(omega), np.array([g]), np.array([1.0]), np.zeros(1), 1e-10)[0] == 3
    assert evaluations(Aitken(omega), np.full(5, g), np.arange(1.0, 6.0), np.zeros(5), 1e-10)[0] == 3


@pytest.mark.parametrize("g", [0.5, 3.0, 100.0])
def test_aitken_solves_one_mode_by_whatever_weights(g):
    """Weights are one over the size of the load found, another one at every evaluation."""
    aitken, x = Aitken(0.5), np.zeros(1)
    aitken.begin()
    for _ in range(2):
        found = 1.0 - g * x
        x = aitken.next(x, found, 1.0 / np.abs(found))
    np.testing.assert_allclose(x, 1.0 / (1.0 + g), rtol=1e-12)


@pytest.mark.parametrize("modes", [1, 2, 3, 5, 8])
def test_iqn_ils_solves_m_modes_within_m_plus_two(modes):
    g = np.repeat(np.linspace(0.3, 4.0, modes), 3)
    b = np.random.default_rng(modes).normal(size=len(g))
    assert evaluations(IqnIls(0.5, 0), g, b, np.zeros(len(g)), 1e-9)[0] <= modes + 2


@pytest.mark.parametrize(
    ("r", "aitken", "plain", "reused"), [(10.0, (29, 28), (13, 13), (13, 3.4)), (100.0, (63, 59), (20, 19), (20, 3.4))]
)
def test_twenty_modes_of_a_tube_take_no_more_than_published(r, aitken, plain, reused):
    """Added masses μ_i = (L/iπ)/tanh(iπR/L) with L = 5 R, the first r times the structure's mass; relaxation 0.5."""
    i = np.arange(1, 21)
    mu = (5.0 / (i * np.pi)) / np.tanh(i * np.pi / 5.0)
    for method, table in ((Aitken(0.5), aitken), (IqnIls(0.5, 0), plain), (IqnIls(0.5, 8), reused)):
        counts = windows(method, r * mu / mu[0])
        assert counts[0] <= table[0] + 1
        assert np.mean(counts[1:]) <= table[1] + 1


def test_reused_differences_make_later_windows_short():
    g = np.linspace(0.1, 6.0, 12)
    first, *later = windows(IqnIls(0.5, 5), g)
    assert first > 10
    assert max(later) <= 4
    assert min(windows(IqnIls(0.5, 0), g)) > 8


def test_unlike_fields_count_alike():
    """Forces of 10⁶ N beside velocities of 10⁻³ m/s: with weights the small field converges as well, and as fast."""
    g, size = np.array([2.0, 0.7, 1.3, 3.0]), np.array([1e6, 1e6, 1e-3, 1e-3])
    alike = evaluations(IqnIls(0.5, 0), g, np.ones(4), np.zeros(4), 1e-9)[0]
    count, x = evaluations(IqnIls(0.5, 0), g, size, np.zeros(4), 1e-9, weight=1.0 / size)
    assert count <= alike + 1
    np.testing.assert_allclose(x, size / (1.0 + g), rtol=1e-8)


def test_fields_without_weight_are_carried_along():
    """Entries of weight 0 follow x̃ = −g x with the factors that the others set."""
    weight = np.array([1.0, 1.0, 0.0])
    g, b = np.array([2.0, 0.5, 0.0]), np.array([1.0, -1.0, 7.0])
    _, x = evaluations(IqnIls(0.5, 0), g, b, np.zeros(3), 1e-12, weight)
    assert x[2] == pytest.approx(7.0, rel=1e-9)


def test_the_filter_leaves_out_what_says_nothing_new():
    method = IqnIls(0.5, 20)
    for _ in range(15):
        count, x = evaluations(method, np.array([2.0, 3.0]), np.array([1.0, 1.0 + 1e-9]), np.zeros(2), 1e-12)
    assert count <= 3
    np.testing.assert_allclose(x, [1.0 / 3.0, 0.25], rtol=1e-8)


@pytest.mark.parametrize("g", [0.5, 2.0, 10.0])
def test_constant_relaxation_flips_at_two_over_one_plus_g(g):
    limit = 2.0 / (1.0 + g)
    for factor, converges in ((0.98, True), (1.02, False)):
        _, x = evaluations(Constant(factor * limit), np.array([g]), np.ones(1), np.zeros(1), 0.0, cap=300)
        assert (abs(x[0] - 1.0 / (1.0 + g)) < 1e-2) == converges


@pytest.mark.parametrize("method", [IqnIls(0.5, 8), Aitken(0.5), Constant(0.5)])
def test_what_a_window_without_an_answer_told_is_not_used_again(method):
    """A structure was turned inside out by what was remembered of a load that jumps to and fro."""
    g, b, x = np.array([0.5, 1.0]), np.ones(2), np.zeros(2)
    method.begin()
    for _ in range(10):
        x = method.next(x, b - g * x + 5.0 * np.sign(np.sin(40.0 * x)), np.ones(2))
    Iteration(method, Measure(0.0, 0.0, "force"), 10, True).capped(Window(0, 0.0, 1.0), [1.0])
    method.begin()
    np.testing.assert_array_equal(method.next(np.zeros(2), b, np.ones(2)), 0.5 * b)
