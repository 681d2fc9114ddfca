"""A run that was cut short goes on from its last checkpoint, to the same bytes; what cannot go on says why."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import coupler.run
import shared.solo
from coupler.report import write_report
from coupler.run import resume_coupled, run_coupled
from fluid_solver.models import make_model
from shared.contract import BadInput, ShearwaterError
from shared.run.checkpoint import Checkpoints, newest, read_state, write_state
from shared.run.claims import claim
from shared.run.resume import unfinished
from shared.run.vtkhdf import FrameWriter, read_frame
from shared.scene.reading import load_scene
from shared.solo import resume_alone, run_alone
from tests.scenes import tiny_coupled

ONE = {"fluid": 1, "solid": 1}
OFTEN = "output.checkpoint_every=1e-9"
pytestmark = pytest.mark.timeout(240)


def piston(*sets):
    return load_scene("piston", ["end_time=0.02", "output.frames=7", "output.probe_interval=1e-3", *sets])


def same_output(first, second):
    for name in ("probes.csv", "ledger.csv"):
        if (first / name).exists():
            assert (first / name).read_bytes() == (second / name).read_bytes(), name
    for path in first.glob("*.vtkhdf"):
        same_frames(path, second / path.name)


def same_frames(first, second):
    for index in range(8):
        (time_a, a), (time_b, b) = read_frame(first, index), read_frame(second, index)
        assert time_a == time_b
        assert a.position.tobytes() == b.position.tobytes()
        assert all(a.fields[name].tobytes() == b.fields[name].tobytes() for name in a.fields)


def cut_short(monkeypatch, where, name, calls, run, *args):
    """Do `run(*args)`, whose function `name` of `where` fails as an interrupted run does after so many calls."""
    inner, left = getattr(where, name), iter(range(calls))

    def failing(*given):
        if next(left, None) is None:
            raise KeyboardInterrupt
        return inner(*given)

    with monkeypatch.context() as patch:
        patch.setattr(where, name, failing)
        with pytest.raises(KeyboardInterrupt):
            run(*args)


@pytest.mark.parametrize(
    "scheme",
    [
        ["coupling.scheme=serial-explicit", "coupling.predictor=2"],
        ["coupling.scheme=serial-implicit", "coupling.acceleration=aitken"],
        ["coupling.scheme=parallel-implicit", "coupling.acceleration=iqn-ils", "coupling.reuse=3"],
        ["coupling.scheme=auto"],
    ],
    ids=lambda sets: sets[0].partition("=")[2],
)
def test_every_scheme_goes_on_with_its_memory(scheme, tmp_path, monkeypatch):
    scene = piston(OFTEN, *scheme)
    whole = run_coupled(scene, "piston", tmp_path / "whole", ONE, True, "inprocess").result
    half = whole["cost"]["coupling"]["windows"] // 2
    given = (scene, "piston", tmp_path / "cut", ONE, True, "inprocess")
    cut_short(monkeypatch, coupler.run, "probes", half, run_coupled, *given)
    again = unfinished(tmp_path / "cut")
    assert again.last.window == half
    found = resume_coupled(again, ONE, "inprocess", True).result
    same_output(tmp_path / "whole", tmp_path / "cut")
    assert found["status"] == "finished"
    assert found["probes"] == whole["probes"]
    assert found["ledger"] == whole["ledger"]
    assert found["case_hash"] == whole["case_hash"]
    for name in ("iterations_mean", "iterations_most", "not_converged", "reasons"):
        assert found["cost"]["coupling"][name] == whole["cost"]["coupling"][name], name
    assert found["cost"]["fluid"]["steps"] == whole["cost"]["fluid"]["steps"]
    assert found["cost"]["coupling"]["core_s"] > 0.0


def test_a_process_counts_once(tmp_path):
    """Both sides in the coupler's own process: its processor time is that of the run, not three times over."""
    begun = time.process_time()
    cost = run_coupled(piston(OFTEN), "piston", tmp_path / "run", ONE, True, "inprocess").result["cost"]
    assert 0.0 < cost["coupling"]["core_s"] <= time.process_time() - begun
    assert cost["core_s"] <= time.process_time()


def test_a_run_whose_directory_is_removed_does_not_blame_the_disk(tmp_path, monkeypatch):
    given = (piston(OFTEN), "piston", tmp_path / "run", ONE, True, "inprocess")
    calls, inner = iter(range(5)), coupler.run.probes

    def removing(c):
        if next(calls, None) is None:
            shutil.rmtree(tmp_path / "run", ignore_errors=True)
        return inner(c)

    monkeypatch.setattr(coupler.run, "probes", removing)
    with pytest.raises(ShearwaterError, match=r"run is gone, removed or moved after the run began") as error:
        run_coupled(*given)
    assert "disk" not in str(error.value)
    assert not (tmp_path / "run").exists()


def test_a_run_directory_needs_nothing_from_elsewhere(tmp_path, monkeypatch):
    """The curve that a probe is compared with goes while the run lasts, and its directory is taken elsewhere."""
    curve = tmp_path / "curve.csv"
    curve.write_text("time,x\n0.0,0.0\n0.01,2e-3\n")
    reference = f'references=[{{ probe = "piston_x", name = "own", curve = "{curve}", statistic = "mean" }}]'
    given = (piston(OFTEN, reference), "piston", tmp_path / "run", ONE, True, "inprocess")
    calls, inner = iter(range(5)), coupler.run.probes

    def removing(c):
        if next(calls, None) is None:
            curve.unlink(missing_ok=True)
        return inner(c)

    with monkeypatch.context() as patch:
        patch.setattr(coupler.run, "probes", removing)
        cut_short(patch, coupler.run, "probes", 8, run_coupled, *given)
    elsewhere = (tmp_path / "run").rename(tmp_path / "taken elsewhere")
    (row,) = resume_coupled(unfinished(elsewhere), ONE, "inprocess", True).result["references"]
    assert row["value"] == pytest.approx(1e-3)
    assert write_report(elsewhere).stat().st_size > 10_000
    assert 'curve = "references/1.csv"' in (elsewhere / "case.toml").read_text(encoding="utf-8")


def test_what_was_lost_before_a_break_counts_in_the_end(tmp_path, monkeypatch):
    """Water falls out of a domain that ends in it; the page of the run says so."""
    domain = "domain={ lower = [0.0, 0.0], upper = [0.1, 0.0601] }"
    hole = 'walls=[{ name = "far", polyline = [[1.0, 0.0], [1.0, 1.0]] }]'
    scene = load_scene(tiny_coupled(tmp_path, end_time=0.06), [OFTEN, domain, hole, "output.probe_interval=1e-3"])
    whole = run_alone(scene, "tiny", "fluid", make_model, tmp_path / "whole", 1, True).result["cost"]["fluid"]
    given = (scene, "tiny", "fluid", make_model, tmp_path / "cut", 1, True)
    cut_short(monkeypatch, shared.solo.Record, "at", 45, run_alone, *given)
    again = unfinished(tmp_path / "cut")
    before = read_state(again.last.part("fluid"))["model/cells"][3]
    found = resume_alone(again, "fluid", make_model, 1, True).result["cost"]["fluid"]
    assert 0 < before < found["lost"]
    assert {k: v for k, v in found.items() if "lost" in k} == {k: v for k, v in whole.items() if "lost" in k}
    assert f"{found['lost']} fluid particles" in write_report(tmp_path / "cut").read_text(encoding="utf-8")


def test_one_side_alone_goes_on(tmp_path, monkeypatch):
    scene = load_scene(tiny_coupled(tmp_path, end_time=0.02), [OFTEN, "output.frames=7", "output.probe_interval=1e-3"])
    run_alone(scene, "tiny", "fluid", make_model, tmp_path / "whole", 1, True)
    given = (scene, "tiny", "fluid", make_model, tmp_path / "cut", 1, True)
    cut_short(monkeypatch, shared.solo.Record, "at", 10, run_alone, *given)
    resume_alone(unfinished(tmp_path / "cut"), "fluid", make_model, 1, True)
    same_output(tmp_path / "whole", tmp_path / "cut")


def test_killed_run_goes_on_across_processes(tmp_path):
    scene, out = tiny_coupled(tmp_path, end_time=0.1), tmp_path / "run"
    sets = ["output.checkpoint_every=0.05", "output.frames=7", "output.probe_interval=1e-3"]
    options = ["--threads", "fluid=1,solid=1", "--quiet", *(word for text in sets for word in ("--set", text))]
    command = [sys.executable, "-m", "coupler", "run", str(scene), "--out"]
    process = subprocess.Popen([*command, str(out), *options], stderr=subprocess.PIPE, text=True)
    try:
        deadline = time.monotonic() + 100.0
        while not ((out / "probes.csv").exists() and (out / "probes.csv").read_text().count("\n") > 10):
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < deadline, "the run did not start"
            time.sleep(0.05)
    finally:
        process.kill()
        process.communicate()
    assert not (out / "result.json").exists()
    resume = [sys.executable, "-m", "coupler", "resume", str(out), "--quiet"]
    subprocess.run(resume, check=True, timeout=100)
    whole = [*command, str(tmp_path / "whole"), *options, "--link", "inprocess", "--set", "output.checkpoint_every=0"]
    subprocess.run(whole, check=True, timeout=100)
    same_output(tmp_path / "whole", out)
    assert json.loads((out / "result.json").read_text())["status"] == "finished"
    assert not (tmp_path / "whole" / "checkpoints").exists()
    over = subprocess.run(resume, capture_output=True, text=True, timeout=100)
    assert over.returncode == 2
    assert "has finished" in over.stderr


def sealed(checkpoints, window, value):
    folder = checkpoints.begin(window)
    write_state(folder / "side.h5", {"a/b": np.full(3, value), "c": np.array(7)})
    checkpoints.seal(folder, window, 0.1 * window, {"case": "x"})
    return folder


def test_two_newest_are_kept_and_a_damaged_one_is_passed_over(tmp_path):
    checkpoints = Checkpoints(tmp_path, 1e9)
    assert checkpoints.due()  # at t = 0
    folders = [sealed(checkpoints, window, float(window)) for window in (0, 5, 12)]
    assert not checkpoints.due()
    assert [folder.exists() for folder in folders] == [False, True, True]
    assert newest(tmp_path).window == 12
    state = read_state(newest(tmp_path).part("side"))
    assert state["a/b"].tolist() == [12.0] * 3
    with (folders[2] / "side.h5").open("r+b") as file:
        file.seek(-1, os.SEEK_END)
        file.write(b"?")
    last = newest(tmp_path)
    assert (last.window, last.time) == (5, 0.5)
    checkpoints.begin(20)  # begun, never sealed
    assert newest(tmp_path).window == 5
    begun = Checkpoints(tmp_path, 1e9, last).begin(8)
    assert sorted((tmp_path / "checkpoints").iterdir()) == [folders[1], begun]


def test_a_manifest_is_whole_or_damaged(tmp_path):
    checkpoints = Checkpoints(tmp_path, 1e9)
    path = sealed(checkpoints, 5, 1.0) / "manifest.json"
    text = path.read_text()
    for other in (text.replace('"t": 0.5', '"t": 0.6'), text[:-9], "[]", "{}"):
        path.write_text(other)
        with pytest.raises(BadInput, match=r"window-0000000005 is damaged \(manifest\.json\)"):
            newest(tmp_path)


@pytest.mark.parametrize("wrong", [{"window": "5"}, {"t": None}, {"notes": []}, {"notes": {"probe_rows": "3"}}])
def test_a_manifest_holds_what_is_needed_or_is_damaged(tmp_path, wrong):
    path = sealed(Checkpoints(tmp_path, 1e9), 5, 1.0) / "manifest.json"
    manifest = json.loads(path.read_text())
    del manifest["sum"]
    path.write_text(json.dumps(manifest))
    assert newest(tmp_path).window == 5
    path.write_text(json.dumps(manifest | wrong))
    with pytest.raises(BadInput, match=r"window-0000000005 is damaged \(manifest\.json\)"):
        newest(tmp_path)


def test_a_checkpoint_that_cannot_be_written_is_a_clear_error(tmp_path):
    (tmp_path / "checkpoints").write_text("in the way")
    with pytest.raises(ShearwaterError, match=r"cannot be written.*checkpoint_every=0"):
        Checkpoints(tmp_path, 1.0).begin(0)
    with pytest.raises(ShearwaterError, match="cannot be written"):
        write_state(tmp_path / "nowhere" / "side.h5", {"a": np.zeros(1)})


def test_what_cannot_go_on(tmp_path, monkeypatch):
    with pytest.raises(BadInput, match=r"no case\.toml"):
        unfinished(tmp_path)
    run_coupled(piston("output.checkpoint_every=0"), "piston", tmp_path / "run", ONE, True, "inprocess")
    with pytest.raises(BadInput, match="has finished"):
        unfinished(tmp_path / "run")
    (tmp_path / "run" / "result.json").unlink()
    with pytest.raises(BadInput, match="no complete checkpoint"):
        unfinished(tmp_path / "run")
    monkeypatch.setattr("shared.run.claims._PATIENCE_S", 0.2)
    with claim(tmp_path / "run"), pytest.raises(BadInput, match="still going on"):
        claim(tmp_path / "run")


def everything(run_dir):
    """Contents of all files of a run but logs."""
    files = (path for path in run_dir.rglob("*") if path.is_file() and path.parent.name != "log")
    return {str(path.relative_to(run_dir)): path.read_bytes() for path in files}


@pytest.fixture
def cut(tmp_path, monkeypatch):
    """Directory of a run that was cut short, past its last checkpoint by a few windows."""
    run_dir = tmp_path / "run"
    given = (piston("output.exchange=true", OFTEN), "piston", run_dir, ONE, True, "inprocess")
    due = iter([True] * 5 + [False] * 1000)
    with monkeypatch.context() as patch:
        patch.setattr(Checkpoints, "due", lambda self, last=False: next(due))
        cut_short(patch, coupler.run, "probes", 10, run_coupled, *given)
    return run_dir


def test_a_run_that_ends_while_another_waits_to_resume_it_stays_as_it_is(cut):
    """Whoever waits for the run to end looks at what it has left, not at what there was before."""
    found = []

    def resuming():
        try:
            found.append(unfinished(cut))
        except BadInput as error:
            found.append(str(error))

    with claim(cut):  # it still goes on
        waiting = threading.Thread(target=resuming)
        waiting.start()
        time.sleep(0.5)
        assert found == []
        result = json.loads((cut / "result.json").read_text())
        (cut / "result.json").write_text(json.dumps(result | {"status": "finished"}))
    waiting.join(10.0)
    assert "has finished" in found[0]


@pytest.mark.parametrize("spoiled", ["fluid", "run"])
def test_a_checkpoint_that_does_not_fit_leaves_all_as_it_was(cut, spoiled):
    again = unfinished(cut)
    assert len((cut / "probes.csv").read_text().splitlines()) > 1 + again.last.notes["probe_rows"]
    write_state(again.last.part(spoiled), {"nothing": np.zeros(1)})
    before = everything(cut)
    with pytest.raises(ShearwaterError, match="does not fit this run"):
        resume_coupled(again, ONE, "inprocess", True)
    assert everything(cut) == before


def test_a_scene_changed_since_is_refused(cut):
    case = cut / "case.toml"
    text = case.read_text(encoding="utf-8")
    probe = '\n[[probes]]\nname = "x"\nquantity = "leaked"\n'
    case.write_text(text.replace("end_time = 0.02", "end_time = 0.03") + probe, encoding="utf-8")
    with pytest.raises(BadInput, match=r"end_time = 0\.03, was 0\.02.*--out DIR") as refusal:
        unfinished(cut)
    assert '.name = "x", was nothing' in str(refusal.value)
    often = text.replace("checkpoint_every = 1e-09", "checkpoint_every = 60")
    assert often != text
    case.write_text(f"# a comment\n{often}", encoding="utf-8")
    assert resume_coupled(unfinished(cut), ONE, "inprocess", True).result["status"] == "finished"


@pytest.mark.parametrize("name", ["probes.csv", "ledger.csv"])
@pytest.mark.parametrize(
    ("text", "words"), [("time\n", "has 1 lines"), (None, "is gone"), ("\xff\n", "cannot be read")]
)
def test_tables_that_cannot_be_gone_on_with_say_so(cut, name, text, words):
    again, path = unfinished(cut), cut / name
    path.unlink()
    if text is not None:
        path.write_text(text, encoding="latin-1")
    with pytest.raises(BadInput, match=rf"{name} {words}.*--out DIR"):
        resume_coupled(again, ONE, "inprocess", True)


def test_frames_that_cannot_be_gone_on_with_say_so(cut, capsys):
    path = cut / "solid.vtkhdf"
    data = path.read_bytes()
    for spoiled in (data[: len(data) // 2], b"", b"not HDF5", data[:600] + bytes(400) + data[1000:]):
        path.write_bytes(spoiled)
        with pytest.raises(BadInput, match=r"solid\.vtkhdf, for it is damaged.*Move it away"):
            unfinished(cut)
    path.write_bytes(b"not HDF5")
    with pytest.raises(BadInput, match="damaged"):
        FrameWriter(path)
    path.unlink()
    again = unfinished(cut)
    assert "solid.vtkhdf is gone: a new one begins after t = 0.004 s" in capsys.readouterr().err
    assert resume_coupled(again, ONE, "inprocess", True).result["status"] == "finished"
    assert read_frame(path)[0] == pytest.approx(0.02)


def test_an_older_checkpoint_is_taken_with_a_word(cut, capsys):
    (cut / "result.json").write_text("[]")
    new = unfinished(cut).last
    new.part("fluid").write_bytes(b"")
    with_old = unfinished(cut)
    assert with_old.last.window < new.window
    words = f"window-{new.window:010d} is damaged (fluid.h5): an older one is taken, t = {with_old.last.time:.4g} s"
    assert words in capsys.readouterr().err
    with_old.held.close()
    with_old.last.part("run").unlink()
    with pytest.raises(BadInput, match=r"fluid\.h5\); .* is damaged \(run\.h5\)\. Start it again with .*--out DIR"):
        unfinished(cut)


@pytest.mark.parametrize("name", ["probes.csv", "ledger.csv"])
def test_a_table_cut_short_is_gone_on_with_from_an_older_checkpoint(cut, capsys, name):
    (cut / "result.json").write_text("[]")
    new = unfinished(cut).last
    table = cut / name
    lines = table.read_text().splitlines(keepends=True)
    table.write_text("".join(lines[: {"probes.csv": new.notes["probe_rows"], "ledger.csv": new.window}[name]]))
    old = unfinished(cut).last
    assert old.window < new.window
    words = f"window-{new.window:010d} is newer than the end of {name}: an older one is taken, t = {old.time:.4g} s"
    assert words in capsys.readouterr().err
    table.write_text(lines[0])
    assert unfinished(cut).last.window == new.window, "whose lack is told of where the table is read"


def test_other_sources_differ_in_more_than_the_last_bits(cut, capsys, monkeypatch):
    (cut / "result.json").write_text("[]")
    monkeypatch.setattr("shared.run.results._sources", lambda: "other")
    unfinished(cut)
    assert "warning: results may differ: sources " in capsys.readouterr().err


@pytest.mark.parametrize(("lacking", "words"), [("wall_s", "does not fit this run"), ("notes", "is damaged")])
def test_a_checkpoint_of_another_version_says_so(cut, lacking, words):
    for path in cut.glob("checkpoints/*/manifest.json"):
        manifest = json.loads(path.read_text())
        kept = {name: value for name, value in manifest.items() if name not in ("sum", lacking)}
        manifest["notes"].pop(lacking, None)
        path.write_text(json.dumps(kept))
    with pytest.raises(BadInput, match=words):
        unfinished(cut)
