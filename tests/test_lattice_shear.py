"""What a lattice of particles bears in shear under pressure: its moduli, and the waves that they make too fast."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from coupler.preflight.bounds.lattice_shear import LOOSEST, restless, shear_moduli, stiff, too_fast
from shared.kernels import evaluate, kernel_named
from shared.run.statistics import statistic
from shared.scene.reading import load_scene
from tests.fluid_models import begun, run

FOUND = {  # shares by which standing_wave's period is short, ctvf, 100 deep
    ("wendland-c2", 1.3): 0.0622,
    ("wendland-c2", 1.5): 0.0074,
    ("wendland-c2", 1.52): 0.0006,
    ("wendland-c2", 1.54): -0.0051,
    ("wendland-c2", 1.55): -0.0075,
    ("wendland-c2", 2.0): 0.0050,
    ("quintic-spline", 0.95): 0.0003,
    ("quintic-spline", 1.0): -0.0027,
}


@pytest.mark.parametrize(("kernel", "h_over_dx"), FOUND)
def test_waves_are_as_much_too_fast_as_the_lattice_is_stiff(kernel, h_over_dx):
    """Within a tenth and what else is wrong 100 deep."""
    short = too_fast(kernel, h_over_dx, 2.0 * math.pi)
    assert short == pytest.approx(FOUND[kernel, h_over_dx], rel=0.1, abs=0.0025)


def test_moduli_are_those_of_the_energy_of_a_strained_lattice():
    """Pushes of p F r between particles have the potential p W: its second derivative where they are stretched."""
    kernel, h = "wendland-c2", 1.3
    rows = np.arange(-4, 5)
    lattice = np.stack(np.meshgrid(rows, rows), axis=-1).reshape(-1, 2).astype(float)

    def energy(stretch: float) -> float:
        r = np.linalg.norm(lattice * [1.0 + stretch, 1.0 / (1.0 + stretch)], axis=1)
        return evaluate(kernel_named(kernel), r, h)[0].sum()

    pressure = -0.5 * np.sum(evaluate(kernel_named(kernel), r := np.linalg.norm(lattice, axis=1), h)[1] * r**2)
    step = 1e-3
    bent = (energy(step) - 2.0 * energy(0.0) + energy(-step)) / step**2  # 4 ε_1 p
    assert bent / (4.0 * pressure) == pytest.approx(shear_moduli(kernel, h)[0], rel=1e-3)


@pytest.mark.parametrize("phase", [0.3, 1.5, 6.0])
def test_the_share_of_a_period_is_that_of_the_strain_energy(phase):
    """Depth 1, pressure z: the strain's energy over twice the wave's, by quadrature."""
    along, across = shear_moduli("wendland-c2", 1.3)

    def strained(z: float) -> float:
        return z * (along * math.cosh(phase * (1.0 - z)) ** 2 + across * math.sinh(phase * (1.0 - z)) ** 2)

    share = 2.0 * phase**2 / math.sinh(phase) ** 2 * quad(strained, 0.0, 1.0)[0]
    assert too_fast("wendland-c2", 1.3, phase) == pytest.approx(share, rel=1e-9)
    assert too_fast("wendland-c2", 1.3, math.inf) == pytest.approx(0.5 * (along + across))
    assert too_fast("wendland-c2", 1.3, 0.0) == pytest.approx(along)


def test_a_lattice_is_loose_where_it_is_said_to_be():
    for kernel, h_over_dx in LOOSEST.items():
        sets = [f"fluid.kernel={kernel}", f"fluid.h_over_dx={h_over_dx}"]
        assert np.abs(shear_moduli(kernel, h_over_dx)).max() < 0.01
        assert not stiff(load_scene("standing_wave", sets))
        assert restless(load_scene("standing_wave", sets)) == 0.0
    assert stiff(load_scene("standing_wave", ["fluid.h_over_dx=1.3"]))
    assert restless(load_scene("standing_wave", ["fluid.h_over_dx=1.2"])) == pytest.approx(0.052, abs=0.001)


def test_particles_swing_faster_by_what_their_lattice_bears():
    """25 deep, a whole swing: what dx does is nearly the same of both."""
    periods = []
    for h_over_dx in (1.3, 1.52):
        model = begun(load_scene("standing_wave", ["fluid.dx=0.04", f"fluid.h_over_dx={h_over_dx}"]))
        crest = [model.probe_values()["crest"]]
        for k in range(50):
            run(model, 0.02, 1, 0.02 * k)
            crest.append(model.probe_values()["crest"])
        periods.append(statistic("wave-period", np.linspace(0.0, 1.0, 51), np.array(crest)))
    short = too_fast("wendland-c2", 1.3, 2.0 * math.pi) - too_fast("wendland-c2", 1.52, 2.0 * math.pi)
    assert 1.0 - periods[0] / periods[1] == pytest.approx(short, rel=0.15)
