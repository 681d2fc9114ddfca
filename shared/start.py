"""The first lines of every command: until the libraries are loaded, Ctrl-C ends it at once and without a traceback."""

from __future__ import annotations

import os
import signal

INTERRUPTED = 130
STOP_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


def on_stop_signals(handler) -> None:
    """Let `handler(number, frame)` answer Ctrl-C, a request to end and a closed terminal, unless they are ignored
    (as `nohup` and a shell's background jobs have it)."""
    for number in STOP_SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


def end_quietly_while_loading() -> None:
    """To be called before the libraries are imported; `run_app` takes over the signals afterwards."""
    on_stop_signals(lambda number, frame: os._exit(INTERRUPTED))
