"""One side alone goes through what a recorded run told it, to the same bytes."""

from __future__ import annotations

import json
import os

import pytest

import coupler.run
import fluid_solver.models
import solid_solver.models
from coupler.run import resume_coupled, run_coupled
from shared.contract import BadInput, ParticipantLost
from shared.run.recording import Recorder, messages, recording_of
from shared.run.resume import unfinished
from shared.scene.reading import load_scene
from shared.solo import replay_alone
from tests.scenes import tiny_coupled
from tests.test_resume import ONE, cut_short, same_frames

FACTORIES = {"fluid": fluid_solver.models.make_model, "solid": solid_solver.models.make_model}
SETS = ["output.exchange=true", "output.frames=7", "output.probe_interval=1e-3", "output.checkpoint_every=1e-9"]
pytestmark = pytest.mark.timeout(240)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A coupled run with implicit windows, and its scene."""
    folder = tmp_path_factory.mktemp("recorded")
    scene = load_scene(tiny_coupled(folder, end_time=0.01), [*SETS, "coupling.scheme=serial-implicit"])
    run_coupled(scene, "tiny", folder / "run", ONE, True, "inprocess")
    return folder / "run", scene


@pytest.mark.parametrize("side", ["fluid", "solid"])
def test_the_same_bytes_without_the_partner(recorded, side, tmp_path):
    run_dir, scene = recorded
    found = replay_alone(scene, "tiny", side, FACTORIES[side], tmp_path / "run", 1, True, run_dir).result
    same_frames(tmp_path / "run" / f"{side}.vtkhdf", run_dir / f"{side}.vtkhdf")
    assert found["t_end"] == pytest.approx(0.01)
    columns = [line.split(",") for line in (run_dir / "probes.csv").read_text().splitlines()]
    own = (tmp_path / "run" / "probes.csv").read_text().splitlines()
    chosen = [columns[0].index(name) for name in own[0].split(",")]
    assert own == [",".join(row[k] for k in chosen) for row in columns]


def test_a_run_that_was_cut_short_has_the_same_recording(recorded, tmp_path, monkeypatch):
    run_dir, scene = recorded
    given = (scene, "tiny", tmp_path / "run", ONE, True, "inprocess")
    cut_short(monkeypatch, coupler.run, "probes", 4, run_coupled, *given)
    resume_coupled(unfinished(tmp_path / "run"), ONE, "inprocess", True)
    for side in ("fluid", "solid"):
        assert recording_of(tmp_path / "run", side).read_bytes() == recording_of(run_dir, side).read_bytes()


def test_a_recording_that_ends_too_soon_says_when(recorded, tmp_path):
    run_dir, scene = recorded
    whole = recording_of(run_dir, "fluid").read_bytes()
    (tmp_path / "fluid.exchange").write_bytes(whole[: len(whole) * 2 // 3])
    with pytest.raises(ParticipantLost, match=r"ends at t = 0\.00\d+ s of end_time = 0\.01 s"):
        replay_alone(scene, "tiny", "fluid", FACTORIES["fluid"], tmp_path / "run", 1, True, tmp_path)
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert (result["status"], 0.0 < result["t_end"] < 0.01) == ("lost", True)
    assert "ends at t" in result["reason"]


def test_a_recording_that_another_program_took_is_told_of(tmp_path, capsys):
    """It was not: the run had finished, with zeros where its messages had been."""
    for harm in (lambda path: path.unlink(), lambda path: os.truncate(path, 30), None):
        recorder = Recorder(path := tmp_path / f"{harm}.exchange")
        recorder.add("describe")
        recorder.flush()
        if harm is not None:
            harm(path)
        recorder.add("start")
        recorder.close()
        said = capsys.readouterr().err
        assert said.startswith(f"warning: {path} holds ") if harm is not None else said == ""
        assert not path.exists() or bytes(30) not in path.read_bytes()


def test_what_cannot_be_replayed(recorded, tmp_path):
    run_dir, scene = recorded
    with pytest.raises(BadInput, match=r"output\.exchange=true"):
        list(messages(recording_of(tmp_path, "fluid")))
    (tmp_path / "fluid.exchange").write_bytes(b"")
    with pytest.raises(BadInput, match="is empty"):
        replay_alone(scene, "tiny", "fluid", FACTORIES["fluid"], tmp_path / "a", 1, True, tmp_path)
    other = load_scene(run_dir / "case.toml", ["fluid.dx=5e-3"])
    with pytest.raises(BadInput, match="does not fit this scene"):
        replay_alone(other, "tiny", "fluid", FACTORIES["fluid"], tmp_path / "b", 1, True, run_dir)


def test_a_replay_beyond_its_recording_is_refused_before_it_begins(recorded, tmp_path):
    run_dir, _ = recorded
    longer = load_scene(run_dir / "case.toml", ["end_time=0.02"])
    with pytest.raises(BadInput, match=r"a run to end_time = 0\.01 s; end_time = 0\.02 s is beyond it"):
        replay_alone(longer, "tiny", "fluid", FACTORIES["fluid"], tmp_path / "run", 1, True, run_dir)
    assert not (tmp_path / "run").exists()


def test_a_scene_without_the_side_cannot_be_replayed(tmp_path):
    with pytest.raises(BadInput, match=r"no \[solid\] table: run it with fluid-solver"):
        replay_alone(load_scene("dam_break"), "dam_break", "solid", FACTORIES["solid"], tmp_path, 1, True, tmp_path)


@pytest.mark.parametrize("place", [3, 9, 14, 20, 0.5])
def test_a_changed_byte_is_told_from_a_cut(recorded, tmp_path, place):
    """In the length, in the sums, in the first message, and in the middle of the loads."""
    data = bytearray(recording_of(recorded[0], "solid").read_bytes())
    data[place if isinstance(place, int) else int(place * len(data))] ^= 0x10
    (tmp_path / "spoiled").write_bytes(data)
    with pytest.raises(BadInput, match=r"spoiled is damaged in the message at byte \d+"):
        list(messages(tmp_path / "spoiled"))


def test_a_recording_cut_short_ends_with_its_last_whole_message(recorded, tmp_path):
    path = recording_of(recorded[0], "solid")
    whole = list(messages(path))
    (tmp_path / "cut").write_bytes(path.read_bytes()[:-5])
    assert list(messages(tmp_path / "cut")) == whole[:-1]
