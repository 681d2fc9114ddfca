"""Mistakes in a stability map are named before its runs, or at the first that shows them; what has been run is kept."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from coupler.stability import boundaries as stability
from coupler.stability import runs
from coupler.stability.boundaries import find_boundaries
from coupler.stability.check import _of_scene, check_map
from coupler.stability.kept import remembered
from coupler.stability.map import VOCABULARY, load_map
from coupler.stability.reference import reference_file, renewed
from coupler.stability.runs import DIED_OUT, FAILED, growth_of, measure, rise_of
from coupler.stability.theory import THEORIES
from shared.contract import BadInput, SolverFailed
from shared.scene.reading import load_scene

MAP = """
schema = 1
title = "Courant number"
case = "still_tank"
criterion = { measure = "rise", probe = "kinetic_energy", limit = 0.5 }
sets = ["references=[]", "output.frames=1", "end_time=0.02", "output.probe_interval=0.005", "output.average_from=0.0"]

[x]
name = "h/dx"
values = [1.3]
scales = [{ path = "fluid.h_over_dx" }]

[y]
name = "C"
range = [0.5, 1.0]
tolerance = 0.5
scales = [{ path = "fluid.courant" }]

[[methods]]
name = "wcsph"
"""
CRITERION = re.search("criterion.*", MAP)[0]


@pytest.fixture
def written(tmp_path):
    """A map's file, a text in it replaced by another."""

    def write(old, new):
        assert old in MAP
        path = tmp_path / "map.toml"
        path.write_text(MAP.replace(old, new), encoding="utf-8")
        return str(path)

    return write


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (CRITERION, CRITERION.replace("0.5", "0.0"), "criterion: limit = 0: must be above 0 for the measure rise"),
        (CRITERION, 'criterion = { measure = "iterations" }', "must be above 1 for the measure iterations"),
        ("limit = 0.5", 'limit = 0.5, statistic = "meen"', "did you mean 'mean'?"),
        (
            CRITERION,
            'criterion = { measure = "deviation", probe = "kinetic_energy", value = 0.0, limit = 0.1 }',
            "value = 0: nothing is a relative deviation from zero",
        ),
        ("[0.5, 1.0]", "[0.5, 0.5]", "range = [0.5, 0.5]: both ends are the same"),
        ("[1.3]", "[-1.3]", "x.values = [-1.3]: must be a list of number > 0, at least 1"),
        ("[1.3]", '"1.3"', 'x.values = "1.3": must be a list of number > 0, at least 1'),
        (CRITERION, "criterion = 3", "criterion = 3: must be { measure, limit, probe, statistic, value, reference }"),
        ("tolerance = 0.5", "tolerence = 0.5", "y.tolerence: unknown key; did you mean 'tolerance'?"),
        ("title =", "titel =", "titel: unknown key; did you mean 'title'?"),
        ("schema = 1", "schema = ", "not TOML"),
    ],
)
def test_the_vocabulary_refuses(written, old, new, words):
    with pytest.raises(BadInput, match=re.escape(words)):
        load_map(written(old, new))


def test_a_case_is_looked_for_beside_its_map(written, tmp_path, monkeypatch):
    (tmp_path / "own.toml").write_text("", encoding="utf-8")
    (tmp_path / "else").mkdir()
    monkeypatch.chdir(tmp_path / "else")
    assert load_map(written("still_tank", "own.toml")).case == str(tmp_path / "own.toml")
    assert load_map(written("still_tank", "still_tank")).case == "still_tank"
    with pytest.raises(BadInput, match=re.escape(f"{tmp_path / 'still_tnk'}: no such file or shipped case; did you")):
        check_map(load_map(written("still_tank", "still_tnk")))


def test_a_file_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "map.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(BadInput, match="cannot be read"):
        load_map(str(tmp_path / "map.toml"))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("kinetic_energy", "kinetic_enrgy", "no such probe; did you mean 'kinetic_energy'"),
        (CRITERION, 'criterion = { measure = "iterations", limit = 9.5 }', "has a fluid alone, and nothing to iterate"),
        (
            "title",
            'rule = "Courant"\ntitle',
            "'Courant': not one of pre-flight's here; did you mean 'Courant, fluid'?",
        ),
        ("fluid.h_over_dx", "fluid.hoverdx", "fluid.hoverdx: unknown key"),
        ("[0.5, 1.0]", "[0.5, 1e9]", "fluid.courant = 1000000000.0: must be"),
        ('"fluid.h_over_dx"', '"fluid.h_over_dx", power = 1e12', "fluid.h_over_dx = Infinity: must be"),
    ],
)
def test_mistakes_of_the_cells_are_named_before_any_run(written, tmp_path, monkeypatch, old, new, words):
    monkeypatch.setattr(stability, "remembered", None)  # what every run goes through
    with pytest.raises(BadInput, match=re.escape(words)):
        find_boundaries(load_map(written(old, new)), tmp_path / "out", print)


def test_theory_looks_for_no_more_roots_than_it_can_find():
    scene = load_scene("light_gate", ["fluid.model=column", "fluid.column.reflection=1.0"])
    assert THEORIES["lagged-column"](scene, 1e-12) is None


def test_a_theory_of_water_is_none_of_a_beam(written):
    given = load_map(written("title", 'theory = "lattice-waves"\ntitle'))
    said = list(_of_scene(given, given.methods[0], 1.3, load_scene("udl_beam")))
    assert any(one.startswith("theory = 'lattice-waves': not one of") for one in said)


def test_a_place_that_cannot_be_written_is_named_before_any_run(written, tmp_path, monkeypatch):
    monkeypatch.setattr(stability, "remembered", None)
    (tmp_path / "file").touch()
    with pytest.raises(BadInput, match=r"file/out cannot be made .*--out DIR"):
        find_boundaries(load_map(written("wcsph", "one")), tmp_path / "file" / "out", print)


@pytest.mark.parametrize(
    ("criterion", "words"),
    [
        ('{ measure = "rise", probe = "leaked", limit = 0.1 }', "zero throughout"),
        ('{ measure = "growth", probe = "kinetic_energy" }', "four rows of probes"),
        (
            '{ measure = "deviation", probe = "kinetic_energy", value = 1.0, limit = 1.0, statistic = "period" }',
            "no such",
        ),
    ],
)
def test_nothing_to_measure_in_a_good_run_is_no_boundary(written, tmp_path, criterion, words):
    given = load_map(written(CRITERION, f"criterion = {criterion}"))
    coarse = [*given.sets, "fluid.dx=0.1", "output.probe_interval=0.01"]
    with pytest.raises(BadInput, match=rf"nothing to measure .*wcsph, h/dx = 1\.3, C = 0\.5.*{words}"):
        find_boundaries(given.model_copy(update={"sets": coarse}), tmp_path / "out", print)


def test_measures_of_nothing_are_not_numbers():
    assert math.isnan(rise_of(np.zeros(5)))
    assert math.isnan(growth_of([1.0, 2.0, 3.0]))
    assert math.isnan(growth_of([1.0, -1.0] * 4))
    assert growth_of(np.zeros(8)) == DIED_OUT
    assert growth_of([0.0] * 6 + [1.0, 1.0]) == FAILED
    assert growth_of([0.0, *[2.0] * 7]) == 0.0  # a swing that starts from nothing has not grown without end


def test_runs_are_kept_and_not_made_again(written, tmp_path, monkeypatch):
    made, middle = [], math.sqrt(0.5)

    def counted(scene, criterion):
        made.append(scene.fluid.courant)
        if len(made) == 2:
            raise KeyboardInterrupt
        return 0.1 if scene.fluid.courant < 0.7 else 2.0

    monkeypatch.setattr(stability, "measure", counted)
    given = load_map(written("wcsph", "one"))
    with pytest.raises(KeyboardInterrupt):
        find_boundaries(given, tmp_path, print)
    with (tmp_path / "runs.jsonl").open("a") as file:
        file.write('{"cell": "cut sho')
    (found,) = find_boundaries(given, tmp_path, print)
    assert made == [0.5, 1.0, 1.0, middle]
    assert found.tried == ((0.5, 0.1), (middle, 2.0), (1.0, 2.0))
    find_boundaries(given, tmp_path, print)
    looser = given.criterion.model_copy(update={"limit": 3.0})
    (none,) = find_boundaries(given.model_copy(update={"criterion": looser}), tmp_path, print)
    assert none.found is None
    assert len(made) == 4
    find_boundaries(given.model_copy(update={"sets": [*given.sets, "fluid.alpha=0.2"]}), tmp_path, print)
    assert len(made) == 7


def test_what_is_not_finite_is_kept_as_it_is(written, tmp_path):
    given = load_map(written("wcsph", "one"))
    for value in (math.inf, -math.inf, None):
        folder = tmp_path / str(value)
        folder.mkdir()
        scene = stability.cell_scene(given, given.methods[0], 1.3, 0.5)
        remembered(folder / "runs")(lambda scene, criterion, value=value: value, scene, given.criterion)
        assert remembered(folder / "runs")(lambda scene, criterion: 1 / 0, scene, given.criterion) == value


def test_what_the_machine_ends_is_no_bad_run(written, tmp_path, monkeypatch):
    """A full disk made a boundary, and was remembered as one."""

    def no_space(scene):
        raise SolverFailed("frames cannot be written ([Errno 28] No space left on device)")

    monkeypatch.setattr(runs, "_watch", no_space)
    with pytest.raises(SolverFailed, match="No space"):
        find_boundaries(load_map(written("wcsph", "one")), tmp_path / "out", print)
    assert not (tmp_path / "out" / "runs.jsonl").exists()


def test_a_reference_whose_run_fails_is_told_of_as_such(written, tmp_path, monkeypatch):
    """It ended the map with the words of the run alone, as if a cell had no right to fail."""

    def failing(scene):
        raise SolverFailed("the fluid diverged")

    monkeypatch.setattr(runs, "_watch", failing)
    criterion = 'criterion = { measure = "deviation", probe = "kinetic_energy", limit = 0.1, reference = 0.7 }'
    with pytest.raises(BadInput, match=r"criterion\.reference = 0\.7: .*take one that is good\. the fluid diverged"):
        find_boundaries(load_map(written(CRITERION, criterion)), tmp_path / "map", print)


def test_the_vocabulary_is_documented_as_it_is_and_its_example_holds(tmp_path):
    text = reference_file().read_text(encoding="utf-8")
    assert text == renewed(text), "python -m coupler.stability.reference renews it"
    assert str(reference_file()).endswith(VOCABULARY)
    path = tmp_path / "example.toml"
    path.write_text(text.partition("```toml\n")[2].partition("```")[0], encoding="utf-8")
    given = load_map(str(path))
    check_map(given)
    scene = stability.cell_scene(given, given.methods[0], 0.4, 1.0)
    assert measure(scene, given.criterion) < 0.0
