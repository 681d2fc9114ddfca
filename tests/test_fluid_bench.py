"""The fluid's benchmark times what it says."""

import pytest
from typer.testing import CliRunner

from fluid_solver.bench import profile, run_benchmark
from fluid_solver.cli import app


@pytest.mark.timeout(120)
def test_benchmark_counts_walls_and_scales_its_figures():
    found = run_benchmark(1000, "wcsph", 1)
    assert found["particles"] > found["fluid_particles"] > 900
    assert found["particle_steps_per_s"] == pytest.approx(found["steps"] * found["particles"] / found["wall_s"])
    core_per_step = found["core_s"] / (found["steps"] * found["particles"])
    steps_per_interval = found["interval_s"] / core_per_step  # dx/c0 over the step
    assert 0.3 < steps_per_interval < 2.0
    assert found["bytes_per_particle"] > 18 * 8 * 2  # two copies of the state at least


@pytest.mark.timeout(120)
def test_benchmark_prints_a_row_for_every_choice_and_the_machine():
    arguments = ["bench", "--model", "wcsph", "--particles", "1000", "--particles", "1200", "--threads", "1"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert result.output.count("wcsph") == 3  # two rows, and the profile's heading
    assert "GFLOP/s" in result.output


@pytest.mark.timeout(120)
def test_profile_adds_up_to_the_step():
    rows = profile(2000, "wcsph")
    assert sum(row["share"] for row in rows) == pytest.approx(1.0)
    assert all(row["ns"] > 0.0 for row in rows)
    assert 21 < rows[0]["candidates"] < 80  # all that lie within the support are among them
