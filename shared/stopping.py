"""A run that is asked to stop (Ctrl-C, a request to end, a closed terminal) does so between two windows, with a
checkpoint to go on from; asked again, or while it marches through no windows, it stops at once. A process that
serves another ends with it."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Iterator

from shared.contract import ParticipantLost

_LOOK_EVERY_S = 1.0
_ONCE_MORE = b"\nstopping after this window, with a checkpoint; ask again to stop at once\n"


class Stop:
    """Whether the process has been `asked` to stop while a march of windows `waits` for a good moment."""

    def __init__(self) -> None:
        self.waits = self.asked = False

    def ask(self, number: int = 0, frame: object = None) -> None:
        """Answer a signal."""
        if not self.waits or self.asked:
            raise KeyboardInterrupt
        self.asked = True
        with contextlib.suppress(OSError):
            os.write(2, _ONCE_MORE)  # unbuffered: the signal may have come in the middle of a print

    def here(self) -> None:
        """Between two windows, all that can be kept is kept: stop, if asked."""
        if self.asked:
            raise KeyboardInterrupt


STOP = Stop()
"""That of this process, as its signals are."""


@contextlib.contextmanager
def stopping_between_windows() -> Iterator[Stop]:
    """While this lasts a request to stop waits for `Stop.here`."""
    STOP.waits, STOP.asked = True, False
    try:
        yield STOP
    finally:
        STOP.waits = False


def end_with(parent: int | None) -> None:
    """End this process at once, whatever it is doing, when process `parent`, which started it, has ended."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK_EVERY_S)
        os._exit(ParticipantLost.exit_code)

    if parent is not None:
        threading.Thread(target=watch, daemon=True).start()
