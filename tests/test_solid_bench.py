"""The structure's benchmark runs and says what it found."""

import pytest
from typer.testing import CliRunner

from solid_solver.bench import run_benchmark
from solid_solver.cli import app
from tests.benchmark_structures_measures import answer_time


@pytest.mark.parametrize("model", ["total-lagrangian", "beam"])
def test_the_rate_is_of_all_particles_and_whole_steps(model):
    found = run_benchmark(400, model, "linear", 1, 50)
    assert found["particle_steps_per_s"] == pytest.approx(50 * found["particles"] / found["wall_s"])
    assert found["bytes_per_particle"] >= 6 * 8  # position or displacement, velocity, acceleration


def test_the_command_prints_one_line():
    result = CliRunner().invoke(app, ["bench", "--particles", "400", "--steps", "20", "--threads", "1"])
    assert result.exit_code == 0
    assert "million particle-steps per second" in result.output


def test_the_beams_static_answer_takes_less_than_a_tenth_of_a_second():
    assert min(answer_time() for _ in range(3)) < 0.1
