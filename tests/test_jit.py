"""The cache of compiled code is renewed by an edit that can change it, and by no other."""

from __future__ import annotations

import shutil
from pathlib import Path

import numba
import pytest

from shared.jit import source_digest, use_threads

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture
def sources(tmp_path):
    for package in ("shared", "fluid_solver", "solid_solver"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


@pytest.mark.parametrize(
    ("file", "renewed"),
    [
        ("shared/jit.py", True),
        ("shared/kernels.py", True),  # called by kernels of both solvers
        ("fluid_solver/terms.py", True),
        ("solid_solver/blocks.py", True),  # compiles nothing, imported by a module that does
        ("shared/solver_cli.py", False),
        ("shared/link_zenoh.py", False),
    ],
)
def test_an_edit_renews_the_cache_where_it_matters(sources, file, renewed):
    before = source_digest(sources)
    path = sources / file
    path.write_text(path.read_text() + "\nMORE = 1.0\n")
    assert (source_digest(sources) != before) == renewed


def test_more_threads_than_cores_are_one_for_each():
    use_threads(10_000)
    assert numba.get_num_threads() == numba.config.NUMBA_NUM_THREADS
