"""The beam against Timoshenko's and 2-D elasticity's answers, at rest and in motion."""

from __future__ import annotations

import numpy as np
import pytest

from solid_solver.models import make_model
from tests.beam_models import beam, cantilever, history, oscillating_plate, plate_b, upward_crossings
from tests.solid_scenes import beam_scene, run

# ---- statics --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("across", [2, 10, 20])
def test_case_a_is_timoshenkos(across):
    model = make_model(beam_scene(across, model="beam", damping=300.0), False, 1)
    _, y = history(model, "mid_y", 0.15, 60)
    assert y[-1] == pytest.approx(-5.987037e-5, rel=2e-4)


def test_case_b_is_timoshenkos():
    _, y = history(plate_b(), "mid_y", 0.02, 60)
    assert y[-1] == pytest.approx(-7.109909e-5, rel=2e-4)


def test_two_elements_are_exact():
    """Tip load on a stocky cantilever: F L³/3EI + F L/κGA at the nodes, however few."""
    probe = {"name": "tip", "body": "b", "point": [1.0, 0.1], "quantity": "displacement-y"}
    model = beam(
        dx=0.5,
        damping=10.0,
        probes=[probe],
        bodies=[{"name": "b", "rectangle": [0.0, 0.0, 1.0, 0.2]}],
        clamps=[{"body": "b", "face": "left"}],
        loads=[{"body": "b", "face": "right", "traction": [0.0, 5.0]}],
    )
    _, y = history(model, "tip", 6.0, 100)
    bending, shear = 1.0e6 / (1.0 - 0.3**2) * 0.2**3 / 12.0, 5.0 / 6.0 * 0.2 * 1.0e6 / 2.6
    assert y[-1] == pytest.approx(1.0 / (3.0 * bending) + 1.0 / shear, rel=1e-6)


def test_bending_stress_of_the_clamped_beam():
    """q L²/12 at the clamp and q L²/24 at the middle, linear over the thickness; the shear carries the load."""
    model = make_model(beam_scene(10, model="beam", damping=300.0), False, 1)
    for _ in run(model, 0.15, 60):
        pass
    frame, points = model.frame(), model.describe().position
    moment = 20.0 * 0.2**2 * (1.0 / 24.0 - 0.5 * (points[:, 0] / 0.2 - 0.5) ** 2)
    expected = -moment * (points[:, 1] - 0.006) * 12.0 / 0.012**3
    shear = 1.5 * 20.0 * (points[:, 0] - 0.1) / 0.012 * (1.0 - ((points[:, 1] - 0.006) / 0.006) ** 2)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(frame.fields["stress_xx"], expected, rtol=0, atol=5e-3 * largest)
    np.testing.assert_allclose(frame.fields["stress_xy"], shear, rtol=0, atol=5e-3 * np.abs(shear).max())


def test_stress_at_a_point_is_the_moments_there():
    """Tip load F: M = F (L − x) at every x, not at the middle of the element nearest to it."""
    places = [0.0, 0.1, 0.13, 0.15, 0.19, 0.2]
    probes = [{"name": f"p{k}", "body": "b", "point": [x, 0.02], "quantity": "stress-xx"} for k, x in enumerate(places)]
    model = beam(
        dx=0.005,
        damping=40.0,
        probes=probes,
        bodies=[{"name": "b", "rectangle": [0.0, 0.0, 0.2, 0.02]}],
        clamps=[{"body": "b", "face": "left"}],
        loads=[{"body": "b", "face": "right", "traction": [0.0, -0.2]}],
    )
    for _ in run(model, 1.5, 60):
        pass
    found = model.probe_values()
    moment = 0.2 * 0.02 * (0.2 - np.array(places))
    expected = moment * 0.01 * 12.0 / 0.02**3
    np.testing.assert_allclose(
        [found[f"p{k}"] for k in range(len(places))], expected, rtol=0, atol=1e-3 * expected.max()
    )


# ---- dynamics -------------------------------------------------------------------------------------------------


def test_undamped_step_load_has_2d_elasticitys_peak_and_period():
    model = make_model(beam_scene(10, model="beam"), False, 1)
    t, y = history(model, "mid_y", 0.34, 1700)
    first = np.argmin(y[t < 0.025])
    assert y[first] == pytest.approx(-1.19656e-4, rel=0.01)
    assert t[first] == pytest.approx(0.01659, rel=0.02)
    crossings = upward_crossings(t, y + 5.98626e-5)
    frequency = (len(crossings) - 1) / (crossings[-1] - crossings[0])
    assert frequency == pytest.approx(30.2518, rel=3e-3)
    assert y[t > 0.3].min() == pytest.approx(-1.2e-4, rel=0.02)  # nothing lost in ten periods


@pytest.mark.parametrize(
    ("v_f", "nu", "period", "amplitude"),
    [(0.05, 0.3975, 0.25488, 0.10664), (0.001, 0.3975, 0.25522, None), (0.001, 0.22, 0.27190, None)],
)
def test_oscillating_plate(v_f, nu, period, amplitude):
    model = oscillating_plate(v_f, nu)
    t, y = history(model, "tip", 1.1, 440)
    crossings = upward_crossings(t, y)
    assert np.mean(np.diff(crossings)) == pytest.approx(period, rel=0.008)
    if amplitude is not None:
        assert y.max() == pytest.approx(amplitude, rel=0.01)
        assert -y.min() == pytest.approx(amplitude, rel=0.01)


def test_case_c_plate_bends_far_under_a_dead_load():
    probes = [
        {"name": name, "body": "plate", "point": [0.006, 0.08], "quantity": f"displacement-{name}"} for name in "xy"
    ]
    model = cantilever(probes=probes)
    rows = np.array([(t, *model.probe_values().values()) for t in run(model, 0.1, 400)])
    t, x, y = rows[np.argmax(rows[:, 1])]
    assert x == pytest.approx(0.04146, rel=0.015)
    assert t == pytest.approx(0.0845, rel=0.015)
    assert y == pytest.approx(-0.01345, rel=0.015)


def test_second_order_in_time():
    ramped = [{"body": "plate", "face": "left", "traction": [600.0, 0.0], "ramp": 0.08}]
    probe = {"name": "x", "body": "plate", "point": [0.0, 0.08], "quantity": "displacement-x"}

    def tip(windows):
        model = cantilever(probes=[probe], loads=ramped)
        model.begin(None)
        for w in range(windows):
            model.advance(0.08 * w / windows, 0.08 * (w + 1) / windows, 1, None)
        return model.probe_values()["x"]

    finest = tip(1600)
    coarse, fine = abs(tip(100) - finest), abs(tip(200) - finest)
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.2)
