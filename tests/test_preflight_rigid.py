"""Bodies that nothing bends: pre-flight has nothing to say of their bending."""

from __future__ import annotations

from coupler.preflight_ladder import ladder, smallest
from coupler.preflight_numbers import scene_numbers
from coupler.preflight_rules import findings
from shared.scene import load_scene


def test_a_plate_without_a_modulus_is_rigid_and_that_is_enough():
    choice = smallest(ladder(load_scene("two_levels")))
    assert (choice.fluid, choice.solid) == ("still", "rigid")


def test_a_free_block_is_not_asked_whether_it_rings():
    """It moves as a whole; sound that leaves it is what its case is about."""
    scene = load_scene("water_tube")
    numbers = scene_numbers(scene)
    assert numbers.joint.wet_frequency is None
    assert "Helmholtz" not in {finding.rule for finding in findings(scene, numbers)}
