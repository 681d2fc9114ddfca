"""Pre-flight of bodies made of limbs, frames and tees: what bends is not their bounding box."""

from __future__ import annotations

import numpy as np
import pytest

from coupler.preflight.bounds.solid import of_structure
from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.rules.findings import findings
from shared.geometry.limbs import bearing, limbs
from shared.geometry.particles import fill
from shared.scene.reading import load_scene
from shared.schema.solid import SolidBody
from solid_solver.interface import thickness
from tests.scenes import scene_of
from tests.test_preflight_structures import AT_ONE_END, CLAMPED

FRAMES = {
    "angle": ([[0.0, 0.0, 0.012, 0.1], [0.012, 0.088, 0.1, 0.1]], "bottom", "right", "y", [0.1, 0.1]),
    "tee": ([[0.044, 0.0, 0.056, 0.088], [0.0, 0.088, 0.1, 0.1]], "bottom", "right", "y", [0.1, 0.1]),
    "portal": (
        [[0.0, 0.0, 0.012, 0.1], [0.088, 0.0, 0.1, 0.1], [0.012, 0.088, 0.088, 0.1]], "bottom", "top", "x", [0.0, 0.1],
    ),
    "crank": (
        [[0.0, 0.0, 0.1, 0.012], [0.088, 0.012, 0.1, 0.088], [0.088, 0.088, 0.188, 0.1]], "left", "right", "y",
        [0.188, 0.1],
    ),
}  # fmt: skip
FRAME = """
schema = 1
title = "A frame"
end_time = 1.0
[solid]
model = "total-lagrangian"
dx = {dx}
density = 1000.0
youngs_modulus = 1e7
poisson_ratio = 0.3
bodies = [{{ name = "frame", union = [{shapes}] }}]
clamps = [{{ body = "frame", face = "{foot}" }}]
loads = [{{ body = "frame", face = "{face}", traction = {traction} }}]
[[probes]]
name = "tip"
body = "frame"
point = {point}
quantity = "displacement-{component}"
[goal]
probe = "tip"
statistic = "mean"
[output]
average_from = 0.5
"""


def frame(folder, name, dx):
    boxes, foot, face, component, point = FRAMES[name]
    shapes = ", ".join(f"{{ rectangle = {box} }}" for box in boxes)
    traction = "[500.0, 0.0]" if component == "x" else "[0.0, -500.0]"
    path = folder / "frame.toml"
    named = {"foot": foot, "face": face, "traction": traction, "point": point, "component": component}
    path.write_text(FRAME.format(dx=dx, shapes=shapes, **named), encoding="utf-8")
    return load_scene(path)


@pytest.mark.parametrize(
    ("name", "dx", "error"),
    [
        ("angle", 2e-3, 0.0122),
        ("angle", 1.5e-3, 0.0240),
        ("tee", 2e-3, 0.0159),
        ("tee", 3e-3, 1.154),
        ("tee", 1.5e-3, 0.2302),
        ("portal", 2e-3, 0.0303),
        ("portal", 1.5e-3, 0.0355),
        ("crank", 2e-3, 0.0129),
        ("crank", 1.5e-3, 0.1446),
    ],
)
def test_frames_are_bounded_by_what_2d_elasticity_says_of_them(tmp_path, name, dx, error):
    """Errors of the lattice at rest against quadratic elements. By the bounding box an angle 6 across was bound by
    0.6 %, a tee of three columns for four by 12 %."""
    scene = frame(tmp_path, name, dx)
    assert error <= of_structure(scene, scene_numbers(scene)) <= 4.0 * error


def test_a_frame_swings_as_its_limbs_do(tmp_path):
    """Frequencies by quadratic elements: a frame is stiffer than the straight beam of all its limbs, by half or less.
    Of the bounding box they would be those of a block, hundreds of 1/s."""
    for name, true in (("angle", 7.66), ("tee", 9.28), ("portal", 21.6), ("crank", 3.70)):
        scene = frame(tmp_path, name, 2e-3)
        plate = scene_numbers(scene).plate
        assert true / 1.7 < plate.frequency < true
        assert plate.across == pytest.approx(6.0)
        assert thickness(scene) == pytest.approx(0.012)


def test_a_lattice_that_does_not_fit_a_limb_is_named(tmp_path):
    """Three columns of 3.03 mm for a stem of 12 mm; in a spacing that fits, nothing is said."""
    for dx, said in ((3e-3, ["solid.dx = 0.002 fits"]), (2e-3, [])):
        scene = frame(tmp_path, "tee", dx)
        found = findings(scene, scene_numbers(scene))
        assert [one.way_out for one in found if one.rule == "filled limbs"] == said


@pytest.mark.parametrize("dx", [2.5e-3, 3e-3, 3.4e-3])
def test_limbs_are_as_thick_in_particles_as_their_columns_are(tmp_path, dx):
    body = frame(tmp_path, "tee", dx).solid.bodies[0]
    particles = fill(body, dx)
    low = particles.position[:, 1] < 0.06
    stem = len(np.unique(np.round(particles.position[low, 0], 9))) * particles.spacing[0]
    arms = len(np.unique(np.round(particles.position[~low & (particles.position[:, 0] < 0.03), 1], 9)))
    changed = [(0.012 / t) ** 3 - 1.0 for t in (stem, arms * particles.spacing[1])]
    assert bearing(body, dx) == pytest.approx(max(changed, key=abs), rel=1e-6)


def test_stout_and_slender_pieces_are_no_limbs():
    """Rectangles, discs, a dam, a plate with ledges or a small hole; a ring is."""
    disc = {"circle": {"centre": [0.0, 0.0], "radius": 0.5}}
    hole, bore = ({"circle": {"centre": [x, 0.05 if x else 0.0], "radius": r}} for x, r in ((0.5, 0.02), (0.0, 0.4)))
    ledges = [[0, 0], [0.06, 0], [0.94, 0], [1, 0], [1, 0.1], [0, 0.1]]
    dam = [[0.3, 0.0], [0.5, 0.0], [0.42, 0.2], [0.3, 0.2]]
    strip = {"rectangle": [0.0, 0.0, 1.0, 0.1]}
    for shape in (strip, disc, {"polygon": ledges}, {"polygon": dam}, {"difference": [strip, hole]}):
        assert limbs(SolidBody(name="b", **shape)) is None
    ring = limbs(SolidBody(name="b", difference=[disc, bore]))
    assert ring.thickness == pytest.approx(0.1, rel=1e-3)
    assert ring.length == pytest.approx(0.9 * np.pi, rel=1e-3)


STEPPED = (
    'solid.bodies=[{ name = "plate", polygon = [[0, 0], [0.1, 0], [0.1, 0.01], [0.2, 0.01], [0.2, 0.03], [0.1, 0.03], '
    "[0.1, 0.04], [0, 0.04]] }]",
    'solid.loads=[{ body = "plate", face = "right", traction = [0.0, -1.0] }]',
    "solid.poisson_ratio=0.3",
    "probes.p.point=[0.2, 0.02]",
)


@pytest.mark.parametrize(("dx", "error"), [(0.005, 0.0452), (0.00333333, 0.0253)])
def test_a_step_gives_way_as_a_clamp_does(tmp_path, dx, error):
    """Half as thick from the middle on: 4.5 and 2.5 % too soft, told as 3.2 and 2.0."""
    scene = scene_of(CLAMPED, tmp_path, [*AT_ONE_END, *STEPPED, f"solid.dx={dx}"])
    assert error <= of_structure(scene, scene_numbers(scene)) <= 2.5 * error


def test_no_limb_is_drawn_in_by_the_square_of_its_way(tmp_path):
    """An angle's arm leads one way and its foot the other: twice its bound was told of one of them."""
    scene = frame(tmp_path, "angle", 2e-3)
    turned = scene.model_copy(update={"probes": [scene.probes[0].model_copy(update={"quantity": "displacement-x"})]})
    first, other = (of_structure(one, scene_numbers(one)) for one in (scene, turned))
    assert first == pytest.approx(other)
