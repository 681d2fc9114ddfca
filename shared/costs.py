"""What one side of a run costs: steps, and time in them and in output."""

from __future__ import annotations

import contextlib
import resource
import time
from collections.abc import Iterator, Mapping

_NAMES = ("steps", "busy_s", "output_s", "outgrown_windows", "core_s", "stepping_core_s")


class Costs:
    """Counted as the run goes. `outgrown`: windows whose steps were too long for the state at their end."""

    def __init__(self) -> None:
        self.outgrown = 0
        self._busy, self._writing = 0.0, 0.0  # time spent in steps, and in probes, frames and checkpoints [s]
        self._core_at_start, self._core_writing = 0.0, 0.0  # processor time: before the first step, and of output [s]
        self._earlier = dict.fromkeys(_NAMES, 0.0)  # of a run that this one goes on with

    def begin(self) -> None:
        """The first step is next."""
        self._core_at_start = time.process_time()

    def go_on_from(self, earlier: Mapping[str, float]) -> None:
        """Count what a run had cost, as `so_far`, that this one goes on with."""
        self._earlier = {name: float(value) for name, value in earlier.items()}

    @contextlib.contextmanager
    def stepping(self) -> Iterator[None]:
        """Counts the time spent inside as that of steps."""
        begun = time.perf_counter()
        yield
        self._busy += time.perf_counter() - begun

    @contextlib.contextmanager
    def output(self) -> Iterator[None]:
        """Counts the time spent inside as output."""
        begun, core = time.perf_counter(), time.process_time()
        yield
        self._writing += time.perf_counter() - begun
        self._core_writing += time.process_time() - core

    @property
    def spent(self) -> float:
        """Time [s] spent in steps and in output by this process."""
        return self._busy + self._writing

    def so_far(self, steps: int) -> dict[str, float]:
        """All costs with the `steps` of this process, and those of the run before it, if it goes on with one."""
        usage = resource.getrusage(resource.RUSAGE_SELF)
        now = (
            steps,
            self._busy,
            self._writing,
            self.outgrown,
            usage.ru_utime + usage.ru_stime,
            time.process_time() - self._core_at_start - self._core_writing,
        )
        return {name: self._earlier[name] + value for name, value in zip(_NAMES, now, strict=True)}
