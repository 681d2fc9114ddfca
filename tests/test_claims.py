"""Claims: one command at a time writes to a run, whatever happens to its scene, and on whatever file system."""

from __future__ import annotations

import errno
import fcntl
import os

import pytest

from shared.contract import BadInput
from shared.run import claims
from shared.run.claims import claim, is_claimed


def test_an_editor_that_saves_a_scene_does_not_free_its_run(tmp_path, monkeypatch):
    """Another file in the place of case.toml was free: a second command wrote to a run that went on."""
    monkeypatch.setattr(claims, "_PATIENCE_S", 0.2)
    (tmp_path / "case.toml").touch()
    with claim(tmp_path):
        (tmp_path / "saved").touch()
        (tmp_path / "saved").replace(tmp_path / "case.toml")
        assert is_claimed(tmp_path)
        with pytest.raises(BadInput, match="still going on"):
            claim(tmp_path)
    assert not is_claimed(tmp_path)


def network_lock(file, how):
    """NFS makes locks of byte ranges, for which a file has to be open for writing."""
    if not fcntl.fcntl(file, fcntl.F_GETFL) & (os.O_WRONLY | os.O_RDWR):
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))


def no_lock(file, how):
    raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))


@pytest.mark.parametrize(("lock", "warned"), [(network_lock, False), (no_lock, True)])
def test_a_run_begins_on_network_file_systems(tmp_path, monkeypatch, capsys, lock, warned):
    """Each waited for 20 s, and ended with the word that its run was still going on in another process."""
    monkeypatch.setattr(fcntl, "flock", lock)
    claim(tmp_path).close()
    assert not is_claimed(tmp_path)
    assert ("run.lock cannot be locked" in capsys.readouterr().err) == warned
