"""Kernels: unit integral, gradient, compact support, finite at the origin."""

import numpy as np
import pytest

from shared.contract import BadInput
from shared.kernels import evaluate, kernel_named

H = 0.37
NAMES = ["wendland-c2", "quintic-spline"]


@pytest.mark.parametrize("name", NAMES)
def test_integral_over_the_plane_is_one(name):
    kernel = kernel_named(name)
    r = (np.arange(20000) + 0.5) * kernel.support * H / 20000
    w, _ = evaluate(kernel, r, H)
    assert np.sum(w * 2 * np.pi * r) * (r[1] - r[0]) == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize("name", NAMES)
def test_f_is_the_derivative_of_w_over_r(name):
    kernel = kernel_named(name)
    r = np.linspace(0.02, 1.2 * kernel.support, 700) * H
    step = 1e-5 * H
    slope = (evaluate(kernel, r + step, H)[0] - evaluate(kernel, r - step, H)[0]) / (2 * step)
    f = evaluate(kernel, r, H)[1]
    assert f * r == pytest.approx(slope, abs=1e-7 * np.abs(slope).max())


@pytest.mark.parametrize("name", NAMES)
def test_first_moment_of_the_gradient_is_minus_two(name):
    """∫ r·∇W dA = −2: what makes Σ V_b r_ab·∇W exact for a linear field."""
    kernel = kernel_named(name)
    r = (np.arange(20000) + 0.5) * kernel.support * H / 20000
    f = evaluate(kernel, r, H)[1]
    assert np.sum(f * r**2 * 2 * np.pi * r) * (r[1] - r[0]) == pytest.approx(-2.0, abs=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_compact_and_finite_at_the_origin(name):
    kernel = kernel_named(name)
    w, f = evaluate(kernel, np.array([0.0, kernel.support * H, 10.0 * H]), H)
    assert np.isfinite(f[0])
    assert f[0] < 0.0 < w[0]
    assert np.abs(w[1:]).max() < 1e-12 * w[0]
    assert np.abs(f[1:]).max() < 1e-12 * abs(f[0])


def test_unknown_kernel_is_bad_input():
    with pytest.raises(BadInput, match="wendland-c2"):
        kernel_named("wendland")
