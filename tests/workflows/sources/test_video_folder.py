"""Which entries of a folder are videos."""

from pathlib import Path

import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.sources.video_folder import VIDEO_SUFFIXES, list_videos

INPUTS = Path(__file__).resolve().parents[3] / "docs" / "inputs.md"


def test_files_of_cameras_and_folders_of_images_are_videos_and_nothing_else_is(tmp_path):
    videos = ["00001.MTS", "a.m2ts", "b.TS", "c.mp4", "d.3gp", "e.mxf"]
    for name in [*videos, "notes.txt", ".hidden.mp4", "sound.wav", "cover.gif"]:
        (tmp_path / name).touch()
    for name in ("frames/0.png", "documents/text.txt"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).touch()
    assert [Path(path).name for path in list_videos(str(tmp_path))] == sorted([*videos, "frames"])


def test_a_folder_without_a_video_is_refused_with_the_suffixes(tmp_path):
    (tmp_path / "cover.gif").touch()
    with pytest.raises(InputError, match=r"no videos.*\.mp4.*\.y4m"):
        list_videos(str(tmp_path))
    assert list_videos(str(tmp_path), is_required=False) == ()


def test_the_docs_name_every_suffix():
    text = INPUTS.read_text(encoding="utf-8")
    assert [suffix for suffix in VIDEO_SUFFIXES if f"`{suffix}`" not in text] == []
