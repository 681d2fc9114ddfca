"""A run that is asked to stop (Ctrl-C, a request to end, a closed terminal) does so between two windows, with a
checkpoint to go on from; asked again, or while it marches through no windows, it stops at once. What it has it writes
down in any case, however often it is asked. A process that serves another ends with it."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator

from shared.contract import ParticipantLost

_LOOK_EVERY_S = 1.0
_ONCE_MORE_AFTER_S = 0.05
_ONCE_MORE = b"\nstopping after this window, with a checkpoint; ask again to stop at once\n"


class Stop:
    """Whether the process has been `asked` to stop while a march of windows `waits` for a good moment; one that is
    `ending` need not be asked."""

    def __init__(self) -> None:
        self.waits = self.asked = self.ending = False
        self.number = signal.SIGINT  # the signal that asked last

    def ask(self, number: int = 0, frame: object = None) -> None:
        """Answer a signal."""
        self.number = number or self.number
        if self.ending:
            return
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


def ask_once_more(unraisable) -> None:
    """A hook for errors that Python cannot raise: a request to stop that came while an object was being removed comes
    again a little later."""
    if issubclass(unraisable.exc_type, KeyboardInterrupt):
        main = threading.main_thread().ident
        threading.Timer(_ONCE_MORE_AFTER_S, signal.pthread_kill, (main, STOP.number)).start()
    else:
        sys.__unraisablehook__(unraisable)


@contextlib.contextmanager
def stopping_between_windows() -> Iterator[Stop]:
    """While this lasts a request to stop waits for `Stop.here`."""
    STOP.waits, STOP.asked, STOP.ending = True, False, False
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
