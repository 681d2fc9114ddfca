"""The fluid's step is of second order in time: an acoustic standing wave in a closed box."""

import numpy as np
import pytest
from tests.test_fluid_model import begun, fluid_rows, scene

from fluid_solver.fields import FLUID, GX, P, U, X

LENGTH, C0, AMPLITUDE = 0.3, 10.0, 0.05


def wave(steps: int, time: float):
    """x, u and p of the fluid after `time` [s] in `steps` steps, from u = A sin(πx/L)."""
    corners = [(0.0, 0.0), (LENGTH, 0.0), (LENGTH, 0.1), (0.0, 0.1)]
    box = {"name": "box", "polyline": corners, "closed": True}
    water = [{"name": "water", "rectangle": (0.0, 0.0, LENGTH, 0.1)}]
    model = begun(scene(water, [box], gravity=(0.0, 0.0), sound_speed=C0, alpha=0.0))
    S, fluid = model.store.S, model.store.kind == FLUID
    S[U, fluid] = S[GX, fluid] = AMPLITUDE * np.sin(np.pi * S[X, fluid] / LENGTH)
    model.begin(None)
    model.advance(0.0, time, steps, None)
    return fluid_rows(model, X, U, P)


def test_halving_the_step_quarters_the_error():
    time = 0.8 * LENGTH / C0
    coarse, middle, fine = (wave(steps, time) for steps in (12, 24, 48))
    for row in (0, 2):
        first = np.linalg.norm(coarse[row] - middle[row])
        second = np.linalg.norm(middle[row] - fine[row])
        assert 3.5 < first / second < 4.6


def test_the_wave_keeps_its_period_and_its_height():
    """After one period 2L/c the velocity is back, but for the lattice's dispersion."""
    x, u, _ = wave(150, 2.0 * LENGTH / C0)
    shape = np.sin(np.pi * x / LENGTH)
    height = 2.0 * np.mean(u * shape) / AMPLITUDE
    assert height == pytest.approx(1.0, abs=0.03)
