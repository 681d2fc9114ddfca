"""Fluid on a lattice that slanted faces cut: packed before the start, so that water at rest is not stirred."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fluid_solver import initial
from fluid_solver.ghosts import lay_ghosts
from fluid_solver.initial import boundary_faces, fluid_particles
from fluid_solver.packing import CLEAR, cutting
from shared.geometry.regions import distance_to
from shared.kernels import kernel_named
from tests.fluid_models import begun, run, scene

DX = 0.025
KERNEL = kernel_named("wendland-c2")
RIDGE = [(0.3, 0.0), (0.45, 0.15), (0.6, 0.0)]
TANK = [(0.0, 0.6), (0.0, 0.0), *RIDGE, (0.9, 0.0), (0.9, 0.6)]


def over_a_ridge(h_over_dx=2.0, model="wcsph"):
    """0.3 m of water in a tank whose floor has a ridge of half that height."""
    water = {"name": "water", "polygon": [(0.0, 0.0), *RIDGE, (0.9, 0.0), (0.9, 0.3), (0.0, 0.3)]}
    probes = [{"name": "p", "quantity": "pressure", "point": (0.45, 0.18)}]
    walls = [{"name": "tank", "polyline": TANK}]
    return scene([water], walls=walls, probes=probes, dx=DX, h_over_dx=h_over_dx, model=model)


def laid(case):
    """Fluid and ghosts of a scene at t = 0."""
    ghosts = lay_ghosts(case, KERNEL.support * (case.fluid.h_over_dx * case.fluid.dx))
    return fluid_particles(case, 20.0, ghosts), ghosts


def packed_off(case, monkeypatch):
    """The faces that cut the lattice of a scene, its fluid on that lattice and as packed off them, and the ghosts."""
    packed, ghosts = laid(case)
    monkeypatch.setattr(initial, "pack", lambda fluid, position, *_: position)
    lattice, _ = laid(case)
    faces = cutting(boundary_faces(case), lattice.position, DX)
    gaps = [distance_to(faces, one.position).min() / DX for one in (lattice, packed)]
    assert gaps[0] < 0.3
    assert gaps[1] > CLEAR - 0.05  # settled, it stands a little lower
    return faces, lattice, packed, ghosts


def test_particles_stand_evenly_off_a_slope(monkeypatch):
    slopes, lattice, packed, ghosts = packed_off(over_a_ridge(1.3), monkeypatch)
    assert len(slopes) == 2
    apart = [
        cKDTree(np.concatenate([one.position, ghosts.position])).query(one.position, 2)[0][:, 1].min() / DX
        for one in (lattice, packed)
    ]
    assert apart[1] > max(0.7, apart[0])
    moved = np.hypot(*(packed.position - lattice.position).T) > 1e-3 * DX
    assert not moved[lattice.position[:, 1] > 0.3 - DX].any()  # the surface
    assert distance_to(slopes, lattice.position[moved]).max() < 2.0 * 2.0 * 1.3 * DX
    np.testing.assert_allclose(packed.mass, lattice.mass, rtol=2e-3)  # what a column holds between its ends


def test_a_lattice_that_fits_its_faces_stays():
    case = scene([{"name": "water", "rectangle": (0.0, 0.0, 0.2, 0.1)}], dx=0.01)
    assert len(cutting(boundary_faces(case), laid(case)[0].position, 0.01)) == 0


def test_a_step_that_the_lattice_does_not_fit_is_packed_too(monkeypatch):
    """A block in water at rest, half a spacing off: its lift 3.5 % low (h = 1.3 dx), now 0.1 %; half as stirred."""
    step = [(0.0, 0.0), (0.1125, 0.0), (0.1125, 0.1), (0.3, 0.1), (0.3, 0.3), (0.0, 0.3)]
    walls = [{"name": "tank", "polyline": [(0.0, 0.4), *step[:4], (0.3, 0.4)]}]
    case = scene([{"name": "water", "polygon": step}], walls=walls, dx=DX, h_over_dx=1.3)
    faces, *_ = packed_off(case, monkeypatch)
    assert len(faces) == 1


@pytest.mark.parametrize("h_over_dx", [1.3, 2.0])
def test_water_at_rest_over_a_ridge_stays_at_rest(h_over_dx):
    """As the lattice lies, it is stirred and its mean pressure a fifth too high."""
    model = begun(over_a_ridge(h_over_dx))
    pressures = []
    for k in range(20):
        run(model, 0.05, 1, 0.05 * k)
        pressures.append(model.probe_values()["p"])
    assert np.mean(pressures[5:]) == pytest.approx(1000.0 * 9.81 * 0.12, rel=0.05)


def test_water_at_rest_on_a_shore_stays_at_rest():
    """Not packed below its surface, it is stirred (the pressure scatters by 48 Pa) and throws a drop over the shore."""
    edge = 0.6 + 0.3 * np.sqrt(3.0)
    water = {"name": "water", "polygon": [(0.0, 0.0), (0.6, 0.0), (edge, 0.3), (0.0, 0.3)]}
    tank = [(0.0, 0.5), (0.0, 0.0), (0.6, 0.0), (0.6 + 0.5 * np.sqrt(3.0), 0.5)]
    probes = [{"name": "p", "quantity": "pressure", "point": (0.45, 0.1)}]
    walls = [{"name": "tank", "polyline": tank}]
    model = begun(scene([water], walls=walls, probes=probes, dx=DX, h_over_dx=2.0, model="wcsph"))
    pressures = []
    for k in range(20):
        run(model, 0.05, 1, 0.05 * k)
        pressures.append(model.probe_values()["p"])
    assert np.mean(pressures[6:]) == pytest.approx(1000.0 * 9.81 * 0.2, rel=0.005)
    assert np.std(pressures[6:]) < 12.0
    assert model.losses()["lost"] == 0
