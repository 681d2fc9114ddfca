"""How far a run is: a live bar on a terminal, plain lines elsewhere, nothing when quiet. All on standard error."""

from __future__ import annotations

import math
import time

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

_REFRESH_S = 0.1  # a terminal shows no more
_BAR_WIDTH = 20  # leaves room for the words on 80 columns
_LINE_EVERY_S = 10.0
_LINE_EVERY_FRACTION = 0.05
_LINE_APART_S = 1.0  # short runs do not flood a log


class Progress:
    """Context in which a run of `end_time` [s] reports its time by `update`; cheap enough to call every window."""

    def __init__(self, title: str, end_time: float, quiet: bool = False):
        self._title, self._end, self._quiet = title, end_time, quiet
        self._console = Console(stderr=True)
        self._bar: Bar | None = None
        self._task = TaskID(0)
        self._time = 0.0
        self._note = ""

    def __enter__(self) -> Progress:
        self._begun = self._shown = time.monotonic()
        self._first: tuple[float, float] | None = None
        self._shown_time = 0.0
        if self._quiet:
            return self
        if self._console.is_terminal:
            self._bar = Bar(
                BarColumn(bar_width=_BAR_WIDTH),
                TextColumn("{task.percentage:3.0f} %"),
                TextColumn("{task.fields[state]}"),
                TimeElapsedColumn(),
                console=self._console,
            )
            self._console.print(escape(self._title))
            self._task = self._bar.add_task("", total=self._end, state="starting")
            self._bar.start()
        else:
            self._line(f"{self._title}: starting, {self._end:g} s to simulate")
        return self

    def update(self, now: float, note: str = "") -> None:
        """The run has reached `now` [s]; `note` is a word on how it goes."""
        self._time, self._note = now, note
        wall = time.monotonic()
        if self._first is None and now > 0.0:  # the first window compiles
            self._first = (wall, now)
        if self._quiet:
            return
        since = wall - self._shown
        if self._bar is not None:
            due = since >= _REFRESH_S
        else:
            further = now - self._shown_time >= _LINE_EVERY_FRACTION * self._end
            due = since >= _LINE_EVERY_S or (further and since >= _LINE_APART_S)
        if due:
            self._shown, self._shown_time = wall, now
            self._show(wall)

    def __exit__(self, *_) -> None:
        if self._quiet:
            return
        if self._bar is not None:
            self._show(time.monotonic())
            self._bar.stop()
        else:
            self._line(f"{self._reached()} after {_duration(time.monotonic() - self._begun)}")

    def _show(self, wall: float) -> None:
        state = self._reached() + self._rate(wall) + (f"  {self._note}" if self._note else "")
        if self._bar is not None:
            self._bar.update(self._task, completed=self._time, state=escape(state))
        else:
            self._line(f"{100.0 * self._time / self._end:3.0f} %  {state}")

    def _reached(self) -> str:
        return f"t = {self._time:.4g} of {self._end:g} s"

    def _rate(self, wall: float) -> str:
        """Time simulated per second of running, and the running time left at that rate."""
        if self._first is None or self._time <= self._first[1]:
            return ""
        rate = (self._time - self._first[1]) / (wall - self._first[0])
        return f"  {_small(rate)}/s  {_duration((self._end - self._time) / rate)} left"

    def _line(self, text: str) -> None:
        print(text, file=self._console.file, flush=True)


def _small(seconds: float) -> str:
    """Seconds with the prefix that leaves one to three digits before the point."""
    for factor, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds:.1e} s"


def _duration(seconds: float) -> str:
    """Seconds as 12 s, 3:05 or 1:02:03."""
    whole = math.ceil(seconds)
    hours, minutes = whole // 3600, whole % 3600 // 60
    if hours:
        return f"{hours}:{minutes:02d}:{whole % 60:02d}"
    return f"{minutes}:{whole % 60:02d}" if minutes else f"{whole} s"
