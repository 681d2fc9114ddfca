"""The verbs' order is watched, and rollback returns to the same bytes."""

from __future__ import annotations

import numpy as np
import pytest

from shared.clock import Clock
from shared.contract import BadInput, Loads, OutOfOrder, SolverFailed, exchange_fields
from shared.participant import Participant
from shared.run.checkpoint import write_state
from shared.service import Service
from shared.wire import Message, decode, encode

CLOCK = Clock(1.0, 10)
LOAD = Loads(np.zeros(4), np.tile([0.0, -1.0], (4, 1)))


def started(model, **options):
    participant = Participant(model, "solid")
    participant.describe()
    participant.start(CLOCK, np.arange(4), **options)
    return participant


def test_each_verb_refuses_its_wrong_moment(toy_spring):
    participant = Participant(toy_spring(), "solid")
    with pytest.raises(OutOfOrder, match="start refused: describe must come first"):
        participant.start(CLOCK, np.arange(4))
    with pytest.raises(OutOfOrder, match="advance refused: describe and start"):
        participant.advance(CLOCK.window(0), LOAD)
    participant = started(toy_spring())
    with pytest.raises(OutOfOrder, match="accept refused"):
        participant.accept()
    with pytest.raises(OutOfOrder, match="window 0 is next, not window 1"):
        participant.advance(CLOCK.window(1), LOAD)
    participant.advance(CLOCK.window(0), LOAD)
    with pytest.raises(OutOfOrder, match="accept it or roll it back"):
        participant.advance(CLOCK.window(0), LOAD)
    with pytest.raises(OutOfOrder, match="did not ask for rollback"):
        participant.rollback()
    participant.accept()
    participant.finish()
    with pytest.raises(OutOfOrder, match="has finished"):
        participant.describe()


def test_repeated_window_gives_the_same_bytes(toy_spring):
    participant = started(toy_spring(), rollback=True)
    plain = started(toy_spring())
    for index in range(5):
        expected = plain.advance(CLOCK.window(index), LOAD)
        plain.accept()
        for iteration in range(3):
            found = participant.advance(CLOCK.window(index, iteration), LOAD)
            assert found.position.tobytes() == expected.position.tobytes()
            if iteration < 2:
                participant.rollback()
        participant.accept()


def test_published_motion_is_consistent(toy_spring):
    participant = started(toy_spring())
    before = toy_spring().reference
    for index in range(3):
        window = CLOCK.window(index)
        moved = participant.advance(window, LOAD)
        participant.accept()
        np.testing.assert_allclose(moved.position, before + window.length * moved.velocity_mean, atol=1e-15)
        before = moved.position


def test_checkpoint_goes_on_to_the_same_bytes(toy_spring, tmp_path):
    whole, first, second = (started(toy_spring()) for _ in range(3))
    for index in range(6):
        expected = whole.advance(CLOCK.window(index), LOAD)
        whole.accept()
    for index in range(3):
        first.advance(CLOCK.window(index), LOAD)
        first.accept()
    first.save(tmp_path / "state.h5")
    second.load(tmp_path / "state.h5")
    for index in range(3, 6):
        found = second.advance(CLOCK.window(index), LOAD)
        second.accept()
    assert found.position.tobytes() == expected.position.tobytes()


def test_loads_travel_to_the_selected_points_only(toy_spring):
    full, part = started(toy_spring()), Participant(toy_spring(), "solid")
    part.describe()
    part.start(CLOCK, np.array([1, 3]))
    some = Loads(np.zeros(2), np.array([[0.0, -1.5], [0.0, -2.5]]))
    moved = part.advance(CLOCK.window(0), some)
    assert moved.position.shape == (2, 2)
    np.testing.assert_allclose(moved.position, full.advance(CLOCK.window(0), LOAD).position[[1, 3]], rtol=1e-15)


def test_checkpoint_of_another_run_is_refused(toy_spring, tmp_path):
    participant = started(toy_spring())
    write_state(tmp_path / "state.h5", {"window": np.array(1)})
    with pytest.raises(BadInput, match="does not fit this run"):
        participant.load(tmp_path / "state.h5")


class Softening:
    """A spring whose stable step is half a window at first, and a quarter after window 0."""

    def __init__(self, spring):
        self._spring = spring

    def __getattr__(self, name):
        return getattr(self._spring, name)

    def stable_step(self):
        return 0.05 if self.y == 0.0 else 0.025


def test_sub_steps_are_those_of_the_state_at_the_windows_start(toy_spring, tmp_path):
    participant, again = started(Softening(toy_spring()), rollback=True), started(Softening(toy_spring()))
    participant.save(tmp_path / "first.h5")
    participant.advance(CLOCK.window(0), LOAD)
    participant.rollback()
    participant.advance(CLOCK.window(0), LOAD)
    participant.accept()
    assert participant.model.steps() == 2 + 2, "a window taken again is taken as it was"
    participant.advance(CLOCK.window(1), LOAD)
    assert participant.model.steps() == 2 + 2 + 4
    again.advance(CLOCK.window(0), LOAD)
    again.accept()
    again.load(tmp_path / "first.h5")
    again.advance(CLOCK.window(0), LOAD)
    assert again.model.steps() == 2 + 2, "a checkpoint's state has its own"


class Early:
    """A toy model that is asked in two parts, and counts."""

    def __init__(self, model):
        self._model, self.reach, self.settled = model, model.advance, 0

    def __getattr__(self, name):
        return getattr(self._model, name)

    def settle(self):
        self.settled += 1


def test_a_window_is_settled_once_it_is_accepted_and_before_anything_needs_it(toy_spring, tmp_path):
    model = Early(toy_spring())
    participant = started(model, rollback=True, frames=2, probe_rows=5)
    participant.advance(CLOCK.window(0), LOAD)
    participant.settle()
    assert model.settled == 0, "it may yet be rolled back"
    participant.rollback()
    participant.advance(CLOCK.window(0, 1), LOAD)
    participant.accept()
    assert model.settled == 0, "nothing is due"
    participant.settle()
    participant.settle()
    assert model.settled == 1
    participant.advance(CLOCK.window(1), LOAD)
    assert participant.accept() is not None
    assert model.settled == 2, "the row is of the settled state"
    participant.advance(CLOCK.window(2), LOAD)
    participant.accept()
    participant.save(tmp_path / "state.h5")
    assert model.settled == 3, "so is the checkpoint"
    participant.advance(CLOCK.window(3), LOAD)
    participant.rollback()
    participant.advance(CLOCK.window(3, 1), LOAD)
    assert model.settled == 3, "the window rolled back was not"


def test_what_fails_while_it_settles_is_the_next_reply(toy_spring):
    model = Early(toy_spring())
    service = Service(Participant(model, "solid"), "run")
    told = [
        Message(run="run", sender="coupler", verb="describe", sequence=0),
        Message(
            run="run",
            sender="coupler",
            verb="start",
            sequence=1,
            info={"end": 1.0, "windows": 10, "rollback": False, "frames": 1, "probe_rows": 1},
            fields={"selection": np.arange(4)},
        ),
    ]
    window = CLOCK.window(0)
    where = {"run": "run", "sender": "coupler", "verb": "advance", "fields": exchange_fields(LOAD)}
    told.append(Message(**where, sequence=2, window=0, t0=window.t0, t1=window.t1, info={"final": True}))
    for message in told:
        assert decode(service.handle(encode(message))).verb == message.verb
    model.settle = lambda: (_ for _ in ()).throw(SolverFailed("torn apart"))
    service.settle()
    window = CLOCK.window(1)
    reply = decode(service.handle(encode(Message(**where, sequence=3, window=1, t0=window.t0, t1=window.t1))))
    assert reply.verb == "error"
    assert reply.info == {"kind": "SolverFailed", "text": "torn apart", "exit_code": 3}
