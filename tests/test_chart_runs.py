"""The runs of a chart: which results count, whom a folder belongs to, and what becomes of runs that were cut short."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from coupler.chart.outcome import kept, missing, of_other_code, without_result
from coupler.chart.runs import _clear, claimed, run_variants
from coupler.chart.variants import study_variants
from shared.contract import BadInput, ParticipantLost, SolverFailed
from shared.run.checkpoint import newest
from shared.run.claims import claim
from shared.run.record import _status
from shared.run.results import environment
from tests.charts import loaded_beam, wait_until

pytestmark = pytest.mark.timeout(180)

STUDY = """
[study]
truth = "2-D elasticity"
sets = ["output.frames=1", "solid.model=beam"]
families = [{ name = "beam", vary = [[["solid.dx=6e-3"], ["solid.dx=5e-3"]]] }]
"""
RESULT = {"schema": 1, "case": "small", "status": "finished", "reason": "", "t_end": 0.3, "probes": {}}
RESULT |= {"references": [], "cost": {}, "environment": environment({})}


@pytest.fixture
def case(tmp_path):
    return loaded_beam(tmp_path, STUDY)


def test_faults_of_the_machine_are_not_those_of_what_was_computed():
    for error in (ParticipantLost("killed"), OSError(28, "No space left on device"), MemoryError()):
        assert _status(error)[0] == "lost"
    assert _status(SolverFailed("frames cannot be written ([Errno 28] No space left on device)"))[0] == "lost"
    assert _status(SolverFailed("The solid failed at t = 1 s"))[0] == "failed"


def test_results_that_are_damaged_or_lost_are_not_kept(case, tmp_path):
    variant = study_variants(case)[0]

    def written(text, probes="t,mean_y\n0.0,1.0\n1.0,2.0\n"):
        (tmp_path / "result.json").write_text(text, encoding="utf-8")
        (tmp_path / "probes.csv").write_text(probes.replace("mean_y", variant.scene.goal.probe), encoding="utf-8")
        return kept(variant, tmp_path)

    assert written(json.dumps(RESULT)) == RESULT
    assert written(json.dumps(RESULT | {"status": "failed"}))["status"] == "failed"
    for status in ("lost", "interrupted"):
        assert written(json.dumps(RESULT | {"status": status})) is None
    assert written('{"status": "fin') is None
    for probes in ("junk\n1\n", "t,mean_y\n0.0,x\n", "t,mean_y\n", ""):
        assert written(json.dumps(RESULT), probes) is None


@pytest.mark.parametrize(
    ("log", "code", "status", "reason"),
    [
        ("warning: 3 particles\nerror: no room ([Errno 28])\n", 3, "lost", "no room ([Errno 28])"),
        (
            "warning: a\n  \0\0   error: pre-flight refuses\n  Mach = 3\nmore",
            2,
            "refused",
            "pre-flight refuses Mach = 3",
        ),
        ("warning: 3 particles\n", 137, "lost", "its run was ended by signal 9"),
        ("Traceback\n  line\nKeyError: 'x'\n", 1, "lost", "its run ended with exit code 1: KeyError: 'x'"),
        ("", 1, "lost", "its run ended with exit code 1: no word in its log"),
    ],
)
def test_why_there_is_no_result(log, code, status, reason):
    assert without_result(log, code) == {"status": status, "reason": reason}


def test_what_is_missing_is_named_with_the_way_out(case, tmp_path):
    variants = study_variants(case)
    results = [{"status": "lost", "reason": "killed\nEnd of its log"}, {"status": "refused", "reason": "Mach."}]
    lost, refused = missing(variants, results, [None, None], tmp_path)
    assert lost == "Missing: beam, solid.dx=6e-3: lost, killed: the same command runs it again."
    assert refused == "Missing: beam, solid.dx=5e-3: refused, Mach: mend the scene or the study, and chart again."
    assert missing(variants, [RESULT, RESULT], [1.0, 2.0], tmp_path) == []


def test_results_of_other_code_are_named():
    versions = environment({})["versions"]
    other = RESULT | {"environment": {"versions": versions | {"numpy": "1.0", "python": "3.0"}}}
    assert of_other_code([RESULT, {"status": "lost"}]) == []
    (said,) = of_other_code([RESULT, other])
    assert said.startswith(f"1 of 2 variants were computed by other code (numpy 1.0 then, {versions['numpy']} now)")


def test_a_run_that_goes_on_is_not_torn_down(tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    (run / "case.toml").touch()
    with claim(run), pytest.raises(BadInput, match="still going on"):
        _clear(run)
    _clear(run)
    assert not run.exists()


def chart(case, folder, *more):
    words = [sys.executable, "-m", "coupler", "chart", case, "--out", str(folder), "--set", "end_time=1000.0", *more]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def marching(folder, count):
    return sum(path.read_text().count("\n") > 3 for path in folder.glob("runs/*/probes.csv")) == count


def test_a_chart_keeps_others_out_ends_with_all_its_runs_and_goes_on_with_them(case, tmp_path):
    folder = tmp_path / "chart"
    first = chart(case, folder, "--jobs", "2")
    wait_until(lambda: marching(folder, 2))
    with pytest.raises(BadInput, match=rf"process {first.pid}\) is at work in"):
        run_variants(case, study_variants(case), folder / "runs", 1, print)
    first.send_signal(signal.SIGKILL)
    first.communicate()
    second = chart(case, folder, "--jobs", "2")  # waits for the runs of the first, which end by themselves
    said = second.stdout.readline()
    wait_until(lambda: marching(folder, 2))
    asked = time.monotonic()
    second.send_signal(signal.SIGINT)
    out, errors = second.communicate(timeout=60)
    assert time.monotonic() - asked < 15.0
    assert second.returncode == 130, errors
    assert "going on with beam" in said + out
    assert out.count("  interrupted\n") == 2
    for variant in folder.glob("runs/beam-*/"):
        assert newest(variant).time > 0.0
        with claim(variant):
            assert json.loads((variant / "result.json").read_text())["status"] == "interrupted"


def test_a_claim_is_free_again_once_its_chart_has_ended(tmp_path):
    with claimed(tmp_path):
        assert (tmp_path / "chart.lock").read_text() == f"{os.getpid()}\n"
    with claimed(tmp_path):
        pass
