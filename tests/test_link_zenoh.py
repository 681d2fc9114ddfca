"""The zenoh link in one process: round trips, lost and silent participants."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from coupler.remote import Remote
from shared import link_serve, link_zenoh
from shared.clock import Clock
from shared.contract import Loads, ParticipantLost
from shared.link_serve import serve
from shared.link_zenoh import ZenohLink, free_endpoint, key, listening
from shared.participant import Participant
from shared.service import Service
from shared.wire import BadMessage


def alive():
    """A process that is never seen to die."""


def serving(endpoint, participant, failures, attended=False):
    try:
        serve(endpoint, "run", "solid", Service(participant, "run"), attended)
    except ParticipantLost as error:
        failures.append(str(error))


@pytest.mark.timeout(60)
def test_a_whole_run_over_zenoh(toy_spring):
    with listening("run") as (session, endpoint):
        participant, failures = Participant(toy_spring(), "solid"), []
        thread = threading.Thread(target=serving, args=(endpoint, participant, failures))
        thread.start()
        link = ZenohLink(session, "run", "solid", alive, stall_after=20.0)
        link.wait_connected(10.0)
        remote, clock = Remote(link, "run", "solid"), Clock(1.0, 20)
        remote.describe()
        remote.start(clock, np.arange(4), frames=1, probe_rows=1)
        for window in map(clock.window, range(20)):
            moved = remote.advance(window, Loads(np.zeros(4), np.tile([0.0, -1.0], (4, 1))))
            remote.begin_accept()
            remote.end_accept()
        assert remote.finish()["steps"] == 20
        thread.join(10.0)
    assert moved.position[0, 1] == participant.model.y
    assert not thread.is_alive()
    assert not failures


@pytest.mark.timeout(60)
def test_participant_ends_when_the_coupler_goes(toy_spring):
    failures = []
    with listening("run") as (session, endpoint):
        thread = threading.Thread(target=serving, args=(endpoint, Participant(toy_spring(), "solid"), failures))
        thread.start()
        ZenohLink(session, "run", "solid", alive, stall_after=20.0).wait_connected(10.0)
    thread.join(20.0)
    assert not thread.is_alive()
    assert "coupler is gone" in failures[0]


@pytest.mark.timeout(60)
@pytest.mark.parametrize("attended", [True, False])
def test_a_coupler_that_pauses_before_it_is_reached_is_waited_for(toy_spring, monkeypatch, attended):
    monkeypatch.setattr(link_serve, "CONNECT_TIMEOUT_S", 0.3)
    failures, endpoint = [], free_endpoint()
    participant = Participant(toy_spring(), "solid")
    thread = threading.Thread(target=serving, args=(endpoint, participant, failures, attended))
    thread.start()
    time.sleep(0.6)
    if attended:
        with listening("run", endpoint) as (session, _):
            ZenohLink(session, "run", "solid", alive, stall_after=20.0).wait_connected(10.0)
    thread.join(20.0)
    assert ("coupler is gone" if attended else "cannot reach a coupler") in failures[0]


@pytest.mark.timeout(60)
def test_a_participant_without_its_token_is_not_waited_for(monkeypatch):
    """It was for a quarter of an hour, as if it compiled."""
    monkeypatch.setattr(link_zenoh, "_SILENT_AFTER_S", 0.1)
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "solid", alive, stall_after=20.0)
        session.put("shearwater/run/solid/heartbeat", "0")
        with pytest.raises(ParticipantLost, match="no liveliness token shearwater/run/solid/alive"):
            link.wait_connected(10.0)


def test_a_loopback_interface_that_is_down_is_named(monkeypatch):
    """Both sides were waited for in vain, for a quarter of an hour."""
    monkeypatch.setattr(link_zenoh, "_LOOPBACK", "255.255.255.255")  # refused at once, too
    with pytest.raises(ParticipantLost, match=r"255.*Errno .*bring the loopback interface up"), listening("run"):
        pass


@pytest.mark.timeout(60)
def test_missing_participant_is_named(monkeypatch, capsys):
    """Also while it is waited for, a quarter of an hour: once, for a process that compiles says nothing either."""
    monkeypatch.setattr(link_zenoh, "_SAY_AFTER_S", 0.1)
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "solid", alive, stall_after=20.0)
        with pytest.raises(
            ParticipantLost, match=r"did not connect within .* no liveliness token shearwater/run/solid"
        ):
            link.wait_connected(0.9)
    said = capsys.readouterr().err
    assert said.startswith("waiting for the solid participant, for 0.9 s at most")
    assert said.count("\n") == 1


@pytest.mark.timeout(60)
def test_silent_participant_is_named(monkeypatch):
    monkeypatch.setattr(link_zenoh, "_SILENT_AFTER_S", 0.5)
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "fluid", alive, stall_after=20.0)
        link.send(b"question")
        with pytest.raises(ParticipantLost, match="sent no heartbeat"):
            link.receive()


@pytest.mark.timeout(60)
@pytest.mark.parametrize("beats", ["41", b"\xff\xfe"])
def test_stalled_participant_is_named(beats, capfd):
    """Heartbeats arrive, the number of steps in them, or whatever it is, stands still."""
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "fluid", alive, stall_after=1.0)
        stop = threading.Event()

        def beat():
            while not stop.wait(0.1):
                session.put("shearwater/run/fluid/heartbeat", beats)

        heart = threading.Thread(target=beat)
        heart.start()
        try:
            time.sleep(0.3)
            link.send(b"question")
            with pytest.raises(ParticipantLost, match="neither answered nor made a time step for"):
                link.receive()
        finally:
            stop.set()
            heart.join()
    assert capfd.readouterr().err == ""


@pytest.mark.timeout(60)
def test_first_step_may_compile_for_longer_than_a_stall():
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "fluid", alive, stall_after=0.3)
        session.put("shearwater/run/fluid/heartbeat", "0")
        link.send(b"question")
        answer = threading.Timer(1.0, session.put, ("shearwater/run/fluid/reply", b"answer"))
        answer.start()
        assert link.receive() == b"answer"
        answer.join()


def test_no_coupler_at_the_endpoint(monkeypatch, toy_spring):
    monkeypatch.setattr(link_serve, "CONNECT_TIMEOUT_S", 0.5)
    failures = []
    serving(link_zenoh.free_endpoint(), Participant(toy_spring(), "solid"), failures)
    assert "cannot reach a coupler" in failures[0]


@pytest.mark.timeout(60)
def test_an_empty_reply_is_a_reply():
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "solid", alive, stall_after=20.0)
        link.send(b"question")
        session.put("shearwater/run/solid/reply", b"")
        assert link.receive() == b""
        session.put("shearwater/run/solid/reply", b"")
        with pytest.raises(BadMessage, match="describe from solid: message is not valid msgpack"):
            Remote(link, "run", "solid").describe()


def test_a_participant_that_answers_many_times_holds_up_nobody():
    """What waits unread in a full channel stopped zenoh's only thread: the run neither went on nor ended."""
    with listening("run") as (session, _):
        link = ZenohLink(session, "run", "solid", alive, stall_after=20.0)
        where = key("run", "solid", "reply")
        talking = threading.Thread(target=lambda: [session.put(where, b"%d" % k) for k in range(50)], daemon=True)
        talking.start()
        talking.join(5.0)
        assert not talking.is_alive()
        assert link.receive() == b"46"  # the last four are kept
