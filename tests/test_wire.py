"""Every check of the wire refuses its bad message and names what is wrong."""

from __future__ import annotations

import os
import re

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from shared import wire
from shared.clock import Clock
from shared.participant import Participant
from shared.service import Service
from shared.wire import BadMessage, Message, decode, encode

GOOD = Message("run-1", "coupler", "advance", 7, 3, 1, 0.5, 0.75, {"a": 1}, {"force": np.arange(6.0).reshape(3, 2)})


def repacked(**changes):
    """A good message with parts of its map replaced; None takes a key out."""
    packed = msgpack.unpackb(encode(GOOD)) | changes
    return msgpack.packb({k: v for k, v in packed.items() if v is not None})


def field(**changes):
    """A good message whose only field is changed."""
    spec = msgpack.unpackb(encode(GOOD))["fields"]["force"] | changes
    return repacked(fields={"force": spec})


def test_round_trip_keeps_every_bit():
    back = decode(encode(GOOD))
    assert (back.verb, back.window, back.iteration, back.sequence, back.t0, back.t1) == ("advance", 3, 1, 7, 0.5, 0.75)
    assert back.fields["force"].tobytes() == GOOD.fields["force"].tobytes()


def test_a_files_name_travels_whatever_its_bytes():
    path = os.fsdecode(b"sz\xfc\xc3\xbc.h5")
    assert decode(encode(Message("r", "coupler", "save", 0, info={"path": path}))).info["path"] == path


@pytest.mark.parametrize("verb", ["save", "load"])
def test_a_path_is_needed(toy_spring, verb):
    refusal = decode(ready_service(toy_spring()).handle(encode(Message("r", "coupler", verb, 0))))
    assert refusal.info["text"] == f"{verb} carries path = None; text is needed"


@given(hnp.arrays(np.float64, hnp.array_shapes(max_dims=2, max_side=5), elements=st.floats(-1e300, 1e300)))
def test_any_finite_array_survives(array):
    back = decode(encode(Message("r", "fluid", "advance", 0, fields={"x": array}))).fields["x"]
    assert back.shape == array.shape
    assert back.tobytes() == array.tobytes()


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"\xc1\x00", "not valid msgpack"),
        (msgpack.packb([1, 2]), "not a map"),
        (repacked(contract=99), "contract 99"),
        (repacked(contract=None), "contract None"),
        (repacked(verb=3), "'verb' is 3"),
        (repacked(window="0"), "'window'"),
        (repacked(sequence=None), "'sequence' is None"),
        (repacked(t0=float("nan")), "not finite"),
        (repacked(extra=1), "unknown keys ['extra']"),
        (field(dtype="<f4"), "dtype '<f4'"),
        (field(dtype="|O"), "dtype '|O'"),
        (field(shape=[3, 3]), "does not fit data of 48 bytes"),
        (field(shape=[-3, -2]), "non-negative"),
        (field(data=b"123"), "does not fit data of 3 bytes"),
        (field(data=np.array([1, 2, 3, 4, 5, np.inf]).tobytes()), "1 value(s) that are not finite"),
        (repacked(fields={"force": 1}), "not a map of dtype"),
    ],
)
def test_malformed_message_is_refused(data, words):
    with pytest.raises(BadMessage, match=re.escape(words)):
        decode(data)


@pytest.mark.filterwarnings("error")
def test_huge_values_pass_and_what_is_not_finite_is_counted_without_numpys_warning():
    huge = np.array([1e300, -1e300])
    assert decode(encode(Message("r", "fluid", "advance", 0, fields={"x": huge}))).fields["x"].tolist() == [
        1e300,
        -1e300,
    ]
    with pytest.raises(BadMessage, match="2 value"):
        decode(field(data=np.array([np.inf, 2, 3, 1e300, 5, -np.inf]).tobytes()))


def test_oversized_message_is_refused(monkeypatch):
    monkeypatch.setattr(wire, "SIZE_LIMIT", 100)
    with pytest.raises(BadMessage, match="larger than the limit of 100 bytes"):
        decode(encode(GOOD))


@pytest.mark.parametrize(
    ("expected", "words"),
    [
        ({"run": "run-2"}, "run 'run-1'; 'run-2' is needed"),
        ({"sender": "fluid"}, "sender 'coupler'"),
        ({"sequence": 8}, "sequence 7; 8"),
    ],
)
def test_foreign_message_is_refused(expected, words):
    with pytest.raises(BadMessage, match=re.escape(words)):
        wire.check_envelope(GOOD, **({"run": "run-1", "sender": "coupler", "sequence": 7} | expected))


@pytest.mark.parametrize("expected", [{"verb": "accept"}, {"window": 4}, {"iteration": 0}])
def test_answer_to_another_question_is_refused(expected):
    with pytest.raises(BadMessage, match=next(iter(expected))):
        wire.check_window(GOOD, **({"verb": "advance", "window": 3, "iteration": 1} | expected))


@pytest.mark.parametrize(
    ("shapes", "words"),
    [
        ({"force": (4, 2)}, "shape (3, 2); needed is (4, 2)"),
        ({"pressure": (3,)}, "carries fields ['force']; needed are ['pressure']"),
    ],
)
def test_wrong_fields_are_refused(shapes, words):
    with pytest.raises(BadMessage, match=re.escape(words)):
        wire.check_fields(GOOD.fields, shapes, "advance")


def ready_service(model):
    """A service whose structure has been started on all points; and the next sequence number."""
    participant = Participant(model, "solid")
    participant.describe()
    participant.start(Clock(1.0, 4), np.arange(4))
    return Service(participant, "r")


LOADS = {"pressure": np.zeros(4), "force": np.zeros((4, 2))}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"run": "other"}, "run 'other'"),
        ({"sender": "fluid"}, "sender 'fluid'"),
        ({"sequence": 5}, "sequence 5"),
        ({"window": 2}, "window 0 is next"),
        ({"verb": "explode"}, "'explode' is not known"),
        ({"t1": 0.0}, "no length"),
        ({"fields": {"force": np.zeros((4, 2))}}, "needed are"),
        ({"fields": {**LOADS, "force": np.zeros((3, 2))}}, "shape (3, 2)"),
        ({"fields": {**LOADS, "force": np.zeros((4, 2), dtype=np.int64)}}, "dtype int64"),
    ],
)
def test_bad_request_never_reaches_the_model(toy_spring, changes, words):
    model = toy_spring()
    service = ready_service(model)
    good = {"run": "r", "sender": "coupler", "verb": "advance", "sequence": 0, "window": 0, "t1": 0.25, "fields": LOADS}
    refusal = decode(service.handle(encode(Message(**(good | changes)))))
    assert refusal.verb == "error"
    assert words in refusal.info["text"]
    assert model.done == 0
    assert decode(service.handle(encode(Message(**good)))).verb == "advance", "a good request is still served"
