"""The cases that ship: they load without a doubt, their references hold what their READMEs say."""

import math
import re

import numpy as np
import pytest

from shared.geometry.particles import fill
from shared.run.curves import read_curve
from shared.scene.reading import load_scene, shipped_cases
from shared.scene.reference import MARKER, reference_file, render
from shared.scene.warnings import scene_warnings

CASES = (
    "cantilever_gravity",
    "cantilever_in_water",
    "dam_break",
    "dam_break_gate",
    "dam_break_plate",
    "dam_break_wall",
    "hydrostatic_plate",
    "lid_cavity",
    "light_gate",
    "oscillating_plate",
    "piston",
    "plate_step_load",
    "prescribed_spin",
    "soft_plate",
    "spinning_square",
    "standing_wave",
    "still_tank",
    "stretched_strip",
    "submerged_block",
    "taylor_green",
    "two_levels",
    "two_reservoirs",
    "udl_beam",
    "udl_beam_dynamic",
    "water_tube",
)


def test_the_cases_are_these():
    assert tuple(shipped_cases()) == CASES


@pytest.mark.parametrize("name", CASES)
def test_case_loads_without_warning_and_says_what_it_shows(name):
    scene = load_scene(name)
    assert scene_warnings(scene) == []
    assert scene.goal is not None
    assert len(scene.description) > 100
    assert "--set" in scene.description


@pytest.mark.parametrize("name", CASES)
def test_the_resolutions_named_in_a_description_load(name):
    scene = load_scene(name)
    for line in re.findall(r"(?:--set \S+ ?)+", scene.description):
        sets = [part.rstrip(".,;:) ") for part in line.split("--set ") if part.strip()]
        load_scene(name, sets)


def test_scene_reference_is_current():
    text = reference_file().read_text(encoding="utf-8")
    assert render(text) == text, "run python -m shared.scene.reference"


def test_worked_scene_of_the_reference_loads(tmp_path):
    text = reference_file().read_text(encoding="utf-8").split(MARKER)[0]
    path = tmp_path / "worked.toml"
    path.write_text(re.search(r"```toml\n(.*?)```", text, re.DOTALL).group(1), encoding="utf-8")
    scene = load_scene(path)
    assert scene_warnings(scene) == []
    assert len(fill(scene.solid.bodies[0], scene.solid.dx).position) < 10 * 30


def test_published_peaks_of_the_plate():
    for reference in load_scene("dam_break_plate").references:
        if reference.curve is not None:
            curve = read_curve(reference.curve, reference.scale)
            t, x = curve[np.argmax(curve[:, 1])]
            assert 0.0445 < x < 0.0486
            assert 0.21 < t < 0.265


def test_measured_fronts_stay_behind_ritter():
    for reference in load_scene("dam_break").references:
        if reference.curve is not None:
            t, x = read_curve(reference.curve, reference.scale).T
            assert np.all(x < 0.146 + 2.0 * math.sqrt(9.81 * 0.292) * t + 1e-3)
            inside = (t > reference.between[0]) & (t < reference.between[1])
            assert 1.5 < np.polyfit(t[inside], x[inside], 1)[0] < 2.4


def test_tanks_hold_the_front_until_the_run_ends():
    scene = load_scene("dam_break")
    fastest = 0.146 + 2.0 * math.sqrt(9.81 * 0.292) * scene.end_time
    assert max(x for x, _ in scene.walls[0].polyline) > fastest


def test_static_values_follow_from_thin_beam_and_shear():
    """The 2-D values lie within 1 % of Timoshenko's beam: load L⁴/(384 D) + load L²/(8 κ G H)."""
    cases = {"udl_beam": 20.0, "soft_plate": 1000 * 9.81 * 0.1, "hydrostatic_plate": 1000 * 9.81 * 2.0}
    for name, load in cases.items():
        scene = load_scene(name)
        solid = scene.solid
        x0, y0, x1, y1 = solid.bodies[0].rectangle
        length, height = x1 - x0, y1 - y0
        load += solid.density * height * abs(scene.gravity[1])
        stiffness = solid.youngs_modulus * height**3 / (12 * (1 - solid.poisson_ratio**2))
        shear = 5 / 6 * solid.youngs_modulus / (2 * (1 + solid.poisson_ratio)) * height
        expected = -(load * length**4 / (384 * stiffness) + load * length**2 / (8 * shear))
        assert scene.references[0].value == pytest.approx(expected, rel=0.01)
        assert scene.references[1].value == pytest.approx(-load * length**4 / (384 * stiffness), rel=0.002)
