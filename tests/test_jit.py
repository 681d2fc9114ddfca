"""The cache of compiled code is renewed by an edit that can change it, and by no other."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

import numba
import pytest

from shared.jit import cache_folder, source_digest, use_threads

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
        ("shared/geometry/regions.py", True),  # likewise, in a package of its own
        ("shared/solver_cli.py", False),
        ("shared/link_zenoh.py", False),
    ],
)
def test_an_edit_renews_the_cache_where_it_matters(sources, file, renewed):
    before = source_digest(sources)
    path = sources / file
    path.write_text(path.read_text() + "\nMORE = 1.0\n")
    assert (source_digest(sources) != before) == renewed


def test_a_place_that_cannot_be_written_is_replaced_and_told_of(tmp_path, monkeypatch, capsys):
    """Numba would keep compiled code among the sources, where an edit of a callee goes unseen, or end with an error."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "cache"))
    found = cache_folder("digest")
    assert found == tmp_path / f"shearwater-{os.getuid()}" / "digest" == Path(os.environ["NUMBA_CACHE_DIR"])
    assert f"warning: compiled code is kept in {found}, for its own place cannot" in capsys.readouterr().err
    assert cache_folder("digest") == found  # of a process that this one starts
    assert capsys.readouterr().err == ""


def test_what_others_have_compiled_is_not_run(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/dev/null/cache")
    monkeypatch.setattr(os, "getuid", lambda: 4242)
    (tmp_path / "shearwater-4242").mkdir()
    with pytest.raises(PermissionError, match="another user's"):
        cache_folder("digest")


def test_more_threads_than_cores_are_one_for_each():
    use_threads(10_000)
    assert numba.get_num_threads() == numba.config.NUMBA_NUM_THREADS
