"""A participant's end of the zenoh link (link_zenoh.py): requests in, replies and heartbeats out."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

import zenoh

from shared.contract import EarlyModel, Model, ParticipantLost
from shared.link_zenoh import (
    CONNECT_TIMEOUT_S,
    HEARTBEAT_PERIOD_S,
    LEASE_S,
    channel,
    key,
    next_message,
    reaching,
    undeclaring,
)
from shared.service import Service
from shared.slices import SHORTEST, set_slice


def serve(endpoint: str, run: str, name: str, service: Service, attended: bool = False) -> None:
    """Answer the coupler's requests until the participant has finished; raises ParticipantLost when the coupler is
    gone.

    `attended`: this process ends with the coupler, which may pause, also before it is reached, for as long as it likes.
    """
    participant = service.participant
    set_slice(SHORTEST)
    with reaching(endpoint, LEASE_S if attended else CONNECT_TIMEOUT_S) as session:
        if isinstance(participant.model, EarlyModel):
            set_slice(0.0)  # what it computes after a reply is in nobody's way; zenoh's own threads keep theirs
        replies = session.declare_publisher(
            key(run, name, "reply"), congestion_control=zenoh.CongestionControl.BLOCK, express=True
        )
        requests, wake = channel(session, key(run, name, "request"))
        with (
            undeclaring(requests),
            undeclaring(_told_of_the_end(session, run, wake)),
            undeclaring(session.liveliness().declare_token(key(run, name, "alive"))),
            _heartbeats(session, key(run, name, "heartbeat"), participant.model),
        ):
            while not participant.finished:
                request = next_message(requests)
                if request is None:
                    raise ParticipantLost("the coupler is gone; this participant ends")
                replies.put(service.handle(request))
                service.settle()


def _told_of_the_end(session: zenoh.Session, run: str, wake: Callable[[], None]) -> zenoh.Subscriber:
    """Wakes whoever waits for a request when the coupler is gone."""

    def on_coupler(sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.DELETE:
            wake()

    return session.liveliness().declare_subscriber(key(run, "coupler", "alive"), on_coupler, history=True)


@contextlib.contextmanager
def _heartbeats(session: zenoh.Session, where: str, model: Model) -> Iterator[None]:
    """Send the number of a model's steps once a period, by a thread of its own."""
    heart, stop = session.declare_publisher(where), threading.Event()

    def beat() -> None:
        while not stop.wait(HEARTBEAT_PERIOD_S):
            with contextlib.suppress(zenoh.ZError):
                heart.put(str(model.steps()))

    pulse = threading.Thread(target=beat, daemon=True)
    pulse.start()
    try:
        yield
    finally:
        stop.set()
        pulse.join()
