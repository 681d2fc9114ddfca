"""What a participant answers is checked: one error that names it, the verb, the key, the value and what is needed."""

from __future__ import annotations

import re

import msgpack
import numpy as np
import pytest

from coupler.remote import Remote, RemoteError
from coupler.run import check_probes
from shared.clock import Clock
from shared.contract import Kinematics, Loads, ShearwaterError
from shared.link import InProcessLink
from shared.participant import Participant
from shared.scene.reading import load_scene
from shared.service import Service
from shared.wire import BadMessage


def altered(verb, change):
    """What a participant's service answers, its reply to `verb` changed: a dict goes into the info, a function takes
    the whole map of the message and returns it, or the bytes, to be sent."""

    def through(handle):
        def answer(request):
            reply = handle(request)
            message = msgpack.unpackb(reply)
            if message["verb"] != verb:
                return reply
            if not isinstance(change, dict):
                changed = change(message)
                return changed if isinstance(changed, bytes) else msgpack.packb(changed)
            info = message["info"] | change
            return msgpack.packb(message | {"info": {k: v for k, v in info.items() if v is not ...}})

        return answer

    return through


def whole_run(model, name, through):
    """All verbs, one window."""
    service = Service(Participant(model, name), "r")
    remote, clock = Remote(InProcessLink(through(service.handle)), "r", name), Clock(1.0, 1)
    count = len(remote.describe().position)
    motion = Kinematics.at_rest(model.reference) if name == "fluid" else None
    remote.start(clock, np.arange(count), motion, frames=1, probe_rows=1)
    remote.advance(clock.window(0), Loads.zero(count) if motion is None else motion)
    remote.begin_accept()
    remote.end_accept()
    return remote.finish()


def field(name, value):
    """The first number of a field replaced."""

    def change(message):
        spec = message["fields"][name]
        spec["data"] = np.float64(value).tobytes() + spec["data"][8:]
        return message

    return change


NUMBERS = {"density": 1.0, "thickness": 1.0}
BAD = [
    ("describe", {"numbers": ...}, "numbers is missing; a map from names to numbers is needed"),
    ("describe", {"numbers": {"density": 1.0}}, "numbers.thickness is missing; a number above 0 is needed"),
    ("describe", {"numbers": NUMBERS | {"density": 0}}, "numbers.density is 0; a number above 0"),
    ("describe", {"numbers": NUMBERS, "model": "ctvf"}, "numbers.wave_speed is missing"),
    ("describe", {"stable_step": -1.0}, "stable_step is -1.0; a number above 0"),
    ("describe", {"stable_step": "x"}, "stable_step is 'x'"),
    ("describe", {"spacing": True}, "spacing is True"),
    ("describe", {"role": "fluid"}, "role is 'fluid'; 'structure' is needed"),
    ("describe", {"model": ...}, "model is missing; text is needed"),
    ("describe", {"extra": 1}, "unknown keys ['extra']"),
    ("describe", field("position", 1e300), "'position' of describe from solid has values up to 1e+300; 1e+100 is most"),
    ("describe", lambda m: m | {"fields": {}}, "carries fields []"),
    ("start", {"probes": ...}, "probes is missing"),
    ("start", {"probes": 3}, "probes is 3; a map from names to numbers"),
    ("start", {"probes": {"x": "abc"}}, "probes.x is 'abc'; a number is needed"),
    ("start", {"spent": "x"}, "spent is 'x'; two times [s]"),
    ("advance", field("position", 1e300), "field 'position' of advance from solid has values up to 1e+300"),
    ("advance", lambda m: m | {"window": 1}, "message has window 1; 0 is needed"),
    ("advance", lambda m: m | {"sender": "fluid"}, "message has sender 'fluid'; 'solid' is needed"),
    ("advance", lambda m: b"\xc1", "message is not valid msgpack"),
    ("accept", {"probes": {"x": None}}, "probes.x is missing; a number is needed"),
    ("accept", {"probes": [1]}, "probes is [1]"),
    (
        "accept",
        {"probes": ...},
        "its probes are missing at the end of window 0, where ['y'] are needed",
    ),
    ("accept", {"probes": {"x": 1.0}}, "its probes are ['x'] at the end of window 0"),
    ("advance", {"probes": {"y": 1.0}}, "its probes are ['y'] at the end of window 0, where no row is due"),
    ("finish", {"cost": ...}, "cost is missing"),
    ("finish", {"cost": {}}, "cost.core_s is missing; a time [s] is needed"),
    ("finish", {"cost": {"core_s": 1.0, "particles": "many"}}, "cost.particles is 'many'"),
    ("finish", {"cost": {"core_s": 1.0, "lost": 2}}, "cost.lost_near is missing"),
]


@pytest.mark.parametrize(("verb", "change", "words"), BAD)
def test_a_malformed_reply_is_refused_by_name(toy_spring, verb, change, words):
    with pytest.raises(BadMessage, match=re.escape(words)) as error:
        whole_run(toy_spring(), "solid", altered(verb, change))
    assert f"{verb} from solid" in str(error.value)
    assert error.value.exit_code == 3


def test_probes_of_the_other_side_are_refused():
    scene = load_scene("piston")
    check_probes(scene, "solid", {"piston_x": 0.0})
    with pytest.raises(BadMessage, match=r"start from solid: its probes \['face_pressure'\] are none of its own"):
        check_probes(scene, "solid", {"piston_x": 0.0, "face_pressure": 1.0})


def test_a_participant_that_only_says_that_it_has_saved_is_refused(toy_spring, tmp_path):
    service, path = Service(Participant(toy_spring(), "solid"), "r"), tmp_path / "solid.h5"

    def forgetful(message):
        path.unlink()
        return message

    remote = Remote(InProcessLink(altered("save", forgetful)(service.handle)), "r", "solid")
    remote.describe()
    remote.start(Clock(1.0, 1), np.arange(4), frames=1, probe_rows=1)
    remote.begin_save(path)
    with pytest.raises(BadMessage, match="save from solid: it has answered, and there is no file"):
        remote.end_save()


def test_a_side_without_memory_was_refused_it_by_the_system(toy_spring):
    def too_large(*_):
        raise MemoryError

    spring = toy_spring()
    spring.advance = too_large
    with pytest.raises(RemoteError, match=r"solid: \[Errno 12\] Cannot allocate memory: a larger fluid.dx"):
        whole_run(spring, "solid", lambda handle: handle)


def test_a_fluid_says_the_speed_of_sound_or_none(toy_weight):
    numbers = {"density": 1.0, "support": 1.0}
    assert whole_run(toy_weight(), "fluid", altered("describe", {"numbers": numbers}))["steps"]
    with pytest.raises(BadMessage, match=r"numbers\.sound_speed is 0"):
        whole_run(toy_weight(), "fluid", altered("describe", {"numbers": numbers | {"sound_speed": 0}}))


@pytest.mark.parametrize(
    ("info", "words"),
    [
        ({"text": "out of paper", "exit_code": 2}, "out of paper"),
        ({"text": "out of paper", "exit_code": "abc"}, "exit_code of its error (out of paper) is 'abc'; 2, 3 or 4"),
        ({"exit_code": 3}, "text of its error is missing; what is wrong is needed"),
    ],
)
def test_an_error_says_what_is_wrong(toy_spring, info, words):
    with pytest.raises(ShearwaterError, match=re.escape(words)) as error:
        whole_run(toy_spring(), "solid", altered("advance", lambda m: m | {"verb": "error", "info": info}))
    assert isinstance(error.value, RemoteError) == (info.get("exit_code") == 2)
    assert error.value.exit_code == (2 if info.get("exit_code") == 2 else 3)
