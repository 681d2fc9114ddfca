"""Requests to stop that come at a bad moment."""

from __future__ import annotations

import signal
import threading
from types import SimpleNamespace

import pytest

import shared.record
from shared.record import Record
from shared.results import read_result, write_result
from shared.scene import load_scene
from shared.stopping import STOP, ask_once_more, stopping_between_windows


def test_what_a_run_has_is_written_down_however_often_it_is_asked_to_stop(tmp_path, monkeypatch):
    def asked_meanwhile(run_dir, result):
        STOP.ask()
        return write_result(run_dir, result)

    monkeypatch.setattr(shared.record, "write_result", asked_meanwhile)
    monkeypatch.setattr(shared.record, "draw_pictures", lambda *_: [])
    with pytest.raises(KeyboardInterrupt), Record(tmp_path, load_scene("piston"), "piston", {}, True):
        raise KeyboardInterrupt
    STOP.ask()  # on its way out
    assert read_result(tmp_path)["status"] == "interrupted"
    with stopping_between_windows():
        STOP.ask()  # another run waits for the end of its window
        with pytest.raises(KeyboardInterrupt):
            STOP.here()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_request_that_python_cannot_raise_comes_once_more(number, monkeypatch):
    came = threading.Event()
    monkeypatch.setattr(STOP, "number", number)
    before = signal.signal(number, lambda *_: came.set())
    try:
        ask_once_more(SimpleNamespace(exc_type=KeyboardInterrupt))
        assert came.wait(5.0)
    finally:
        signal.signal(number, before)
