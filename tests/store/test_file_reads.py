"""Reading an artifact's files: what is lost is damage, what another process replaces meanwhile is not."""

import os

import pytest

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.store.local.files import read_file, read_parts
from moseg.store.packing import Range

REF = "frame/" + "0" * 64


def _whole(folder):
    return read_file(str(folder), "pack", REF)


def _part(folder):
    return read_parts(str(folder), "pack", REF, 3, {"all": Range(0, 3)})["all"]


READS = pytest.mark.parametrize("read", [_whole, _part])


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "artifact"
    path.mkdir()
    (path / "pack").write_bytes(b"abc")
    return path


def _before_the_look_at_the_folder(monkeypatch, act):
    """Let another process act between the look at a file that is not there and that at its folder."""
    look = os.path.lexists

    def acted(path):
        act()
        return look(path)

    monkeypatch.setattr(os.path, "lexists", acted)


@READS
def test_an_artifact_that_is_committed_again_meanwhile_is_read(folder, tmp_path, monkeypatch, read):
    aside = tmp_path / "aside"
    folder.rename(aside)
    _before_the_look_at_the_folder(monkeypatch, lambda: aside.exists() and aside.rename(folder))
    assert read(folder) == b"abc"


@READS
def test_an_artifact_that_is_taken_away_meanwhile_is_missing(folder, tmp_path, monkeypatch, read):
    aside = tmp_path / "aside"
    (folder / "pack").rename(folder / "other")
    _before_the_look_at_the_folder(monkeypatch, lambda: folder.rename(aside))
    with pytest.raises(MissingArtifactError):
        read(folder)


@READS
def test_a_lost_file_is_damage(folder, read):
    (folder / "pack").unlink()
    with pytest.raises(CorruptArtifactError, match="No such file"):
        read(folder)
