"""What is said to nobody ends nothing: closed streams, readers that have gone, a full disk behind standard output."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from shared.run.results import read_result
from tests.scenes import tiny_coupled

TALK = """
import os, sys, tempfile
from shared.streams import lost_output, open_streams
open_streams()
print("to whom it may concern", flush=True)
print("to whom it may concern", file=sys.stderr)
assert tempfile.TemporaryFile().fileno() > 2
sys.exit(3 if lost_output() else 0)
"""


def nobody() -> int:
    """The writing end of a pipe whose reader has gone."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


@pytest.mark.parametrize("closed", [(), (0,), (1,), (2,), (0, 1, 2)])
def test_words_to_nobody_end_nothing(closed):
    done = subprocess.run(
        [sys.executable, "-c", TALK],
        stdout=nobody(),
        stderr=nobody(),
        timeout=60,
        preexec_fn=lambda: [os.close(number) for number in closed],
    )
    assert done.returncode == 0


def test_output_that_a_full_disk_lost_is_told_of():
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "coupler", "cases"], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 3
    assert "not all could be printed" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.timeout(200)
def test_a_run_whose_terminal_was_closed_goes_on_to_its_result(tmp_path):
    words = ["solid_solver", "run", str(tiny_coupled(tmp_path, end_time=1e-4)), "--out", str(tmp_path / "run")]
    done = subprocess.run([sys.executable, "-m", *words, "--threads", "1"], stdout=nobody(), stderr=nobody())
    assert done.returncode == 0
    assert read_result(tmp_path / "run")["status"] == "finished"
