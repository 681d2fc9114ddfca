"""Messages on the wire: one msgpack map per direction and window, arrays as raw little-endian bytes.

A message is the map

    {contract, run, sender, verb, window, iteration, sequence, t0, t1, info, fields}

    contract   int    version of the contract (contract.CONTRACT_VERSION)
    run        str    identity of the run; a stray message of another run is refused
    sender     str    "coupler", "fluid" or "solid"
    verb       str    a request's verb, repeated in its reply; "error" in a reply that refuses
    window     int    number of the window, from 0; -1 where no window is meant
    iteration  int    iteration within the window, from 0
    sequence   int    number of the request, from 0, one more each time; a reply repeats it
    t0, t1     float  ends of the window [s]
    info       map    small named values: strings, numbers, booleans, lists and maps of these
    fields     map    name → {dtype, shape, data}: dtype "<f8" or "<i8", shape a list of integers, data raw, C order

Requests and what they carry (fields; info), and their replies:

    describe   –                                   → position (n, 2), volume (n,), body (n,);
                                                     name, role, model, stable_step, spacing, numbers
    start      selection (k,) of own points, and for a fluid the five kinematics of its ghosts;
               end, windows, rollback, probe_rows, frames, resumed (optional: load comes next)
                                                   → own initial exchange on the selected points; probes
    advance    the partner's exchange on the selected points; final (optional: accept at once)
                                                   → own exchange on them; probes as of accept if final
    rollback   –                                   → –
    accept     –                                   → –; probes (name → value, when a row is due)
    save, load path (a file of the participant's machine) → –
    finish     –                                   → –; cost

What the info of a reply must hold:

    describe   name, role ("fluid" or "structure") and model: texts; stable_step [s], spacing [m]: above 0; numbers,
               above 0 each: of a fluid density [kg/m³], support (reach of its kernel) [m], and sound_speed [m/s] where
               it carries sound; of a structure density, thickness (of its thinnest body) [m], and wave_speed [m/s]
               where its model is total-lagrangian or ctvf
    probes     name → value of the scene's probes that are the side's own: a structure's those on its bodies but force-x
               and force-y, a fluid's all others; at the start, and of window k (from 0) accepted a row is due if
               (k + 1) p // w > k p // w, with p = probe_rows and w = windows of the start; it has the names of the
               start's, and comes then alone
    cost       core_s: processor time [s]; and whatever else is to stand in cost of result.json: steps, particles, …
    error      text: one paragraph, what is wrong and the way out; exit_code 2 (bad input), 3 (failed) or 4

save writes the whole state, and load takes it, so that a run can go on; a participant that cannot needs
output.checkpoint_every = 0. rollback comes only if the start says so.

Every reply may carry, in its info, spent: two times [s], what the participant worked after its last reply, and for this
one; by them the coupler tells work from waiting.

An exchange is either kinematics (position, velocity, acceleration, velocity_mean, acceleration_mean: each (k, 2)) or
loads (pressure (k,), force (k, 2)); units in contract.py. Any program that speaks these messages can be a participant:
`coupler run CASE --solid-command COMMAND` (or --fluid-command) starts

    COMMAND serve RUN_DIR/case.toml --connect ENDPOINT --run RUN --out RUN_DIR/solid.vtkhdf --threads N --parent PID

in a session of its own, its output in RUN_DIR/log/solid.txt. It connects to the zenoh endpoint, serves run RUN on the
keys of link_zenoh.py, may write frames to --out, ends after finish, and when process PID, which started it, has ended.
cases/participant/spring.py is a whole one.

Every reader checks everything before a message reaches a solver, and says what is wrong. No pickle anywhere.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgpack
import numpy as np

from shared.contract import CONTRACT_VERSION, ShearwaterError

SIZE_LIMIT = 256 * 2**20
"""Largest message accepted, in bytes."""

_NAMES = "surrogateescape"  # files may have names that are not UTF-8; their bytes travel as they are
_DTYPES = {"<f8": np.dtype("<f8"), "<i8": np.dtype("<i8")}
_PARTS = {"dtype", "shape", "data"}
_KEYS = {
    "contract": int,
    "run": str,
    "sender": str,
    "verb": str,
    "window": int,
    "iteration": int,
    "sequence": int,
    "t0": float,
    "t1": float,
    "info": dict,
    "fields": dict,
}
_parts_of = operator.attrgetter(*_KEYS)


class BadMessage(ShearwaterError):
    """A message was refused; the text names what is wrong with it."""


@dataclass(frozen=True)
class Message:
    """One message; see the module's text for the meaning of each part."""

    run: str
    sender: str
    verb: str
    sequence: int
    window: int = -1
    iteration: int = 0
    t0: float = 0.0
    t1: float = 0.0
    info: Mapping[str, Any] = field(default_factory=dict)
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    contract: int = CONTRACT_VERSION


def encode(message: Message) -> bytes:
    """The message as bytes."""
    packed = dict(zip(_KEYS, _parts_of(message), strict=True))
    packed["info"] = dict(message.info)
    packed["fields"] = {name: _pack_array(name, array) for name, array in message.fields.items()}
    return msgpack.packb(packed, unicode_errors=_NAMES)


def _pack_array(name: str, array: np.ndarray) -> dict[str, Any]:
    kind = {"f": "<f8", "i": "<i8"}.get(array.dtype.kind)
    if kind is None:
        raise BadMessage(f"field {name!r} has dtype {array.dtype}; only floats and integers travel")
    data = np.ascontiguousarray(array, dtype=_DTYPES[kind])
    return {"dtype": kind, "shape": data.shape, "data": data.data}


def decode(data: bytes) -> Message:
    """The message in `data`, with its form, arrays and numbers checked; raises BadMessage."""
    if len(data) > SIZE_LIMIT:
        raise BadMessage(f"message of {len(data)} bytes is larger than the limit of {SIZE_LIMIT} bytes")
    try:
        packed = msgpack.unpackb(data, unicode_errors=_NAMES)
    except Exception as error:  # msgpack raises many kinds for malformed input
        raise BadMessage(f"message is not valid msgpack: {str(error) or type(error).__name__}") from None
    if not isinstance(packed, dict):
        raise BadMessage(f"message is a {type(packed).__name__}, not a map")
    if packed.get("contract") != CONTRACT_VERSION:
        raise BadMessage(f"message speaks contract {packed.get('contract')!r}; this side speaks {CONTRACT_VERSION}")
    for name, kind in _KEYS.items():
        value = packed.get(name)
        if type(value) is not kind and not (kind is float and type(value) is int):
            raise BadMessage(f"message key {name!r} is {value!r}; a {kind.__name__} is needed")
    if len(packed) > len(_KEYS):
        raise BadMessage(f"message has unknown keys {sorted(map(str, packed.keys() - _KEYS.keys()))}")
    if not (math.isfinite(packed["t0"]) and math.isfinite(packed["t1"])):
        raise BadMessage(f"message times t0 = {packed['t0']}, t1 = {packed['t1']} are not finite")
    packed["fields"] = {name: _unpack_array(name, spec) for name, spec in packed["fields"].items()}
    return Message(**packed)


def _unpack_array(name: Any, spec: Any) -> np.ndarray:
    if not isinstance(name, str) or not isinstance(spec, dict) or spec.keys() != _PARTS:
        raise BadMessage(f"field {name!r} is not a map of dtype, shape and data")
    dtype = _DTYPES.get(spec["dtype"]) if isinstance(spec["dtype"], str) else None
    if dtype is None:
        raise BadMessage(f"field {name!r} has dtype {spec['dtype']!r}; allowed are {', '.join(_DTYPES)}")
    shape, data = spec["shape"], spec["data"]
    if not isinstance(shape, list) or not all(type(n) is int and n >= 0 for n in shape):
        raise BadMessage(f"field {name!r} has shape {shape!r}; a list of non-negative integers is needed")
    if not isinstance(data, bytes) or len(data) != math.prod(shape) * dtype.itemsize:
        size = len(data) if isinstance(data, bytes) else type(data).__name__
        raise BadMessage(f"field {name!r}: shape {shape} of {spec['dtype']} does not fit data of {size} bytes")
    flat = np.frombuffer(data, dtype)
    array = flat if len(shape) == 1 else flat.reshape(shape)
    if dtype.kind == "f" and not _surely_finite(flat):
        bad = int(np.count_nonzero(~np.isfinite(array)))
        if bad:
            raise BadMessage(f"field {name!r} has {bad} value(s) that are not finite")
    return array


def _surely_finite(flat: np.ndarray) -> bool:
    """Whether the sum of squares is finite: quick, and False for huge values too."""
    with np.errstate(over="ignore", invalid="ignore"):
        return math.isfinite(flat @ flat)


def check_envelope(message: Message, *, run: str, sender: str, sequence: int) -> None:
    """Refuse a message of another run, from another sender, or out of sequence."""
    _agree("run", message.run, run)
    _agree("sender", message.sender, sender)
    _agree("sequence", message.sequence, sequence)


def check_window(message: Message, *, verb: str, window: int, iteration: int) -> None:
    """Refuse a reply that answers another verb, window or iteration."""
    _agree("verb", message.verb, verb)
    _agree("window", message.window, window)
    _agree("iteration", message.iteration, iteration)


def check_fields(
    fields: Mapping[str, np.ndarray], shapes: Mapping[str, Sequence[int]], where: str, dtype: str = "<f8"
) -> None:
    """Refuse fields that are not exactly the named ones in the given shapes and `dtype`; `where` names the message."""
    if set(fields) != set(shapes):
        raise BadMessage(f"{where} carries fields {sorted(fields)}; needed are {sorted(shapes)}")
    for name, shape in shapes.items():
        array = fields[name]
        if array.shape != tuple(shape):
            raise BadMessage(f"field {name!r} of {where} has shape {array.shape}; needed is {tuple(shape)}")
        if array.dtype != _DTYPES[dtype]:
            raise BadMessage(f"field {name!r} of {where} has dtype {array.dtype}; needed is {dtype}")


def _agree(what: str, found: Any, needed: Any) -> None:
    if found != needed:
        raise BadMessage(f"message has {what} {found!r}; {needed!r} is needed")
