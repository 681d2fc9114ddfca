"""Two participants over zenoh at once: parallel schemes overlap them, and whoever waits costs no processor time."""

from __future__ import annotations

import contextlib
import threading
import time

import pytest

from coupler.choice import make_taker
from coupler.mapping import build_mapping
from coupler.prediction import Predictor
from coupler.remote import Remote, Working
from coupler.schemes import Coupled
from coupler.window import Plan
from shared.clock import Clock
from shared.link_serve import serve
from shared.link_zenoh import ZenohLink, listening
from shared.participant import Participant
from shared.schema.coupling import Coupling
from shared.service import Service

WINDOWS = 3
WORK = {"fluid": 0.2, "solid": 0.3}
"""What a window takes each side [s]."""
SETTLING = 0.15


@contextlib.contextmanager
def working_sides(models):
    """Remotes of both models, each served in a thread of its own and asleep for its share of every window."""
    threads = []
    with listening("run") as (session, endpoint):
        remotes = {}
        for name, model in models.items():
            advance = model.advance

            def slowly(*window, name=name, advance=advance):
                time.sleep(WORK[name])
                return advance(*window)

            model.advance = slowly
            participant = Participant(model, name)
            served = endpoint, "run", name, Service(participant, "run")
            threads.append(threading.Thread(target=serve, args=served))
            threads[-1].start()
            link = ZenohLink(session, "run", name, lambda: None, stall_after=20.0)
            link.wait_connected(10.0)
            remotes[name] = Remote(link, "run", name)
        yield remotes
        for remote in remotes.values():
            remote.finish()
        for thread in threads:
            thread.join(10.0)


def started(remotes, clock) -> Coupled:
    """Both sides at t = 0."""
    fluid, solid = remotes["fluid"], remotes["solid"]
    mapping = build_mapping(solid.describe(), fluid.describe())
    options = {"rollback": True, "frames": 1, "probe_rows": 1}
    points, _ = solid.start(clock, mapping.selection, **options)
    ghosts = mapping.motion(points)
    loads, _ = fluid.start(clock, range(mapping.matrix.shape[0]), ghosts, **options)
    return Coupled(
        fluid, solid, mapping, points, ghosts, Predictor(0, mapping.loads(loads, points, ghosts)), Predictor(0, points)
    )


@pytest.mark.timeout(90)
@pytest.mark.parametrize("scheme", ["serial-explicit", "parallel-explicit", "parallel-implicit"])
def test_a_window_takes_the_sum_in_turn_and_the_longer_side_at_once(toy_spring, toy_weight, scheme):
    coupling = Coupling(scheme=scheme, max_iterations=2, on_cap="accept")
    clock = Clock(0.3, WINDOWS + 1)
    take = make_taker(Plan(scheme, clock.window_length), coupling)
    with working_sides({"fluid": toy_weight(3.0, 2.0), "solid": toy_spring()}) as remotes:
        c = started(remotes, clock)
        take(c, clock.window(0))
        begun = time.perf_counter()
        evaluations = sum(len(take(c, clock.window(k)).changes) for k in range(1, WINDOWS + 1))
        spent = (time.perf_counter() - begun) / evaluations
    expected = sum(WORK.values()) if scheme.startswith("serial") else max(WORK.values())
    assert expected <= spent < expected + 0.1


def early(model):
    """`model`, settling for half a structure's window after it has told its loads; its steps each time it settled."""
    settled = []

    def settle():
        time.sleep(SETTLING)
        settled.append(model.steps())

    model.reach, model.settle = model.advance, settle
    return model, settled


@pytest.mark.timeout(60)
def test_a_side_settles_while_its_partner_works(toy_spring, toy_weight):
    """The fluid takes no time for its loads, and then settles; neither side waits, and that is what is told."""
    clock = Clock(0.3, WINDOWS)
    fluid, settled = early(toy_weight(3.0, 2.0))
    with working_sides({"fluid": fluid, "solid": toy_spring()}) as remotes:
        c = started(remotes, clock)
        take = make_taker(Plan("serial-explicit", clock.window_length), Coupling(scheme="serial-explicit"))
        working, begun = Working(0.0, c.fluid, c.structure), time.perf_counter()
        for k in range(WINDOWS):
            take(c, clock.window(k))
            working.note()
        spent = time.perf_counter() - begun
    assert settled == [10, 20, 30], "once a window, and before the probes that are due at the end"
    assert WINDOWS * WORK["solid"] + SETTLING <= spent < WINDOWS * WORK["solid"] + SETTLING + 0.1
    assert spent - 0.05 < working.seconds < spent


@pytest.mark.timeout(60)
def test_waiting_costs_no_processor_time(toy_spring, toy_weight):
    """One side works (asleep here), the coupler and the other side wait: all three, and zenoh, in this process."""
    clock = Clock(0.3, WINDOWS)
    with working_sides({"fluid": toy_weight(), "solid": toy_spring()}) as remotes:
        c = started(remotes, clock)
        begun, used = time.perf_counter(), time.process_time()
        for k in range(WINDOWS):
            c.structure.advance(clock.window(k), c.loads.predict(clock.window(k)), final=True)
        spent, used = time.perf_counter() - begun, time.process_time() - used
    assert spent >= WINDOWS * WORK["solid"]
    assert used < 0.1 * spent
