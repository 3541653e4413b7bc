"""Files appear whole or not at all, whatever their names."""

import os
from pathlib import Path

import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.exports import write_text
from moseg.workflows.process.atomic_write import atomic_path


def test_a_name_as_long_as_the_system_allows_is_written(tmp_path):
    path = tmp_path / ("n" * os.pathconf(tmp_path, "PC_NAME_MAX"))
    write_text(path, "all of it")
    assert path.read_text() == "all of it"
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def _write_half(path):
    path.write_text("ne")
    raise InputError("half way")


def test_a_failure_leaves_the_old_file_and_nothing_half_written(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("old")
    with pytest.raises(InputError, match="half way"), atomic_path(path) as temporary:
        _write_half(temporary)
    assert [entry.read_text() for entry in tmp_path.iterdir()] == ["old"]


def test_the_first_error_is_the_one_reported(tmp_path, monkeypatch):
    def refuse(self, missing_ok=False):
        raise PermissionError("cannot be removed")

    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(RuntimeError, match="half way"), atomic_path(tmp_path / "notes.txt"):
        raise RuntimeError("half way")
