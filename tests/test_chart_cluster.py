"""Charts on a Dask cluster: two worker processes here; variants, workers and schedulers that fail are told in words."""

from __future__ import annotations

import contextlib
import logging
import re
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from coupler.chart import cluster as chart_cluster
from coupler.chart.files import summary, write_chart
from coupler.chart.study import make_chart
from shared.contract import BadInput
from tests.charts import loaded_beam, wait_until

distributed = pytest.importorskip("distributed", reason="the extra `dask` is not installed")
psutil = pytest.importorskip("psutil")

pytestmark = pytest.mark.timeout(180)

FAMILY = """
[[study.families]]
name = "{}"
sets = ["solid.model=beam", "{}"]
"""
QUICK, COARSE = ("quick", "solid.dx=3e-3"), ("coarse", "solid.dx=6e-3")
TORN, ENDLESS = ("torn", "solid.loads[0].traction=[0.0, -2e9]"), ("endless", "end_time=1e5")


@pytest.fixture
def study(tmp_path):
    """Writes the loaded beam with a study of such families."""

    def write(*families):
        head = '[study]\ntruth = "2-D elasticity"\nsets = ["output.frames=1"]\n'
        return loaded_beam(tmp_path, head + "".join(FAMILY.format(*family) for family in families))

    return write


def local_cluster(workers):
    return distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=":0",
        silence_logs=logging.CRITICAL,
    )


@pytest.fixture(scope="module")
def cluster():
    import dask

    # A task is tried on one worker only: the variant whose worker is lost is lost, and does not take another with it.
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), local_cluster(2) as found:
        yield found


def worker_processes(cluster):
    return [psutil.Process(nanny.pid) for nanny in cluster.workers.values()]


def runs_below(process):
    """The processes that a worker has started, by the scenes that they run."""
    found = {}
    for child in process.children(recursive=True):
        with contextlib.suppress(psutil.Error, OSError):  # it has just ended
            found.setdefault((Path(child.cwd()) / "small.toml").read_text(encoding="utf-8"), []).append(child)
    return found


def test_two_workers_run_a_study_once_and_keep_failures(study, cluster, tmp_path):
    case, folder, said = study(QUICK, TORN, COARSE), tmp_path / "chart", []
    chart = make_chart(case, (), folder, 1, said.append, cluster.scheduler_address)
    assert [p.status for p in chart.points] == ["finished", "failed", "finished"]
    assert chart.smallest.error < 1e-3
    assert not any(p.alone for p in chart.points)
    assert any("times do not" in line for line in summary(chart))
    page = write_chart(chart, folder, "coupler chart small")[1].read_text(encoding="utf-8")
    assert f"~{chart.smallest.cost:.3g}" in page
    assert any("2 workers" in line for line in said)

    said.clear()
    again = make_chart(case, (), folder, 1, said.append, "tcp://nobody.asks:1")
    assert said == []
    assert [p.value for p in again.points] == [p.value for p in chart.points]


def test_a_lost_worker_loses_its_variant_alone(study, cluster, tmp_path):
    case, said = study(ENDLESS, QUICK, COARSE), []

    def say(line):
        said.append(line)
        if line.startswith("quick"):
            ((worker, run),) = (
                (worker, run)
                for worker in worker_processes(cluster)
                for scene, run in runs_below(worker).items()
                if "end_time = 100000.0" in scene
            )
            worker.kill()
            _, alive = psutil.wait_procs(run, timeout=30.0)
            assert alive == []  # the run has not outlived its worker

    chart = make_chart(case, (), tmp_path / "chart", 1, say, cluster.scheduler_address)
    assert [p.status for p in chart.points] == ["lost", "finished", "finished"]
    assert any("its worker was lost" in line for line in said)
    assert not (tmp_path / "chart" / "runs" / chart.points[0].variant.folder).exists()  # so that it is run again
    cluster.wait_for_workers(2, timeout=60)


@pytest.mark.slow
def test_an_interrupted_chart_ends_what_it_has_sent(study, cluster, tmp_path):
    case = study(ENDLESS, QUICK)
    workers = worker_processes(cluster)

    def say(line):
        if line.startswith("quick"):
            wait_until(lambda: any(map(runs_below, workers)))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_chart(case, (), tmp_path / "chart", 1, say, cluster.scheduler_address)
    wait_until(lambda: not any(map(runs_below, workers)))


def test_a_cluster_without_workers_is_given_up(study, tmp_path, monkeypatch):
    monkeypatch.setattr(chart_cluster, "WORKER_WITHIN_S", 0.5)
    said = []
    with local_cluster(0) as empty:
        chart = make_chart(study(QUICK), (), tmp_path / "chart", 1, said.append, empty.scheduler_address)
    assert [p.status for p in chart.points] == ["lost"]
    assert any("has had no worker for 0.5 s" in line for line in said)
    assert "No variant reaches" in write_chart(chart, tmp_path, "coupler chart small")[1].read_text(encoding="utf-8")


def test_what_is_no_scheduler_is_refused_in_words_and_in_time(study, cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(chart_cluster, "ANSWER_WITHIN_S", 0.5)
    worker = next(iter(cluster.scheduler.workers))
    with socket.create_server(("127.0.0.1", 0)) as silent:
        mute = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        for address, why in (
            ("tcp://127.0.0.1:9", "nothing came back"),
            (mute, "nothing came back"),
            (worker, "a Worker is there"),
            ("nonsense://here", "unknown address scheme"),
        ):
            asked = time.monotonic()
            with pytest.raises(BadInput, match=rf"no Dask scheduler answered there within 0\.5 s \({why}"):
                make_chart(study(QUICK), (), tmp_path / "chart", 1, print, address)
            assert time.monotonic() - asked < 5.0


def test_a_scheduler_that_dies_is_told_in_words_alone(study, tmp_path, capfd):
    """A process of its own: it is killed."""
    words = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    scheduler = subprocess.Popen([*words, "--no-dashboard"], stderr=subprocess.PIPE, text=True)
    address = next(found[0] for line in scheduler.stderr if (found := re.search(r"tcp://127\.0\.0\.1:\d+", line)))
    said = []

    def say(line):
        said.append(line)
        if line.startswith("sent"):
            scheduler.kill()

    make_chart(study(QUICK), (), tmp_path / "chart", 1, say, address)
    scheduler.communicate()
    assert said[-1] == "  lost the scheduler dropped it or is gone"
    assert "Traceback" not in capfd.readouterr().err


def test_without_dask_the_extra_is_named(study, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(BadInput, match=r"shearwater-fsi\[dask\]"):
        make_chart(study(QUICK), (), tmp_path / "chart", 1, print, "tcp://127.0.0.1:9")
