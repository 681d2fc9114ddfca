"""The report of a run: one file that holds all there is to see, of runs that finished and of runs that did not."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest

from coupler.report import write_report
from shared.contract import BadInput
from shared.run.checkpoint import Checkpoints
from shared.run.claims import claim
from shared.run.probes import read_probes


def run(*words):
    return subprocess.run([sys.executable, "-m", *map(str, words)], capture_output=True, text=True, check=False)


def test_report_of_a_side_alone_holds_pictures_and_references(tmp_path):
    out = tmp_path / "run"
    sets = ["--set", "solid.model=beam", "--set", 'title="<b>Beam & load</b>"']
    assert run("solid_solver", "run", "udl_beam", "--out", out, "--quiet", "--threads", 1, *sets).returncode == 0
    page = write_report(out).read_text(encoding="utf-8")
    assert "&lt;b&gt;Beam &amp; load&lt;/b&gt;" in page
    assert "2-D elasticity" in page
    assert page.count("data:image/png;base64,") == len(list(out.glob("*.png")))
    assert not re.search(r'(src|href)="(?!data:)', page)


def test_report_of_a_coupled_run_holds_ledger_and_preflight(tmp_path):
    out = tmp_path / "run"
    words = ("--out", out, "--quiet", "--threads", "fluid=1,solid=1", "--set", "end_time=0.1")
    assert run("coupler", "run", "piston", *words).returncode == 0
    done = run("coupler", "report", out)
    assert done.returncode == 0, done.stderr
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "Ledger" in page
    assert "Pre-flight said" in page
    assert "mass ratio" in page


def test_report_of_a_failed_run_says_why(tmp_path):
    out = tmp_path / "run"
    sets = ["--set", "solid.model=beam", "--set", "solid.loads[0].traction=[0.0, -2e9]"]
    assert run("solid_solver", "run", "udl_beam", "--out", out, "--quiet", "--threads", 1, *sets).returncode == 3
    reason = json.loads((out / "result.json").read_text())["reason"]
    assert reason.split(":")[0] in write_report(out, tmp_path / "page.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"case": "x"}', "\xff\xfe"])
def test_a_result_that_is_damaged_is_named(tmp_path, text):
    (tmp_path / "result.json").write_text(text, encoding="latin-1")
    with pytest.raises(BadInput, match=r"result\.json .*--out"):
        write_report(tmp_path)


def test_a_result_with_wrong_kinds_is_named(tmp_path):
    words = ("--out", tmp_path / "run", "--quiet", "--threads", 1, "--set", "solid.model=beam")
    assert run("solid_solver", "run", "udl_beam", *words).returncode == 0
    path = tmp_path / "run" / "result.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"cost": [1, 2], "t_end": "late"}))
    with pytest.raises(BadInput, match=r"result\.json or its ledger\.csv does not hold"):
        write_report(tmp_path / "run")


def test_a_run_without_a_result_says_what_can_be_done(tmp_path):
    (tmp_path / "case.toml").touch()
    with pytest.raises(BadInput, match=r"was killed .*; run it again: coupler run .*case\.toml --out DIR"):
        write_report(tmp_path)
    with claim(tmp_path), pytest.raises(BadInput, match="still going on"):
        write_report(tmp_path)
    checkpoints = Checkpoints(tmp_path, 1.0)
    checkpoints.seal(checkpoints.begin(3), 3, 0.5, {})
    with pytest.raises(BadInput, match=r"go on from t = 0\.5 s with: coupler resume"):
        write_report(tmp_path)


@pytest.mark.parametrize("text", ["", "time,a\nx,1\n", "\xff\x00\n"])
def test_probes_that_are_damaged_are_named(tmp_path, text):
    (tmp_path / "probes.csv").write_text(text, encoding="latin-1")
    with pytest.raises(BadInput, match=r"probes\.csv is not a readable table"):
        read_probes(tmp_path / "probes.csv")


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(BadInput, match=r"holds no result\.json"):
        write_report(tmp_path)
