"""Progress in a log: few lines, the right time left, nothing when quiet."""

import io

import pytest

from shared.run import progress
from shared.run.progress import Progress


@pytest.fixture
def wall(monkeypatch):
    """A wall clock that the test turns."""
    clock = {"now": 100.0}
    monkeypatch.setattr(progress.time, "monotonic", lambda: clock["now"])
    return clock


def run(wall, seconds, quiet=False, steps=1000):
    """The lines of a run of 2 s that takes `seconds` of wall time."""
    output = io.StringIO()
    with Progress("Still tank", 2.0, quiet) as bar:
        bar._console.file = output
        for step in range(steps + 1):
            bar.update(2.0 * step / steps)
            wall["now"] += seconds / steps
    return output.getvalue().splitlines()


def test_a_long_run_writes_a_line_every_ten_seconds(wall):
    lines = run(wall, 1000.0)
    assert 95 <= len(lines) <= 102


def test_a_short_run_writes_a_line_every_twentieth_at_most(wall):
    assert 15 <= len(run(wall, 40.0)) <= 21
    assert len(run(wall, 2.0)) <= 4


def test_time_left_follows_from_the_rate(wall):
    half = next(line for line in run(wall, 1000.0) if line.startswith(" 50 %"))
    assert "2 ms/s" in half
    left = half.split("/s  ")[1].split(" left")[0]
    minutes, seconds = left.split(":")
    assert 60 * int(minutes) + int(seconds) == pytest.approx(500, abs=12)


def test_quiet_is_silent(wall, capfd):
    assert run(wall, 1000.0, quiet=True) == []
    assert capfd.readouterr() == ("", "")


def interrupted():
    with Progress("Still tank", 2.0) as bar:
        bar.update(1.0)
        raise KeyboardInterrupt


def test_an_interruption_goes_through_and_says_how_far_it_came(wall, capfd):
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert "t = 1 of 2 s" in capfd.readouterr().err
