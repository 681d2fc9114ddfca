"""Pressures integrated over a structure's own faces: buoyancy, following pressure, and the same load as the forces'."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest

from coupler.mapping import build_mapping
from coupler.run import check_pressures
from fluid_solver.models import make_model as make_fluid
from shared.contract import BadInput, Description, Kinematics
from shared.face_loads import FaceLoads
from shared.geometry.particles import fill
from shared.geometry.regions import area
from shared.scene.reading import load_scene
from tests.coupled_models import couple

WEIGHTLESS = ["gravity=[0.0, 0.0]", "fluid.sound_speed=60.0"]
FREE = ["solid.clamps=[]", "solid.bodies.plate.free=true"]


def described(scene, **numbers) -> Description:
    x = fill(scene.solid.bodies[0], scene.solid.dx).position
    return Description("solid", "structure", "", 1.0, 2e-3, x, np.ones(len(x)), np.zeros(len(x), dtype=int), numbers)


UNDER_WATER = """\
schema = 1
title = "Under water"
end_time = 1.0
gravity = [0.0, -9.81]
coupling = { loads = "pressure" }
walls = [{ name = "tank", polyline = [[0.0, 0.4], [0.0, 0.0], [0.4, 0.0], [0.4, 0.4]] }]
fluid = { model = "wcsph", dx = 0.01, sound_speed = 15.0, h_over_dx = 2.0, bodies = [
    { name = "water", difference = [{ rectangle = [0.0, 0.0, 0.4, 0.3] }, { SHAPE }] },
] }
solid = { model = "spring", dx = 0.01, density = 1500.0, bodies = [{ name = "block", free = true, SHAPE }] }
"""


def submerged(shape, folder, *sets):
    (folder / "case.toml").write_text(UNDER_WATER.replace("SHAPE", shape), encoding="utf-8")
    return load_scene(folder / "case.toml", sets)


def plate(*sets):
    scene = load_scene("soft_plate", ["solid.dx=2e-3", *sets])
    structure = described(scene)
    return FaceLoads(scene, structure), structure.position


def test_water_all_round_lifts_with_its_weight():
    """p = −ρ g y on a free plate: the force is ρ g times its area, upwards, whatever its place; none sideways."""
    faces, x = plate(*FREE)
    place = x + [0.0, -3.0]
    total = faces.force(-9810.0 * place[:, 1], place).sum(axis=0)
    np.testing.assert_allclose(total, [0.0, 9810.0 * 0.2 * 0.012], rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize(
    "shape",
    [
        "circle = { centre = [0.2, 0.15], radius = 0.05 }",
        "polygon = [[0.15, 0.1], [0.25, 0.1], [0.25, 0.11], [0.3, 0.2], [0.1, 0.2], [0.15, 0.11]]",
        "rectangle = [0.14, 0.12, 0.26, 0.17], rotate = { angle = 30.0, about = [0.2, 0.145] }",
    ],
)
def test_water_lifts_a_body_of_any_shape_with_its_weight(shape, tmp_path):
    """Taken twice where an edge is a side too, and not at all where it is shorter than the spacing, it was nothing
    (a disc) to five times that (a triangle)."""
    scene = submerged(shape, tmp_path)
    lattice, body = fill(scene.solid.bodies[0], 0.01), scene.solid.bodies[0]
    x = lattice.position
    points = Description("solid", "structure", "", 1.0, 0.01, x, np.ones(len(x)), np.zeros(len(x), dtype=int))
    total = FaceLoads(scene, points).force(9810.0 * (0.3 - x[:, 1]), x).sum(axis=0)
    np.testing.assert_allclose(total, [0.0, 9810.0 * area(body)], rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("spacing", [0.01, 0.02, 0.005])
@pytest.mark.parametrize("model", ["wcsph", "ctvf"])
def test_pressures_over_a_block_in_resting_water_are_its_buoyancy(model, spacing, tmp_path):
    """At the start, whatever the two spacings: by water let down under the block, half a spacing behind its faces and
    ghosts out of the water's reach, 46 to 530 % off. The force on the ghosts is that too."""
    scene = submerged("rectangle = [0.14, 0.12, 0.26, 0.18]", tmp_path, f"fluid.model={model}", f"solid.dx={spacing}")
    fluid, body = make_fluid(scene, True, 1), scene.solid.bodies[0]
    ghosts, x = fluid.describe(), fill(body, spacing).position
    points = Description("solid", "structure", "", 1.0, spacing, x, np.ones(len(x)), np.zeros(len(x), dtype=int))
    mapping = build_mapping(points, ghosts, scene.gravity)
    still = Kinematics.at_rest(ghosts.position)
    pressure, loads = np.zeros(len(x)), fluid.begin(still)
    pressure[mapping.selection] = mapping.loads(loads, Kinematics.at_rest(x[mapping.selection]), still).pressure
    for found in (FaceLoads(scene, points).force(pressure, x), loads.force):
        np.testing.assert_allclose(found.sum(axis=0), [0.0, 9810.0 * area(body)], rtol=0.02, atol=1e-6)


@pytest.mark.parametrize("across", [3, 4, 5])
def test_the_dry_side_of_a_floor_feels_nothing_of_ghosts_that_it_serves_half_way_through(across, tmp_path):
    """Spacings that do not coincide: points of the dry side took the pressure of the deepest ghosts that water reaches,
    and a floor of 4.5 dx was lifted by its own water, 97 % off."""
    text = UNDER_WATER.replace(
        "rectangle = [0.0, 0.0, 0.4, 0.3] }, { SHAPE", "rectangle = [0.0, 0.045, 0.4, 0.3] }, { SHAPE"
    )
    text = text.replace("SHAPE", "rectangle = [0.0, 0.0, 0.4, 0.045]")
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    scene = load_scene(tmp_path / "case.toml", [f"solid.dx={0.045 / across}"])
    fluid, body = make_fluid(scene, True, 1), scene.solid.bodies[0]
    ghosts, x = fluid.describe(), fill(body, scene.solid.dx).position
    ones = np.ones(len(x))
    points = Description("solid", "structure", "", 1.0, scene.solid.dx, x, ones, np.zeros(len(x), dtype=int))
    mapping, still = build_mapping(points, ghosts, scene.gravity), Kinematics.at_rest(ghosts.position)
    pressure, loads = np.zeros(len(x)), fluid.begin(still)
    pressure[mapping.selection] = mapping.loads(loads, Kinematics.at_rest(x[mapping.selection]), still).pressure
    found = FaceLoads(scene, points).force(pressure, x).sum(axis=0)
    np.testing.assert_allclose(found[1], -9810.0 * 0.255 * 0.4, rtol=0.05)


def test_constant_pressure_on_a_closed_outline_is_no_force_however_it_bends():
    faces, x = plate(*WEIGHTLESS, *FREE)
    bent = x + np.stack([np.zeros(len(x)), 0.02 * np.sin(10.0 * x[:, 0])], axis=1)
    force = faces.force(np.full(len(x), 1e4), bent)
    assert np.abs(force).sum() > 100.0
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=0.01 * np.abs(force).sum())


def test_clamped_faces_carry_nothing_and_pressure_turns_with_the_body():
    faces, x = plate(*WEIGHTLESS)
    pressure = np.where(x[:, 1] > -0.002, 500.0, 0.0)
    np.testing.assert_allclose(faces.force(pressure, x).sum(axis=0), [0.0, -500.0 * 0.2], atol=1e-6)
    quarter = np.stack([-x[:, 1], x[:, 0]], axis=1)
    np.testing.assert_allclose(faces.force(pressure, quarter).sum(axis=0), [500.0 * 0.2, 0.0], atol=1e-6)


@pytest.mark.parametrize(("support", "fits"), [(0.0156, False), (0.012 * (1.0 + 1e-15), True)])
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
