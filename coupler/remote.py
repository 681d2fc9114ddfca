"""A participant as the coupler sees it: verbs in, messages out, replies checked."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coupler.replies import check_info
from shared.clock import Clock, Window
from shared.contract import (
    GIVES,
    Description,
    Exchange,
    Kinematics,
    ShearwaterError,
    SolverFailed,
    exchange_fields,
    exchange_shapes,
)
from shared.link import InProcessLink, Link
from shared.wire import BadMessage, Message, check_envelope, check_fields, check_window, decode, encode

_LARGEST = 1e100
"""Size of the values of a field, which no length, speed or force of a sound run reaches."""


class RemoteError(ShearwaterError):
    """A participant refused or failed; carries its own text and exit code."""

    def __init__(self, text: str, exit_code: int):
        super().__init__(text)
        self.exit_code = exit_code


class Remote:
    """Participant `name` behind a link.

    A verb that two participants may work on at once is split into `begin_…` and `end_…`.
    """

    def __init__(self, link: Link, run: str, name: str):
        self.name = name
        self.apart = not isinstance(link, InProcessLink)  # whether the participant's processor time is its own
        self._link = link
        self._run = run
        self._sequence = 0
        self._pending: Message | None = None
        self._answered = 0.0  # when the last reply came, on this process's clock [s]
        self.worked: list[tuple[float, float]] = []  # from when to when the participant worked; the coupler empties it
        self._count = 0  # interface points that travel
        self.row: dict[str, float] | None = None  # probes of the window accepted last, when a row was due

    def describe(self) -> Description:
        """What the participant is."""
        reply = self._ask("describe")
        count = (*np.shape(reply.fields.get("position", ())), 0)[0]
        bodies = reply.fields.get("body")
        floats = {name: array for name, array in reply.fields.items() if name != "body"}
        check_fields(floats, {"position": (count, 2), "volume": (count,)}, f"describe from {self.name}")
        check_fields({"body": bodies}, {"body": (count,)}, f"describe from {self.name}", "<i8")
        _check_sizes(floats, f"describe from {self.name}")
        self.description = Description(**reply.info, **reply.fields)
        return self.description

    def start(
        self,
        clock: Clock,
        selection: np.ndarray,
        motion: Kinematics | None = None,
        *,
        rollback: bool = False,
        frames: int,
        probe_rows: int,
        resumed: bool = False,
    ) -> tuple[Exchange, dict[str, float]]:
        """Begin at t = 0; see `Participant.start`."""
        self._count = len(selection)
        fields = {"selection": np.asarray(selection, dtype="<i8")}
        if motion is not None:
            fields |= exchange_fields(motion)
        info = {
            "end": clock.end,
            "windows": clock.count,
            "rollback": rollback,
            "frames": frames,
            "probe_rows": probe_rows,
            "resumed": resumed,
        }
        reply = self._ask("start", info=info, fields=fields)
        self._clock, self._probe_rows, self._probes = clock, probe_rows, sorted(reply.info["probes"])
        return self._exchange(reply), dict(reply.info["probes"])

    def begin_advance(self, window: Window, boundary: Exchange, final: bool = False) -> None:
        """Send the partner's data; the participant begins to integrate, and accepts at once if `final`."""
        self._window = window.index
        self._send("advance", window=window, fields=exchange_fields(boundary), info={"final": True} if final else None)

    def end_advance(self) -> Exchange:
        """Wait for the participant's own data at the window's end."""
        accepted = "final" in self._pending.info
        reply = self._receive()
        self._take_row(reply, accepted)
        return self._exchange(reply)

    def advance(self, window: Window, boundary: Exchange, final: bool = False) -> Exchange:
        """Integrate over the window under the partner's data; returns the participant's own."""
        self.begin_advance(window, boundary, final)
        return self.end_advance()

    def begin_rollback(self) -> None:
        """The participant begins to go back to the window's start, bit for bit."""
        self._send("rollback")

    def end_rollback(self) -> None:
        """Wait until it is back."""
        self._receive()

    def begin_accept(self) -> None:
        """Make the window final; the participant begins to write what is due."""
        self._send("accept")

    def end_accept(self) -> None:
        """Wait for the acceptance."""
        self._take_row(self._receive())

    def begin_save(self, path: Path) -> None:
        """The participant begins to write its complete state to the file `path`."""
        self._send("save", info={"path": str(path)})

    def end_save(self) -> None:
        """Wait until it is written."""
        path = self._pending.info["path"]
        self._receive()
        if not Path(path).is_file():
            without = "one that cannot save needs output.checkpoint_every = 0"
            raise BadMessage(f"save from {self.name}: it has answered, and there is no file {path}; {without}")

    def load(self, path: Path) -> None:
        """The participant takes its state from the file `path`."""
        self._ask("load", info={"path": str(path)})

    def finish(self) -> dict[str, Any]:
        """Close the participant's files; what it cost."""
        return self._ask("finish").info["cost"]

    def _ask(self, verb: str, info: Mapping[str, Any] | None = None, fields: Mapping | None = None) -> Message:
        self._send(verb, info=info, fields=fields)
        return self._receive()

    def _send(self, verb: str, window: Window | None = None, info=None, fields=None) -> None:
        where = {}
        if window is not None:
            where = {"window": window.index, "iteration": window.iteration, "t0": window.t0, "t1": window.t1}
        self._pending = Message(
            run=self._run,
            sender="coupler",
            verb=verb,
            sequence=self._sequence,
            info=info or {},
            fields=fields or {},
            **where,
        )
        self._link.send(encode(self._pending))

    def _receive(self) -> Message:
        asked = self._pending
        data = self._link.receive()
        try:
            reply = decode(data)
            check_envelope(reply, run=self._run, sender=self.name, sequence=self._sequence)
            if reply.verb != "error":
                check_window(reply, verb=asked.verb, window=asked.window, iteration=asked.iteration)
            times = _times(reply.info)
            check_info(self.name, reply.verb, reply.info)
        except BadMessage as error:
            raise BadMessage(f"{asked.verb} from {self.name}: {error}") from None
        if reply.verb == "error":
            raise RemoteError(reply.info["text"], reply.info.get("exit_code", SolverFailed.exit_code))
        self._sequence += 1
        self._note_work(*times)
        return reply

    def _note_work(self, settled: float, spent: float) -> None:
        """The participant worked for `settled` [s] from its last reply on, and for `spent` up to this one."""
        now = time.perf_counter()
        self.worked += [(self._answered, self._answered + settled), (now - spent, now)]
        self._answered = now

    def _take_row(self, reply: Message, accepted: bool = True) -> None:
        """The window's probes, those of the start: there if it is accepted and a row is due, and only then."""
        self.row = reply.info.get("probes")
        found = None if self.row is None else sorted(self.row)
        needed = self._probes if accepted and self._clock.crosses(self._window, self._probe_rows) else None
        if found != needed:
            how = "no row is due" if needed is None else f"{needed} are needed, as at the start"
            raise BadMessage(
                f"{reply.verb} from {self.name}: its probes are {found or 'missing'} at the end of window "
                f"{self._window}, where {how}"
            )

    def _exchange(self, reply: Message) -> Exchange:
        kind, where = GIVES[self.description.role], f"{reply.verb} from {self.name}"
        check_fields(reply.fields, exchange_shapes(kind, self._count), where)
        _check_sizes(reply.fields, where)
        return kind(**reply.fields)


def _check_sizes(fields: Mapping[str, np.ndarray], where: str) -> None:
    """Refuse values whose products would overflow."""
    for name, array in fields.items():
        flat = array.ravel()
        with np.errstate(over="ignore"):
            within = flat @ flat < _LARGEST**2
        if not within:
            raise BadMessage(
                f"field {name!r} of {where} has values up to {np.abs(flat).max():.3g}; {_LARGEST:g} is most"
            )


def _times(info: dict[str, Any]) -> tuple[float, float]:
    """Times [s] that the participant worked after its last reply and for this one; see wire.py."""
    spent = info.pop("spent", (0.0, 0.0))
    try:
        settled, worked = map(float, spent)
    except (TypeError, ValueError):
        raise BadMessage(f"spent is {spent!r}; two times [s] are needed") from None
    return settled, worked


class Working:
    """Time [s] in which at least one side works, on the coupler's clock."""

    def __init__(self, seconds: float, *sides: Remote):
        self.seconds = seconds
        self._sides, self._until = sides, time.perf_counter()

    def note(self) -> None:
        """Count what the sides have told since the last time."""
        for begin, end in sorted(span for side in self._sides for span in side.worked):
            self.seconds += max(0.0, end - max(begin, self._until))
            self._until = max(self._until, end)
        for side in self._sides:
            side.worked.clear()
