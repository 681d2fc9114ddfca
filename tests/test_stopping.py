"""Requests to stop, and faults, that come at a bad moment."""

from __future__ import annotations

import errno
import signal
import threading
from types import SimpleNamespace

import pytest

import shared.run.pictures
import shared.run.record
from shared.contract import ShearwaterError
from shared.run.checkpoint import Checkpoints
from shared.run.record import Record
from shared.run.results import read_result, write_result
from shared.run.resume import unfinished
from shared.scene.reading import load_scene
from shared.stopping import STOP, ask_once_more, stopping_between_windows
from shared.unwritable import cannot_write


def test_what_a_run_has_is_written_down_however_often_it_is_asked_to_stop(tmp_path, monkeypatch):
    def asked_meanwhile(run_dir, result):
        STOP.ask()
        return write_result(run_dir, result)

    monkeypatch.setattr(shared.run.record, "write_result", asked_meanwhile)
    monkeypatch.setattr(shared.run.pictures, "draw_pictures", lambda *_: [])
    with pytest.raises(KeyboardInterrupt), Record(tmp_path, load_scene("piston"), "piston", {}, True):
        raise KeyboardInterrupt
    STOP.ask()  # on its way out
    assert read_result(tmp_path)["status"] == "interrupted"
    with stopping_between_windows():
        STOP.ask()  # another run waits for the end of its window
        with pytest.raises(KeyboardInterrupt):
            STOP.here()


def test_a_scene_that_another_program_took_stands_again(tmp_path, monkeypatch, capsys):
    """It was gone without a word, and the command that goes on, named at the end, was refused."""
    monkeypatch.setattr(shared.run.pictures, "draw_pictures", lambda *_: [])

    def run():
        with Record(tmp_path, load_scene("piston"), "piston", {"solid": 1}, True) as record:
            checkpoints = Checkpoints(tmp_path, 1.0)
            checkpoints.seal(checkpoints.begin(0), 0, 0.0, record.notes())
            (tmp_path / "case.toml").unlink()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run()
    assert "case.toml was gone, removed by another program" in capsys.readouterr().err
    unfinished(tmp_path).held.close()
    (tmp_path / "case.toml").unlink()  # of a run that was killed
    unfinished(tmp_path).held.close()
    assert "piston" in (tmp_path / "case.toml").read_text(encoding="utf-8")


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


def test_a_full_disk_is_told_of_with_the_way_on_whatever_cannot_be_written_besides(tmp_path, monkeypatch, capsys):
    full = OSError(errno.ENOSPC, "No space left on device")

    def no_picture(*_):
        raise cannot_write("The picture", tmp_path / "last_frame.png", full)

    def run(run_dir, fault):
        run_dir.mkdir()
        with Record(run_dir, load_scene("piston"), "piston", {}, True) as record:
            checkpoints = Checkpoints(run_dir, 1.0)
            checkpoints.seal(checkpoints.begin(0), 0, 0.0, record.notes())
            if fault is not None:
                raise fault

    monkeypatch.setattr(shared.run.pictures, "draw_pictures", no_picture)
    with pytest.raises(ShearwaterError, match="The file of frames"):
        run(tmp_path / "cut", cannot_write("The file of frames", tmp_path / "solid.vtkhdf", full))
    errors = capsys.readouterr().err
    assert "warning: The picture" in errors
    assert f"coupler resume {tmp_path / 'cut'}\n" in errors
    assert read_result(tmp_path / "cut")["reason"].startswith("The file of frames")
    with pytest.raises(ShearwaterError, match="The picture"):
        run(tmp_path / "whole", None)
