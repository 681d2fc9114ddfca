"""The zenoh link: the coupler listens as a peer on the loopback interface, participants connect as clients.

Key expressions, for run R and participant P (fluid, solid):

    shearwater/R/P/request     coupler → participant, one message of wire.py
    shearwater/R/P/reply       participant → coupler
    shearwater/R/P/heartbeat   participant → coupler, once a second: number of time steps done so far, as text
    shearwater/R/P/alive       liveliness token of the participant; shearwater/R/coupler/alive that of the coupler

At most one message is in flight per participant, so nothing is ever dropped for congestion, provided that replies are
published with congestion control BLOCK (zenoh's own choice, DROP, loses long ones without a word); the blocking time is
raised all the same, since zenoh closes a link, without an exception, when a reader stalls for longer.

Whether a participant lives is told by its process, its heartbeats and its steps. Zenoh's own lease would end a run
whose coupler or solver pauses for 10 s; with a lease of a day a connection ends when its socket does, at once.

Whoever waits for a message sleeps in zenoh's own channel, which wakes it at once: a callback's thread in between would
cost a fifth of the exchange. What else may end the wait puts a message of its own into that channel, within its own
session, told from others by its attachment; so does the clock, once a second, for Python answers no signal while zenoh
waits.
"""

from __future__ import annotations

import contextlib
import math
import os
import socket
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from typing import Any

import zenoh

from shared.awake import PAUSE_S, awake
from shared.contract import ParticipantLost, ShearwaterError
from shared.slices import SHORTEST, set_slice
from shared.streams import say

# One thread for all of zenoh's own work instead of one for each kind of it, through which every message is handed on: a
# third off a round trip of 100 kB (0.25 to 0.17 ms), and fewer threads beside those that compute. Read when the first
# session opens.
_ONE_THREAD = "(acc: (handover: app), net: (handover: app), rx: (handover: app), tx: (handover: app))"
os.environ["ZENOH_RUNTIME"] = _ONE_THREAD

CONNECT_TIMEOUT_S = 20.0
HEARTBEAT_PERIOD_S = 1.0
_LOOPBACK = "127.0.0.1"
_SILENT_AFTER_S = PAUSE_S + 2.0 * HEARTBEAT_PERIOD_S  # the supervisor, who knows more, is to speak first
_BROKEN_AFTER_S = 2.0  # a process that ends closes its connection first
_SAY_AFTER_S = 60.0  # who waits longer for a participant to connect is told what for
_FIRST_STEP_WITHIN_S = 900.0  # a first run compiles, on a busy machine for minutes
_POLL_S = 0.2
_HEED_SIGNALS_EVERY_S = 1.0
_CLOSE_WITHIN_S = 5.0
LEASE_S = 86400.0
_STALLED_READER_S = {"peer": PAUSE_S + 5.0, "client": LEASE_S}  # the coupler may pause for as long as it likes
_WAKE = b"wake"  # attachment of what wakes
_MOST_WAITING = 4  # messages in a channel: one request or reply, and one that wakes


def key(run: str, name: str, topic: str) -> str:
    """A key expression of the list above."""
    return f"shearwater/{run}/{name}/{topic}"


def _config(mode: str, where: str, endpoint: str, patience: float) -> zenoh.Config:
    """No scouting, no shared memory, one endpoint, to be reached within `patience` [s]; a pause does not end the
    connection."""
    config, queue = zenoh.Config(), "transport/link/tx/queue"
    settings = {
        "mode": f'"{mode}"',
        where: f'["{endpoint}"]',
        "scouting/multicast/enabled": "false",
        "scouting/gossip/enabled": "false",
        "scouting/delay": "0",
        "transport/shared_memory/enabled": "false",
        "transport/link/tx/lease": f"{1e3 * LEASE_S:.0f}",  # ms
        f"{queue}/congestion_control/block/wait_before_close": f"{1e6 * _STALLED_READER_S[mode]:.0f}",  # µs
        "connect/timeout_ms": f"{1e3 * patience:.0f}",
        "connect/exit_on_failure": "true",
    }
    for name, value in settings.items():
        config.insert_json5(name, value)
    return config


def free_endpoint() -> str:
    """A loopback endpoint whose port is free at this moment. Raises ParticipantLost where nobody could reach it."""
    with socket.socket(type=socket.SOCK_DGRAM) as way:
        try:
            way.connect((_LOOPBACK, 9))  # sends nothing: the system looks up the way
        except OSError as error:
            raise ParticipantLost(
                f"no participant can be reached at {_LOOPBACK} ({error}): bring the loopback interface up "
                "(ip link set lo up), or run with --link inprocess"
            ) from None
    with socket.socket() as probe:
        probe.bind((_LOOPBACK, 0))
        return f"tcp/{_LOOPBACK}:{probe.getsockname()[1]}"


@contextlib.contextmanager
def reaching(endpoint: str, patience: float) -> Iterator[zenoh.Session]:
    """A participant's session; raises ParticipantLost where no coupler answers at `endpoint` within `patience` [s]."""
    try:
        session = zenoh.open(_config("client", "connect/endpoints", endpoint, patience))
    except zenoh.ZError as error:
        raise ParticipantLost(
            f"cannot reach a coupler at {endpoint} within {patience:g} s: {error} "
            "(a refused password or certificate shows as this time-out too)"
        ) from None
    with _closing(session):
        yield session


@contextlib.contextmanager
def listening(run: str, endpoint: str | None = None) -> Iterator[tuple[zenoh.Session, str]]:
    """The coupler's session and its endpoint; without `endpoint` on a free port."""
    session, attempts = None, 1 if endpoint else 5
    set_slice(SHORTEST)
    while session is None:
        chosen = endpoint or free_endpoint()
        attempts -= 1
        try:
            session = zenoh.open(_config("peer", "listen/endpoints", chosen, CONNECT_TIMEOUT_S))
        except zenoh.ZError as error:
            if attempts == 0:
                raise ParticipantLost(f"cannot listen on {chosen}: {error}") from None
    with _closing(session), undeclaring(session.liveliness().declare_token(key(run, "coupler", "alive"))):
        yield session, chosen


@contextlib.contextmanager
def undeclaring(entity: Any) -> Iterator[Any]:
    """What a session has declared, up to the end."""
    try:
        yield entity
    finally:
        entity.undeclare()


@contextlib.contextmanager
def _closing(session: zenoh.Session) -> Iterator[None]:
    """Close the session at the end, as soon as no other thread is sending a wake-up through it."""
    try:
        yield
    finally:
        deadline = time.monotonic() + _CLOSE_WITHIN_S
        while True:
            try:
                session.close()
                break
            except RuntimeError:  # "Already borrowed"
                if time.monotonic() > deadline:
                    raise
                time.sleep(1e-3)


class ZenohLink:
    """The coupler's end of the link to participant `name`.

    `alive()` raises ParticipantLost when the participant's process is known to be gone (the supervisor knows).
    `stall_after` [s]: longest time without a new time step while a request is being worked on, once there has been
    a first one.
    """

    def __init__(self, session: zenoh.Session, run: str, name: str, alive: Callable[[], None], stall_after: float):
        self.name = name
        self._alive = alive
        self._stall_after = stall_after
        self._connected = threading.Event()
        self._token = key(run, name, "alive")
        self._heard: float | None = None  # when the first heartbeat came
        self._broken: float | None = None  # when its connection ended
        self._beat = (awake(), b"")  # arrival of the last heartbeat, and what it said
        self._progress = awake()  # when that last changed
        self._waiting = False
        self._woken = awake()  # when the reader was last woken, or began to wait
        self._lost: ShearwaterError | None = None
        self._replies, self._wake = channel(session, key(run, name, "reply"))
        self._entities = [
            session.declare_subscriber(key(run, name, "heartbeat"), self._on_heartbeat),
            session.liveliness().declare_subscriber(self._token, self._on_liveliness, history=True),
        ]
        self._publisher = session.declare_publisher(
            key(run, name, "request"), congestion_control=zenoh.CongestionControl.BLOCK, express=True
        )
        threading.Thread(target=_watch, args=(weakref.ref(self),), daemon=True).start()

    def _on_heartbeat(self, sample: zenoh.Sample) -> None:
        now, said = awake(), sample.payload.to_bytes()
        self._heard = now if self._heard is None else self._heard
        if said != self._beat[1]:
            self._progress = now
        self._beat = (now, said)

    def _on_liveliness(self, sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.DELETE:
            self._broken = awake()
        else:
            self._connected.set()

    def wait_connected(self, timeout: float) -> None:
        """Wait until the participant has connected; raises ParticipantLost after `timeout` [s]."""
        deadline, say_at = awake() + timeout, awake() + _SAY_AFTER_S
        while not self._connected.wait(_POLL_S):
            self._alive()
            if awake() > say_at:
                say(
                    f"waiting for the {self.name} participant, for {timeout:g} s at most: its process runs, and has "
                    f"not yet declared its liveliness token {self._token}"
                )
                say_at = math.inf
            if self._heard is not None and awake() - self._heard > _SILENT_AFTER_S:
                raise ParticipantLost(
                    f"the {self.name} participant sends heartbeats, and has declared no liveliness token {self._token}"
                )
            if awake() > deadline:
                raise ParticipantLost(
                    f"the {self.name} participant did not connect within {timeout:g} s: its process runs, and has "
                    f"declared no liveliness token {self._token}"
                )

    def send(self, request: bytes) -> None:
        """Send a request."""
        self._progress = awake()
        self._beat = (self._progress, self._beat[1])
        self._woken = self._progress
        self._publisher.put(request)

    def receive(self) -> bytes:
        """Wait for the reply; raises ParticipantLost when the participant died, went silent or stalled."""
        self._waiting = True
        while (reply := next_message(self._replies)) is None:
            if self._lost is not None:
                raise self._lost
        self._waiting = False
        return reply

    def watch(self) -> None:
        """End the wait for a reply that will not come; let one who waits for long heed signals."""
        now = awake()
        if not self._waiting or self._lost is not None:
            return
        try:
            self._check()
        except ShearwaterError as error:
            self._lost = error
        if self._lost is not None or now - self._woken > _HEED_SIGNALS_EVERY_S:
            self._woken = now
            self._wake()

    def _check(self) -> None:
        self._alive()
        now = awake()
        if self._broken is not None and now - self._broken > _BROKEN_AFTER_S:
            raise ParticipantLost(f"the connection to the {self.name} participant has ended; its process has not")
        if now - self._beat[0] > _SILENT_AFTER_S:
            raise ParticipantLost(
                f"the {self.name} participant has sent no heartbeat for {now - self._beat[0]:.0f} s: "
                "it is stopped, or its machine is out of reach"
            )
        stepping = self._beat[1] not in (b"", b"0")
        if now - self._progress > (self._stall_after if stepping else _FIRST_STEP_WITHIN_S):
            raise ParticipantLost(
                f"the {self.name} participant is alive but has neither answered nor made a time step for "
                f"{now - self._progress:.0f} s (coupling.stall_after = {self._stall_after:g} s)"
            )


def _watch(link: weakref.ref[ZenohLink]) -> None:
    """Watch over a link as long as somebody holds it."""
    while (held := link()) is not None:
        held.watch()
        del held
        time.sleep(_POLL_S)


def channel(session: zenoh.Session, where: str) -> tuple[zenoh.Subscriber, Callable[[], None]]:
    """What arrives on the key `where`, to be received in order by `next_message`, and what wakes its reader. Of
    more than waits in a sound run the oldest go: a full channel would hold up all of zenoh, and nobody could end the
    run."""
    channel = session.declare_subscriber(where, zenoh.handlers.RingChannel(_MOST_WAITING))

    def wake() -> None:
        with contextlib.suppress(zenoh.ZError):  # a session that is closed has no reader
            session.put(where, b"", attachment=_WAKE, allowed_destination=zenoh.Locality.SESSION_LOCAL)

    return channel, wake


def next_message(channel: zenoh.Subscriber) -> bytes | None:
    """The next message, or None when woken."""
    sample = channel.recv()
    woken = sample.attachment is not None and sample.attachment.to_bytes() == _WAKE
    return None if woken else sample.payload.to_bytes()
