"""Going back to a window's start, bit for bit, in every model of both sides."""

from __future__ import annotations

import numpy as np
import pytest

from fluid_solver.models import MODELS as FLUIDS
from fluid_solver.models import make_model as make_fluid
from shared.clock import Clock
from shared.contract import Kinematics, Loads, OutOfOrder, exchange_fields
from shared.participant import Participant
from shared.scene.reading import load_scene
from solid_solver.models import MODELS as SOLIDS
from solid_solver.models import make_model as make_solid
from tests.scenes import tiny_coupled

CLOCK = Clock(6e-3, 12)
WINDOWS = 6
SETS = {
    "spring": ["solid.spring.stiffness=[1e5,1e5,1e3]"],
    "acoustic": [],
    "incompressible": ["fluid.column.compressible=false"],
}


def scene_of(side: str, model: str, folder):
    kind, _, variant = model.partition(" ")
    sets = [f"{side}.model={kind}", *SETS.get(variant or kind, [])]
    if kind in ("rigid", "spring"):
        sets += ["solid.clamps=[]"]
    return load_scene(tiny_coupled(folder), sets)


def motion(places: np.ndarray, window, wild: float) -> Kinematics:
    """The plate swings and turns; `wild` bends the way there, as a bad iterate would."""

    def at(t):
        lift = 1e-4 * np.sin(700.0 * t) * (1.0 + wild) * (1.0 + 3.0 * places[:, :1])
        rate = 7e-2 * np.cos(700.0 * t) * (1.0 + 2.0 * wild) * (1.0 + 3.0 * places[:, :1])
        return places + lift * [0.1, 1.0], rate * [0.1, 1.0]

    (x0, v0), (x1, v1) = at(window.t0), at(window.t1)
    return Kinematics(x1, v1, np.zeros_like(x1), (x1 - x0) / window.length, (v1 - v0) / window.length)


def loads(places: np.ndarray, window, wild: float) -> Loads:
    """A push that wanders along the plate."""
    push = -30.0 / len(places) * (1.0 + wild) * (1.0 + np.sin(900.0 * window.t1 + 20.0 * places[:, 0]))
    return Loads(-push, np.stack([0.2 * push, push], axis=1))


def started(side: str, model: str, folder):
    make, give = (make_fluid, motion) if side == "fluid" else (make_solid, loads)
    participant = Participant(make(scene_of(side, model, folder), True, 1), side)
    places = participant.describe().position
    still = Kinematics.at_rest(places) if side == "fluid" else None
    participant.start(CLOCK, np.arange(len(places)), still, rollback=True)
    return participant, lambda window, wild=0.0: give(places, window, wild)


def bytes_of(exchange) -> list[bytes]:
    return [array.tobytes() for array in exchange_fields(exchange).values()]


FLUID_MODELS = [("fluid", name) for name in FLUIDS if name != "column"]
COLUMNS = [("fluid", "column acoustic"), ("fluid", "column incompressible")]
EVERY_MODEL = [*FLUID_MODELS, *COLUMNS, *(("solid", name) for name in SOLIDS)]


@pytest.mark.parametrize(("side", "model"), EVERY_MODEL)
def test_iterated_windows_are_explicit_windows(side, model, tmp_path):
    """Iterations 0 and 1 under other data, 2, 3 and 4 under the same: the same bytes, and those of one advance only."""
    plain, given = started(side, model, tmp_path)
    again, _ = started(side, model, tmp_path)
    for index in range(WINDOWS):
        window = CLOCK.window(index)
        expected = plain.advance(window, given(window), final=True)
        plain.accept()
        for iteration, wild in enumerate((0.5, -0.3, 0.0, 0.0, 0.0)):
            found = again.advance(window.again(iteration), given(window, wild))
            if wild == 0.0:
                assert bytes_of(found) == bytes_of(expected), f"window {index}, iteration {iteration}"
            if iteration < 4:
                again.rollback()
        again.accept()
    for name, array in plain.model.state().items():
        assert np.array_equal(array, again.model.state()[name]), name


@pytest.mark.parametrize(("side", "model"), EVERY_MODEL)
def test_the_state_is_whole(side, model, tmp_path):
    """Another model of the same scene that takes over the state goes on with the same bytes."""
    first, given = started(side, model, tmp_path)
    for index in range(3):
        first.advance(CLOCK.window(index), given(CLOCK.window(index)))
        first.accept()
    second, _ = started(side, model, tmp_path)
    first.save(tmp_path / "state.h5")
    second.load(tmp_path / "state.h5")
    for index in range(3, WINDOWS):
        results = [one.advance(CLOCK.window(index), given(CLOCK.window(index))) for one in (first, second)]
        assert bytes_of(results[0]) == bytes_of(results[1])
        first.accept()
        second.accept()


def test_a_final_window_cannot_be_taken_back(tmp_path):
    participant, given = started("solid", "rigid", tmp_path)
    participant.advance(CLOCK.window(0), given(CLOCK.window(0)), final=True)
    with pytest.raises(OutOfOrder, match="advanced as final"):
        participant.rollback()
