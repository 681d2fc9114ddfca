"""Links carry one request at a time from the coupler to a participant and its reply back, as bytes.

A link offers `send(request)` and `receive() -> reply`; between the two the participant works, so that a caller may
send to several links before it receives. `InProcessLink` runs the participant in the caller's process and passes the
same bytes as the zenoh link (link_zenoh.py): a run gives the same result over both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol


class Link(Protocol):
    """One participant as the coupler sees it."""

    def send(self, request: bytes) -> None: ...

    def receive(self) -> bytes:
        """The reply to the last request; raises ParticipantLost when none will come."""


class InProcessLink:
    """A participant in the same process: `handle` turns a request into a reply."""

    def __init__(self, handle: Callable[[bytes], bytes]):
        self._handle = handle
        self._request: bytes | None = None

    def send(self, request: bytes) -> None:
        """Keep the request; the work is done in `receive`."""
        self._request = request

    def receive(self) -> bytes:
        """Handle the request that was sent."""
        request, self._request = self._request, None
        assert request is not None, "receive without send"
        return self._handle(request)
