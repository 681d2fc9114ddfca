"""A participant as a service: requests of wire.py in, replies out. Used by every link alike."""

from __future__ import annotations

import logging
import os
import traceback
from collections.abc import Callable

import numpy as np

from shared.clock import Clock, Window
from shared.contract import TAKES, Kinematics, ShearwaterError, exchange_fields, exchange_shapes
from shared.participant import Participant
from shared.unwritable import met_limit
from shared.wire import BadMessage, Message, check_envelope, check_fields, decode, encode

log = logging.getLogger("shearwater")


class Service:
    """Decodes and checks each request, calls the participant's verb, encodes the reply.

    An error becomes a reply with verb "error" and info {kind, text, exit_code}; the participant stays usable after a
    message that was refused, since nothing of it has reached the model. An error in `settle` is the next reply.
    """

    def __init__(self, participant: Participant, run: str):
        self.participant = participant
        self._run = run
        self._sequence = 0
        self._late: Exception | None = None  # what `settle` has raised
        self._settled = 0.0  # s, spent in it since the last reply

    def settle(self) -> None:
        """What the participant does once its reply is on its way."""
        before = self.participant.spent
        try:
            self.participant.settle()
        except Exception as error:
            self._late = error
        self._settled = self.participant.spent - before

    def handle(self, data: bytes) -> bytes:
        """The reply to one request."""
        sequence = self._sequence
        request: Message | None = None
        try:
            request = decode(data)
            check_envelope(request, run=self._run, sender="coupler", sequence=sequence)
            answer = _VERBS.get(request.verb)
            if answer is None:
                raise BadMessage(f"verb {request.verb!r} is not known; known are {', '.join(_VERBS)}")
            if self._late is not None:
                raise self._late
            before = self.participant.spent
            info, fields = answer(self.participant, request)
            info["spent"] = [self._settled, self.participant.spent - before]
            self._settled = 0.0
            reply = self._reply(request, request.verb, info, fields)
            self._sequence += 1
            return reply
        except ShearwaterError as error:
            log.error("%s", error)
            return self._refusal(request, type(error).__name__, str(error), error.exit_code)
        except Exception as error:
            log.error("%s", traceback.format_exc())
            kind = type(error).__name__
            what = met_limit(error) or f"internal error, {kind}: {error} (see this side's log)"
            return self._refusal(request, kind, f"{self.participant.name}: {what}", 3)

    def _reply(self, request: Message | None, verb: str, info: dict, fields: dict) -> bytes:
        where = {} if request is None else {k: getattr(request, k) for k in ("window", "iteration", "t0", "t1")}
        return encode(
            Message(
                run=self._run,
                sender=self.participant.name,
                verb=verb,
                sequence=self._sequence if request is None else request.sequence,
                info=info,
                fields=fields,
                **where,
            )
        )

    def _refusal(self, request: Message | None, kind: str, text: str, exit_code: int) -> bytes:
        return self._reply(request, "error", {"kind": kind, "text": text, "exit_code": exit_code}, {})


Answer = tuple[dict, dict[str, np.ndarray]]


def _describe(participant: Participant, request: Message) -> Answer:
    check_fields(request.fields, {}, request.verb)
    d = participant.describe()
    info = {
        "name": d.name,
        "role": d.role,
        "model": d.model,
        "stable_step": float(d.stable_step),
        "spacing": float(d.spacing),
        "numbers": {name: float(value) for name, value in d.numbers.items()},
    }
    return info, {"position": d.position, "volume": d.volume, "body": d.body.astype("<i8")}


def _start(participant: Participant, request: Message) -> Answer:
    fields = dict(request.fields)
    selection = fields.pop("selection", None)
    if selection is None or selection.ndim != 1 or selection.dtype.kind != "i":
        raise BadMessage("start carries no list of integers 'selection'")
    count = len(participant.model.describe().position)
    if len(selection) and not 0 <= selection.min() <= selection.max() < count:
        raise BadMessage(f"start selects points {selection.min()} to {selection.max()}; there are {count}")
    motion = None
    if participant.model.role == "fluid":
        if len(selection) != count:
            raise BadMessage(f"start selects {len(selection)} of the fluid's {count} ghosts; all of them travel")
        check_fields(fields, exchange_shapes(Kinematics, len(selection)), "start")
        motion = Kinematics(**fields)
    elif fields:
        raise BadMessage(f"start of a structure carries unknown fields {sorted(fields)}")
    info = request.info
    clock = Clock(_number(info, "end", float), _number(info, "windows", int))
    own, probes = participant.start(
        clock,
        selection,
        motion,
        rollback=_number(info, "rollback", bool),
        frames=_number(info, "frames", int),
        probe_rows=_number(info, "probe_rows", int),
        resumed=bool(info.get("resumed", False)),
    )
    return {"probes": probes}, exchange_fields(own)


def _advance(participant: Participant, request: Message) -> Answer:
    check_fields(request.fields, participant.expected_boundary(), request.verb)
    window = Window(request.window, request.t0, request.t1, request.iteration)
    if not window.t0 < window.t1:
        raise BadMessage(f"window {window.index} from t0 = {window.t0} to t1 = {window.t1} has no length")
    final = bool(request.info.get("final", False))
    own = exchange_fields(participant.advance(window, TAKES[participant.model.role](**request.fields), final))
    return (_row(participant.accept()) if final else {}), own


def _accept(participant: Participant, request: Message) -> Answer:
    check_fields(request.fields, {}, request.verb)
    return _row(participant.accept()), {}


def _row(probes: dict[str, float] | None) -> dict:
    return {} if probes is None else {"probes": probes}


def _plain(verb: str) -> Callable[[Participant, Message], Answer]:
    def answer(participant: Participant, request: Message) -> Answer:
        check_fields(request.fields, {}, request.verb)
        getattr(participant, verb)(*([_path(request)] if verb in ("save", "load") else []))
        return {}, {}

    return answer


def _path(request: Message) -> str:
    """The file that is meant, whatever names files have here."""
    path = request.info.get("path")
    if not isinstance(path, str):
        raise BadMessage(f"{request.verb} carries path = {path!r}; text is needed")
    return os.fsdecode(path.encode(errors="surrogateescape"))


def _finish(participant: Participant, request: Message) -> Answer:
    check_fields(request.fields, {}, request.verb)
    return {"cost": participant.finish()}, {}


def _number(info: dict, name: str, kind: type) -> float | int | bool:
    value = info.get(name)
    if not isinstance(value, kind) or (kind is not bool and isinstance(value, bool)):
        raise BadMessage(f"start carries {name} = {value!r}; a {kind.__name__} is needed")
    return value


_VERBS: dict[str, Callable[[Participant, Message], Answer]] = {
    "describe": _describe,
    "start": _start,
    "advance": _advance,
    "rollback": _plain("rollback"),
    "accept": _accept,
    "save": _plain("save"),
    "load": _plain("load"),
    "finish": _finish,
}
