"""Water at rest as it starts: at the faces that hold it, and as deep as it presses."""

from __future__ import annotations

import numpy as np

from fluid_solver.settled import LIGHTEST, settle
from shared.geometry.particles import fill
from shared.geometry.regions import outline
from shared.schema.geometry import Body

G, C0, RHO0, DX = 9.81, 15.0, 1000.0, 5e-3
TANK, BLOCK = (0.0, 0.0, 0.4, 0.3), (0.14, 0.12, 0.26, 0.17)


NOTHING = np.empty((0, 2, 2))


def settled(body: Body, gravity=(0.0, -G), faces=NOTHING):
    lattice = fill(body, DX)
    place, pressure, share = settle(body, lattice.position, np.array(gravity), C0, RHO0, faces, DX)
    return lattice.position, place, pressure, share


def test_settled_water_keeps_to_the_faces_above_and_below_it():
    """Let down as a whole it stood a quarter of dx off the block's underside, and a third too near to its top."""
    block = Body(name="water", difference=[{"rectangle": TANK}, {"rectangle": BLOCK}])
    faces = outline(Body(name="block", rectangle=BLOCK))[:, ::-1]
    before, after, pressure, share = settled(block, faces=faces)
    over = (before[:, 0] > BLOCK[0]) & (before[:, 0] < BLOCK[2])
    under, above = over & (before[:, 1] < BLOCK[1]), over & (before[:, 1] > BLOCK[3])
    assert abs(after[under, 1].max() - BLOCK[1] + 0.5 * DX) < 0.01 * DX
    assert abs(after[above, 1].min() - BLOCK[3] - 0.5 * DX) < 0.01 * DX
    level = C0**2 / G * np.log1p(G * TANK[3] / C0**2)
    held = RHO0 * C0**2 * np.expm1(G * (level - after[:, 1]) / C0**2)  # dp/dy = −ρ g with ρ = ρ0 + p/c²
    np.testing.assert_allclose(pressure, held, rtol=1e-9, atol=1e-9)
    column = np.abs(before[:, 0] - 0.2) < 0.6 * DX  # what presses on the block is what stands on it
    weight = RHO0 * G * DX * share[column & above].sum() * 0.5
    assert abs(weight / (RHO0 * C0**2 * np.expm1(G * (level - BLOCK[3]) / C0**2)) - 1.0) < 1e-9


def test_a_column_that_stands_on_the_bottom_keeps_its_mass_whichever_way_gravity_points():
    for gravity in ((0.0, -G), (G, 0.0), (-6.0, -8.0)):
        _, _, pressure, share = settled(Body(name="water", rectangle=TANK), gravity)
        if 0.0 in gravity:
            assert (share == 1.0).all()
        assert pressure.min() >= 0.0
    before, after, _, share = settled(Body(name="water", rectangle=TANK), (0.0, 0.0))
    assert (share == 1.0).all()
    assert np.array_equal(before, after)


def test_a_particle_that_packing_moved_out_of_the_surface_beside_a_slope_is_of_the_water_below_it():
    """Between two faces of no distance its mass was not a number (a shore of 45 degrees); deep water is let down from
    the edge of a shore, where there was next to no mass."""
    shore = Body(name="water", polygon=[(0.0, 0.0), (0.4, 0.0), (0.7, 0.3), (0.0, 0.3)])
    points = np.array([(0.693, 0.3016), (0.2, 0.301), (0.7, 0.3), (0.6985, 0.2993), (0.2, 0.2)])
    place, pressure, share = settle(shore, points, np.array([0.0, -G]), C0, RHO0, NOTHING, DX)
    assert np.isfinite(place).all()
    assert np.abs(pressure[:3]).max() < 2e-3 * RHO0 * G
    np.testing.assert_allclose(place[:, 1] - points[:, 1], 0.0, atol=0.7 * DX)
    assert share.min() >= LIGHTEST
    assert share[4] == 1.0


def test_each_level_of_water_in_one_outline_is_settled_by_itself():
    """A deep and a shallow water, as before a dam break onto a wet bed, with a block in the shallow one: its floor
    started at the deep one's pressure, 2450 for 490 Pa, and the bed leapt up."""
    bed, block = (0.15, 0.0, 0.4, 0.1), (0.2, 0.04, 0.3, 0.06)
    water = {"union": [{"rectangle": (0.0, 0.0, 0.15, 0.3)}, {"rectangle": bed}]}
    faces = outline(Body(name="block", rectangle=block))[:, ::-1]
    for turn, gravity in ((0.0, (0.0, -G)), (90.0, (G, 0.0))):
        body = Body(name="water", difference=[water, {"rectangle": block}], rotate={"angle": turn})
        held = faces if turn == 0.0 else np.stack([-faces[..., 1], faces[..., 0]], axis=2)
        before, after, pressure, share = settled(body, gravity, held)
        x, y = before.T if turn == 0.0 else (before[:, 1], -before[:, 0])
        deep = np.where(x < bed[0], 0.3, 0.1) - y
        np.testing.assert_allclose(pressure, RHO0 * G * deep, rtol=0.02)
        assert np.abs(share - 1.0).max() < 0.02
        lowered = np.abs(after - before).max(axis=1)
        assert lowered[x < bed[0]].max() > 1.5e-3  # g H²/2c² is 2 mm
        assert lowered[x > bed[0]].max() < 0.25e-3


def test_a_surface_that_slopes_starts_at_no_pressure():
    """As of a wave let go at its highest: all water was pressed as if it stood below the highest point."""
    body = Body(name="water", polygon=[(0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.0, 0.25)])
    before, _, pressure, share = settled(body)
    surface = 0.25 - 0.125 * before[:, 0]
    np.testing.assert_allclose(pressure, RHO0 * G * (surface - before[:, 1]), atol=1e-9 * RHO0 * G)
    np.testing.assert_allclose(share, 1.0, rtol=1e-12)
