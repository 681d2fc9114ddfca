"""Charts: fronts and slopes of known points; a small study run, drawn, and not run twice."""

from __future__ import annotations

import csv
from dataclasses import replace
from types import SimpleNamespace

import pytest

from coupler.chart import study as chart
from coupler.chart.files import COLUMNS, summary, write_chart
from coupler.chart.study import make_chart, pareto, slopes
from coupler.chart.truth import spread
from coupler.chart.variants import study_variants
from shared.contract import BadInput
from shared.scene.reading import shipped_cases
from tests.charts import loaded_beam


def point(cost, error, dx=1.0, series="one"):
    return SimpleNamespace(cost=cost, error=error, variant=SimpleNamespace(series=series, dx=dx))


def test_the_front_holds_what_nothing_beats_in_both():
    cheap, best, beaten, dear = point(1.0, 0.1), point(10.0, 0.01), point(12.0, 0.02), point(100.0, 0.005)
    assert pareto([beaten, dear, best, cheap]) == [cheap, best, dear]


def test_slope_and_order_of_a_second_order_method_whose_cost_grows_with_the_cube():
    points = [point(cost=dx**-3, error=dx**2, dx=dx) for dx in (0.1, 0.05, 0.025)]
    (found,) = slopes(points)
    assert found.order == pytest.approx(2.0)
    assert found.slope == pytest.approx(-2.0 / 3.0)
    assert found.at == pytest.approx(0.025**-3)
    assert slopes(points, 0.05**2)[0].at == pytest.approx(0.05**-3)


def test_a_series_of_one_spacing_has_no_slope():
    assert slopes([point(1.0, 0.1), point(2.0, 0.2)]) == []


STUDY = """
[study]
truth = "2-D elasticity"
sets = ["output.frames=1"]

[[study.families]]
name = "beam"
sets = ["solid.model=beam"]
vary = [[["solid.dx=6e-3"], ["solid.dx=3e-3"]]]

[[study.families]]
name = "torn"
sets = ["solid.model=beam", "solid.loads[0].traction=[0.0, -2e9]"]
"""


@pytest.fixture
def case(tmp_path):
    return loaded_beam(tmp_path, STUDY)


def test_a_chart_runs_once_says_what_is_enough_and_keeps_failures(case, tmp_path):
    said = []
    found = make_chart(case, (), tmp_path / "chart", 2, said.append)
    paths = write_chart(found, tmp_path / "chart", "coupler chart small")
    left = tmp_path / "chart" / "runs" / found.points[2].variant.folder
    assert summary(found)[-1].startswith("- Missing: torn, as it stands: failed, The beam failed at t =")
    assert summary(found)[-1].endswith(f"it is not run again unless {left} is removed.")
    torn = replace(found, front=[replace(found.points[2], error=0.021)])
    assert "- Least error on the front: torn, as it stands: 2.1 %." in summary(torn)
    assert found.smallest.variant.family == "beam"
    assert found.smallest.error < 1e-3
    assert [p.status for p in found.points] == ["finished", "finished", "failed"]
    assert all(p.expected.core_s > 0.0 for p in found.points)
    with paths[0].open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS
    assert rows[2]["error"] == ""
    assert "Smallest under the wanted 2 %: **beam**" in paths[1].read_text(encoding="utf-8")
    assert paths[2].stat().st_size > 10_000
    assert any(line.startswith("running") for line in said)

    said.clear()
    again = make_chart(case, (), tmp_path / "chart", 1, said.append)
    assert said == []
    assert [p.value for p in again.points] == [p.value for p in found.points]
    assert summary(again)[0] == summary(found)[0]


def test_a_chart_of_what_is_no_study_is_refused(case):
    with pytest.raises(BadInput, match=r"needs the table \[study\]"):
        study_variants("soft_plate")


def test_what_is_wrong_from_the_start_is_said_before_any_run(case, tmp_path, monkeypatch):
    monkeypatch.setattr(chart, "run_variants", None)
    with pytest.raises(BadInput, match=r"study\.truth = 'nobody': no reference .* there is '2-D elasticity'"):
        make_chart(case, ["study.truth=nobody"], tmp_path / "chart", 1, print)
    (tmp_path / "file").touch()
    with pytest.raises(BadInput, match=r"file/chart cannot be made .*--out DIR"):
        make_chart(case, (), tmp_path / "file" / "chart", 1, print)
    with pytest.raises(BadInput, match=r"study\.families\[0\]\.vary\[1\]: an axis without settings"):
        study_variants(case, ['study.families[0].vary=[[["solid.dx=6e-3"]], []]'])


def test_experiments_measured_as_curves_are_the_spread_where_the_finest_run_is_the_truth():
    """Fronts of a dam break over the interval of the first; those of other intervals say nothing about it."""
    scene = study_variants("dam_break")[0].scene
    found = spread(scene, 2.36, "finest run")
    assert set(found) == {"Martin & Moyce 1952, a = 2.25 in", "Martin & Moyce 1952, a = 1.125 in"}
    assert all(abs(value) < 0.05 for value in found.values())


def test_every_mistake_of_a_study_is_reported(case):
    with pytest.raises(BadInput) as error:
        study_variants(case, ['study.families[0].vary=[[["solid.dxx=1"], ["solid.dx=-1"]]]'])
    assert "solid.dxx" in str(error.value)
    assert "solid.dx = -1" in str(error.value)


def test_a_chart_taken_elsewhere_knows_its_runs(case, tmp_path):
    """A curve's place is nothing that a run depends on."""
    found = []
    for place in (tmp_path, tmp_path / "elsewhere"):
        place.mkdir(exist_ok=True)
        (place / "curve.csv").write_text("0.0,0.0\n1.0,1.0\n")
        scene = place / "small.toml"
        text = (tmp_path / "small.toml").read_text(encoding="utf-8")
        if place == tmp_path:
            text += '\n[[references]]\nprobe = "mid_y"\nname = "own"\ncurve = "curve.csv"\n'
        scene.write_text(text, encoding="utf-8")
        found.append([v.folder for v in study_variants(str(scene))])
    assert found[0] == found[1]


def test_a_family_of_any_name_has_folders(case):
    assert all(len(v.folder) < 120 for v in study_variants(case, [f"study.families[0].name={300 * 'x'}"]))


@pytest.mark.parametrize("name", [name for name, path in shipped_cases().items() if "[study]" in path.read_text()])
def test_shipped_studies_hold_valid_scenes_and_each_once(name):
    variants = study_variants(name)
    assert len({v.folder for v in variants}) == len(variants)
