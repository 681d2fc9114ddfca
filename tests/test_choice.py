"""What `auto` chooses, when it steps up, and that it says so; the ledger's limits."""

from __future__ import annotations

import numpy as np
import pytest

from coupler.choice import Auto, is_measured
from coupler.ledger import Ledger, LedgerExceeded
from coupler.run import run_coupled
from coupler.schemes import Outcome
from coupler.window import Plan
from fluid_solver.models import make_model as make_fluid
from shared.clock import Clock
from shared.contract import Kinematics, Loads
from shared.schema.coupling import Coupling, Limits
from solid_solver.models import make_model as make_solid
from tests.coupled_models import couple, join, march, piston

ABSORBING = "fluid.column.reflection=0"


def test_a_heavy_piston_is_left_to_lagged_exchange():
    history = couple(piston([ABSORBING, "end_time=0.1"], scheme="auto", window=1e-3))
    assert history.plan.scheme == "serial-explicit"
    assert len(history.plan.reasons) == 1
    assert all(outcome.converged for outcome in history.outcomes)
    assert all(len(o.changes) == (2 if is_measured(k) else 1) for k, o in enumerate(history.outcomes))


def test_a_light_piston_is_iterated_from_the_start():
    history = couple(piston([ABSORBING, "end_time=0.1", "solid.density=500"], scheme="auto", window=1e-3))
    assert history.plan.scheme == "serial-implicit"
    assert "response" in history.plan.reasons[0]
    assert all(outcome.converged for outcome in history.outcomes)


def test_a_measured_response_ends_lagged_exchange():
    """Told that lagged exchange would do, `auto` measures |g| = r = 0.9 in window 1 and steps up."""
    scene = piston(["fluid.column.compressible=false", f"solid.density={10000.0 / 0.9!r}", "end_time=0.02"])
    clock, plan = Clock.fitting(0.02, 1e-3), Plan("serial-explicit", 1e-3)
    c = join(make_fluid(scene, True, 1), make_solid(scene, True, 1), clock, 0)
    history = march(c, Auto(plan, Coupling()), clock, 20)
    assert plan.reasons == [
        "window 1, t = 0.001 s: serial-explicit to serial-implicit: measured response of the load to itself 0.9"
    ]
    assert all(len(outcome.changes) > 1 for outcome in history.outcomes[2:])


def test_overshooting_loads_end_lagged_exchange(monkeypatch):
    """The same without measured windows: the lagged load swings to and fro, each time by more."""
    monkeypatch.setattr("coupler.choice.is_measured", lambda index: False)
    scene = piston(["fluid.column.compressible=false", f"solid.density={10000.0 / 1.3!r}", "end_time=0.04"])
    clock, plan = Clock.fitting(0.04, 1e-3), Plan("serial-explicit", 1e-3)
    c = join(make_fluid(scene, True, 1), make_solid(scene, True, 1), clock, 0)
    history = march(c, Auto(plan, Coupling()), clock, 40)
    assert "overshot" in plan.reasons[0]
    assert np.abs(history.points).max() < 1e-3


@pytest.mark.parametrize(("windows", "leaves"), [(31, False), (32, True)])
def test_loads_that_stay_astray_end_lagged_exchange(windows, leaves):
    """The interface's points ripple, each by itself: their sum, and the response to one more iteration, stay small."""
    plan, rng = Plan("serial-explicit", 1e-3), np.random.default_rng(0)
    auto, clock, points = Auto(plan, Coupling()), Clock(1.0, 100), Kinematics.at_rest(np.zeros((50, 2)))
    for k in range(windows):
        used, found = (Loads(np.zeros(50), rng.normal(size=(50, 2))) for _ in range(2))
        change = float(np.linalg.norm(found.force - used.force) / np.linalg.norm(found.force))
        auto._watch(clock.window(k), Outcome(used, found, found, (points, points), (points, points), (change,)))
    assert bool(plan.reasons) == leaves
    again = Auto(Plan("serial-explicit", 1e-3), Coupling())
    again.restore(auto.state())
    assert {name: array.tobytes() for name, array in again.state().items()} == {
        name: array.tobytes() for name, array in auto.state().items()
    }


def test_choice_repeats_to_the_byte():
    sets = [ABSORBING, "end_time=0.1", "solid.density=500"]
    runs = [couple(piston(sets, scheme="auto", window=1e-3)).points.tobytes() for _ in range(2)]
    assert runs[0] == runs[1]


def test_reasons_are_in_the_result_and_the_log(tmp_path):
    scene = piston([ABSORBING, "end_time=0.02"], scheme="auto", window=1e-3)
    record = run_coupled(scene, "piston", tmp_path / "run", {"fluid": 1, "solid": 1}, True, "inprocess")
    coupling = record.result["cost"]["coupling"]
    assert coupling["scheme"] == "serial-explicit"
    assert coupling["reasons"][0].startswith("serial-explicit: α = 0.05")
    assert coupling["reasons"][0] in (tmp_path / "run" / "log" / "coupler.txt").read_text()


def test_the_ledger_stops_a_pumped_column_and_names_the_way_out(tmp_path):
    """Lagged exchange with a column that loses nothing makes energy; the run ends before it blows up."""
    scene = piston(scheme="serial-explicit", window=4e-3)
    with pytest.raises(LedgerExceeded, match=r"energy .* coupling.limits.energy = 0.5.*serial-implicit"):
        couple(scene, ledger=Ledger(tmp_path / "ledger.csv", scene.coupling.limits))
    couple(scene, 150, ledger=Ledger(tmp_path / "free.csv", Limits(energy=1e9, impulse=1e9)))


def test_the_ledgers_warning_ends_lagged_exchange(tmp_path, monkeypatch):
    """Such a column under `auto`, which overlooks its response: warned of the energy made, it iterates in time."""
    monkeypatch.setattr("coupler.choice.is_measured", lambda index: False)
    limits = Limits(energy=0.3)
    scene = piston(window=1e-3)
    clock, plan = Clock.fitting(scene.end_time, 1e-3), Plan("serial-explicit", 1e-3)
    c = join(make_fluid(scene, True, 1), make_solid(scene, True, 1), clock, 0)
    ledger = Ledger(tmp_path / "ledger.csv", limits)
    march(c, Auto(plan, Coupling()), clock, clock.count, ledger=ledger)
    assert "of the work at the interface" in plan.reasons[0]
    assert abs(ledger.summary()["work_error"]) < limits.energy


def one_window(used: float, found: float) -> Outcome:
    """A window in which a point goes 1 m under the force `used`, the water having pushed it by `found` [N/m]."""
    loads = [Loads(np.zeros(1), np.array([[force, 0.0]])) for force in (used, found)]
    way = Kinematics.at_rest(np.zeros((1, 2))), Kinematics.at_rest(np.array([[1.0, 0.0]]))
    return Outcome(loads[0], loads[1], loads[1], way, way, (0.0,))


def test_energy_lost_while_the_work_grows_is_the_lag_of_a_load_that_grows(tmp_path):
    """Water strikes a stiff wall: each window's load is 1.2 times the last, and used a window late."""
    ledger, clock = Ledger(tmp_path / "ledger.csv", Limits(energy=0.15, impulse=1e9)), Clock(1.0, 300)
    force, said = 1.0, []
    for k in range(60):
        said.append(ledger.record(clock.window(k), one_window(force / 1.2, force)))
        force *= 1.2
    assert ledger.summary()["work_error"] == pytest.approx(-1.0 / 6.0, rel=1e-3)
    assert said == [""] * 60


def test_energy_that_stays_lost_is_warned_of_and_ends_the_run(tmp_path):
    ledger, clock = Ledger(tmp_path / "ledger.csv", Limits(energy=0.6, impulse=1e9)), Clock(1.0, 300)
    ledger.record(clock.window(0), one_window(0.5, 1.0))
    said = [ledger.record(clock.window(k), one_window(0.0, 0.0)) for k in range(1, 50)]
    assert [k for k, text in enumerate(said, 1) if text] == [40]
    strict = Ledger(tmp_path / "strict.csv", Limits(energy=0.4, impulse=1e9))
    strict.record(clock.window(0), one_window(0.5, 1.0))
    for k in range(1, 20):
        strict.record(clock.window(k), one_window(0.0, 0.0))
    with pytest.raises(LedgerExceeded, match=r"window 20, .*energy 0\.5"):
        strict.record(clock.window(20), one_window(0.0, 0.0))


def test_what_noise_loses_at_a_stiff_wall_is_set_against_all_the_work_turned_over(tmp_path):
    """Water has struck, the wall has sprung back, and each window's noise of the pressure takes a twentieth of its
    work: after 150 of them three quarters of the largest work, and no reason to iterate."""
    ledger, clock = Ledger(tmp_path / "ledger.csv", Limits(energy=0.5, impulse=1e9)), Clock(1.0, 300)
    forces = [10.0, -8.0, *([1.0, -1.0] * 75)]
    said = [ledger.record(clock.window(k), one_window(f - 0.05, f)) for k, f in enumerate(forces)]
    assert ledger.summary()["work_error"] == pytest.approx(-0.76, abs=0.01)
    assert said == [""] * len(forces)


def test_energy_made_before_the_exchange_was_iterated_does_not_end_the_run(tmp_path):
    ledger, clock = Ledger(tmp_path / "ledger.csv", Limits(energy=0.4, impulse=1e9)), Clock(1.0, 300)
    ledger.record(clock.window(0), one_window(1.5, 1.0))
    for k in range(1, 15):
        ledger.record(clock.window(k), one_window(0.0, 0.0))
    ledger.excuse()
    for k in range(15, 100):
        assert ledger.record(clock.window(k), one_window(0.0, 0.0)) == ""
    assert ledger.summary()["work_error"] == pytest.approx(0.5 / 1.5)
    ledger.record(clock.window(100), one_window(3.5, 1.0))
    with pytest.raises(LedgerExceeded):
        list(map(ledger.record, map(clock.window, range(101, 130)), [one_window(0.0, 0.0)] * 29))


def test_the_ledger_leaves_an_iterated_column_alone(tmp_path):
    ledger = Ledger(tmp_path / "ledger.csv", Limits(energy=1e-3, impulse=1e-3))
    couple(piston(["end_time=0.5"], window=2e-3, scheme="serial-implicit"), ledger=ledger)
    assert abs(ledger.summary()["work_error"]) < 1e-3


def test_force_lost_by_the_map_stops_the_run_at_once(tmp_path):
    scene = piston(window=1e-3, scheme="serial-explicit")
    with pytest.raises(LedgerExceeded, match="mapping"):
        couple(scene, 5, ledger=Ledger(tmp_path / "ledger.csv", Limits(mapping=1e-300)))


def test_rounding_of_places_is_no_energy(tmp_path):
    """A piston on its spring without a load: forces of 1e-11 N, ways of 1e-17 m, works of 1e-28 J."""
    ledger = Ledger(tmp_path / "ledger.csv", Limits())
    couple(piston(["solid.loads=[]", "end_time=0.3"], scheme="serial-implicit", window=1e-3), ledger=ledger)
    assert abs(ledger.summary()["work_error"]) < 0.1


def two_points(used: float, found: float) -> Outcome:
    """Two points that turn about the origin, forces ±1 N/m that push them on, and a net of rounding besides."""
    loads = [Loads(np.zeros(2), np.array([[0.0, 1.0 + net], [0.0, -1.0]])) for net in (used, found)]
    places = [np.array([[np.cos(a), np.sin(a)], [-np.cos(a), -np.sin(a)]]) for a in (0.0, 0.1)]
    way = tuple(map(Kinematics.at_rest, places))
    return Outcome(loads[0], loads[1], loads[1], way, way, (0.0,))


def test_forces_that_cancel_are_no_measure_of_the_impulse(tmp_path):
    ledger, clock = Ledger(tmp_path / "ledger.csv", Limits()), Clock(1.0, 300)
    for k in range(60):
        ledger.record(clock.window(k), two_points(1e-15, -1e-15))
    assert ledger.summary()["impulse_error"] < 1e-14


def test_a_structure_whose_motion_is_prescribed_cannot_lag(tmp_path):
    """Lag throws nothing about where nobody takes the load; force lost by the map still ends the run."""
    clock, lost = Clock(1.0, 300), one_window(2.0, 1.0)
    free, told = (Ledger(tmp_path / f"{p}.csv", Limits(), prescribed=p) for p in (False, True))
    with pytest.raises(LedgerExceeded):
        [free.record(clock.window(k), lost) for k in range(60)]
    assert [told.record(clock.window(k), lost) for k in range(60)] == [""] * 60
    half = Outcome(lost.used, lost.found, Loads.zero(1), lost.points, lost.ghosts, (0.0,))
    with pytest.raises(LedgerExceeded, match="mapping"):
        told.record(clock.window(60), half)
