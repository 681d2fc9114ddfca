"""Room for compiled code."""

from __future__ import annotations

import resource

import numba
import pytest

from shared import warm
from shared.contract import ShearwaterError
from shared.scene.reading import load_scene
from shared.warm import fill_cache, stamp


def test_a_full_disk_of_the_cache_is_told_from_that_of_the_run(tmp_path, monkeypatch):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(ShearwaterError, match=r"no room for compiled code in .*cache.*NUMBA_CACHE_DIR"):
            fill_cache({"solid": "solid_solver"}, tmp_path / "case.toml", load_scene("udl_beam"))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_the_same_program_installed_twice_compiles_for_each(monkeypatch):
    """What the first has compiled numba does not find for the second, whose first run would compile as it steps."""
    scene = load_scene("udl_beam")
    here = stamp(scene, "solid")
    monkeypatch.setattr(warm, "_PLACE", "elsewhere")
    assert stamp(scene, "solid") != here
