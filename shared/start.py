"""The first lines of every command: until the libraries are loaded, Ctrl-C ends it at once and without a traceback, and
a machine that cannot load them is told of in a sentence."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Iterator

INTERRUPTED = 130
STOP_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


def on_stop_signals(handler) -> None:
    """Let `handler(number, frame)` answer Ctrl-C, a request to end and a closed terminal, unless they are ignored
    (as `nohup` and a shell's background jobs have it)."""
    for number in STOP_SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


@contextlib.contextmanager
def loading() -> Iterator[None]:
    """Context in which the libraries are imported; `run_app` takes over the signals afterwards."""
    on_stop_signals(lambda number, frame: os._exit(INTERRUPTED))
    try:
        yield
    except (ImportError, OSError, MemoryError, ValueError) as error:
        print(
            f"error: this program cannot be loaded ({str(error) or type(error).__name__}): it may lack memory "
            "(ulimit -v), open files (ulimit -n), or a part that was not installed (pip install it again), or a "
            "variable of the environment that a library reads is wrong (like NUMBA_NUM_THREADS=0)",
            file=sys.stderr,
        )
        sys.exit(3)
