"""Pressures integrated over a structure's own faces: buoyancy, following pressure, and the same load as the forces'."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest

from coupler.run import check_pressures
from shared.contract import BadInput, Description
from shared.face_loads import FaceLoads
from shared.geometry import fill
from shared.scene import load_scene
from tests.coupled_models import couple

FREE = ["solid.clamps=[]", "solid.bodies.plate.free=true"]


def described(scene, **numbers) -> Description:
    x = fill(scene.solid.bodies[0], scene.solid.dx).position
    return Description("solid", "structure", "", 1.0, 2e-3, x, np.ones(len(x)), np.zeros(len(x), dtype=int), numbers)


def plate(*sets):
    scene = load_scene("soft_plate", ["solid.dx=2e-3", *sets])
    structure = described(scene)
    return FaceLoads(scene, structure), structure.position


def test_water_all_round_lifts_with_its_weight():
    """p = −ρ g y on a free plate: the force is ρ g times its area, upwards, whatever its place; none sideways."""
    faces, x = plate(*FREE)
    place = x + [0.0, -3.0]
    # what a point carries is the pressure at its place; its face is half a spacing farther out, on both sides alike
    total = faces.force(-9810.0 * place[:, 1], place).sum(axis=0)
    np.testing.assert_allclose(total, [0.0, 9810.0 * 0.2 * (0.012 - 0.002)], rtol=1e-9, atol=1e-6)


def test_constant_pressure_on_a_closed_outline_is_no_force_however_it_bends():
    faces, x = plate(*FREE)
    bent = x + np.stack([np.zeros(len(x)), 0.02 * np.sin(10.0 * x[:, 0])], axis=1)
    force = faces.force(np.full(len(x), 1e4), bent)
    assert np.abs(force).sum() > 100.0
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=0.01 * np.abs(force).sum())


def test_clamped_faces_carry_nothing_and_pressure_turns_with_the_body():
    faces, x = plate()
    pressure = np.where(x[:, 1] > -0.002, 500.0, 0.0)
    np.testing.assert_allclose(faces.force(pressure, x).sum(axis=0), [0.0, -500.0 * 0.2], atol=1e-6)
    quarter = np.stack([-x[:, 1], x[:, 0]], axis=1)
    np.testing.assert_allclose(faces.force(pressure, quarter).sum(axis=0), [500.0 * 0.2, 0.0], atol=1e-6)


@pytest.mark.parametrize(("support", "fits"), [(0.0156, False), (0.0052, True)])
def test_a_plate_thinner_than_the_kernel_is_refused(support, fits):
    scene = load_scene("soft_plate", ["solid.dx=2e-3", "coupling.loads=pressure"])
    sides = described(scene, thickness=0.012), described(scene, support=support)
    with nullcontext() if fits else pytest.raises(BadInput, match="dry side would feel"):
        check_pressures(scene, *sides)


def test_a_plate_under_columns_bends_alike_under_forces_and_pressures():
    """Also while windows are iterated: the pieces follow the plate as it stands at the window's start."""
    sets = [
        "fluid.model=column",
        "solid.model=beam",
        "solid.dx=3e-3",
        "fluid.dx=2e-3",
        "end_time=0.02",
        "output.average_from=0",
    ]
    sets += ["coupling.scheme=serial-implicit", "coupling.window=1e-4"]
    bent = [
        couple(load_scene("soft_plate", [*sets, f"coupling.loads={kind}"]), along=(0.0, 1.0)).points
        for kind in ("force", "pressure")
    ]
    assert np.abs(bent[0]).max() > 1e-5
    np.testing.assert_allclose(bent[1], bent[0], atol=0.03 * np.abs(bent[0]).max())
