"""Time is counted, never accumulated."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from shared.clock import Clock, Window


@given(st.floats(1e-6, 1e3), st.integers(1, 100_000))
def test_windows_meet_exactly_and_fill_the_run(end, count):
    clock = Clock(end, count)
    assert clock.window(0).t0 == 0.0
    assert clock.window(count - 1).t1 == end
    assert clock.window(count // 2).t1 == clock.time(count // 2 + 1)


@given(st.floats(1e-3, 10.0), st.floats(1e-4, 1.0))
def test_fitting_never_exceeds_the_window_asked_for(end, window):
    clock = Clock.fitting(end, window)
    assert clock.window_length <= window * (1 + 1e-9)
    assert clock.count == 1 or end / (clock.count - 1) > window * (1 - 1e-9)


@given(st.integers(1, 500), st.integers(1, 500))
def test_every_event_falls_in_some_window_and_the_last_in_the_last(count, events):
    clock = Clock(1.0, count)
    crossed = [clock.crosses(i, events) for i in range(count)]
    assert crossed[-1]
    assert sum(crossed) == min(count, events)


def test_substeps_are_the_fewest_that_are_stable():
    window = Window(0, 0.0, 1.0)
    assert [window.substeps(s) for s in (2.0, 1.0, 0.5, 0.49, 0.1)] == [1, 1, 2, 3, 10]
