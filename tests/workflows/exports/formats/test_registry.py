"""Formats are chosen by name, write whole files, and touch no foreign file."""

import json
import uuid

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.cli.export import OWN_FORMATS
from moseg.workflows.exports.formats import FORMATS, check_exports, choose_formats, export
from moseg.workflows.exports.formats.reconstruction_sets import SETS
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.sources import ImageFiles

FOLDERS = {"davis": "davis/dog walk", "colmap": "colmap", "nerfstudio": "nerfstudio", "instant-ngp": "instant-ngp"}


def visible(folder):
    return sorted(path.name for path in folder.iterdir() if not path.name.startswith("."))


def test_the_command_line_names_every_format():
    assert list(FORMATS) == list(OWN_FORMATS)


def test_every_format_writes_into_another_folder_and_none_disturbs_another(write_saved, tmp_path):
    frames = tuple(f"{index}.png" for index in range(4))
    saved = write_saved(frames=frames)
    (tmp_path / "frames").mkdir()
    paths = tuple(str(tmp_path / "frames" / name) for name in frames)
    for path in paths:
        Image.new("RGB", (saved.summary.width, saved.summary.height)).save(path)
    saved = saved.from_video(FrameOrigin(str(tmp_path / "frames"), ImageFiles(paths, 1000)))
    formats = [*FORMATS.values(), *SETS.values()]
    for _ in range(2):
        written = export(saved, formats, tmp_path / "there")
        assert len({*written}) == len(formats)
        assert all(path.exists() for path in written)
    assert visible(saved.folder) == ["masks", "motion.json"]
    assert len(visible(tmp_path / "there")) == len(formats)


@pytest.mark.parametrize(
    ("names", "dilation", "message"),
    [
        (["colmpa"], None, "unknown export format 'colmpa': did you mean 'colmap'"),
        (["coco", "npz"], 3, "nothing to dilate in --dilate; got coco, npz; expected one of colmap or"),
    ],
)
def test_a_wrong_choice_is_named(names, dilation, message):
    with pytest.raises(InputError, match=message):
        choose_formats(names, dilation)


def test_a_format_that_cannot_hold_the_frames_is_refused_before_the_work():
    assert [entry.name for entry in choose_formats(["coco", "dynaslam", "coco"])] == ["coco", "dynaslam"]
    with pytest.raises(InputError, match="not a PNG file"):
        choose_formats(["dynaslam"], frames=("0.jpg",))


@pytest.mark.parametrize("name", FOLDERS)
def test_a_shorter_export_removes_the_masks_of_a_longer_one_and_nothing_else(write_saved, volume, name):
    saved = write_saved()
    folder = FORMATS[name].write(saved, saved.folder, None)
    (folder / "mine.png").write_bytes(b"kept")
    four = visible(folder)
    saved = write_saved(labels=volume[:1])
    assert FORMATS[name].write(saved, saved.folder, None) == folder
    assert visible(folder) == sorted([four[0], "mine.png"])


@pytest.mark.parametrize("name", FOLDERS)
def test_files_that_no_export_wrote_are_never_overwritten(saved, tmp_path, name):
    folder = FORMATS[name].write(saved, saved.folder, None)
    theirs = tmp_path / "there" / FOLDERS[name] / visible(folder)[-1]
    theirs.parent.mkdir(parents=True)
    theirs.write_bytes(b"annotated by hand")
    with pytest.raises(InputError, match=r"a file not known as moseg's own in .*; expected another output folder"):
        FORMATS[name].write(saved, tmp_path / "there", None)
    assert [path.read_bytes() for path in theirs.parent.iterdir()] == [b"annotated by hand"]


def test_files_of_a_killed_export_are_replaced(saved, monkeypatch):
    labels = saved.labels

    def killed(self):
        yield next(labels())
        raise KeyboardInterrupt

    monkeypatch.setattr(type(saved), "labels", killed)
    with pytest.raises(KeyboardInterrupt):
        FORMATS["colmap"].write(saved, saved.folder, None)
    monkeypatch.undo()
    folder = saved.folder / "colmap"
    assert visible(folder) == ["a 1.jpg.png"]
    (folder / f".{uuid.uuid4().hex}.part").write_bytes(b"half")
    FORMATS["colmap"].write(saved, saved.folder, None)
    assert sorted(path.name for path in folder.iterdir()) == [
        ".moseg-export.json",
        "a 1.jpg.png",
        "b.png.png",
        "größe.JPG.png",
        "犬.webp.png",
    ]


@pytest.mark.parametrize("name", ["coco", "ytvis", "npz"])
def test_a_failure_keeps_the_old_file(saved, monkeypatch, name):
    path = FORMATS[name].write(saved, saved.folder, None)
    old = path.read_bytes()
    (saved.folder / "masks" / "00002.png").write_bytes(b"damaged")
    with pytest.raises(InputError, match=r"mask cannot be decoded in .*00002\.png"):
        FORMATS[name].write(saved, saved.folder, None)
    assert path.read_bytes() == old
    assert visible(saved.folder) == sorted(["masks", "motion.json", path.name])


def test_frames_that_differ_in_their_suffix_alone_cannot_share_a_mask(write_saved):
    saved = write_saved(frames=("a.png", "a.jpg", "b.png", "c.png"))
    with pytest.raises(InputError, match=r"two frames of one name in .*nerfstudio; got a\.png"):
        FORMATS["nerfstudio"].write(saved, saved.folder, None)


def _foreign_npz(path):
    np.savez(path, labels=np.zeros((2, 3, 4), np.uint16), identities=np.ones(1, np.uint16))


def _saved_anew(path):
    content = json.loads(path.read_text())
    path.write_text(json.dumps(content, indent=1))


@pytest.mark.parametrize(
    ("name", "file"), [("coco", "coco.json"), ("ytvis", "ytvis.json"), ("npz", "dog walk.npz"), ("colmap", "colmap")]
)
def test_a_foreign_file_stops_every_format_before_the_first_is_written(saved, tmp_path, name, file):
    there = tmp_path / "there"
    there.mkdir()
    if name == "npz":
        _foreign_npz(there / file)
    else:
        (there / file).write_text('{"info": {}, "images": []}')
    before = (there / file).read_bytes()
    formats = choose_formats(["nerfstudio", name])
    words = "not known as moseg's own" if name != "colmap" else "colmap"
    for attempt in (
        lambda: check_exports(formats, there, saved.summary.name, saved.names),
        lambda: export(saved, formats, there),
        lambda: FORMATS[name].write(saved, there, None),
    ):
        with pytest.raises(InputError, match=words):
            attempt()
    assert visible(there) == [file]
    assert (there / file).read_bytes() == before


@pytest.mark.parametrize(("name", "change"), [("coco", _saved_anew), ("ytvis", _saved_anew), ("npz", _foreign_npz)])
def test_an_edited_export_is_not_replaced(saved, name, change):
    path = FORMATS[name].write(saved, saved.folder, None)
    assert FORMATS[name].write(saved, saved.folder, None) == path
    change(path)
    before = path.read_bytes()
    with pytest.raises(InputError, match="a file not known as moseg's own"):
        FORMATS[name].write(saved, saved.folder, None)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("sequence", "names", "message"),
    [
        ("n" * 252, ("0.png",), "cannot write .*File name too long"),
        ("", ("0.png",), "not a name of a sequence"),
        ("dog", ("a.png", "a.jpg"), r"two frames of one name .*a\.png"),
    ],
)
def test_names_that_cannot_be_written_are_reported_before_the_work(tmp_path, sequence, names, message):
    with pytest.raises(InputError, match=message):
        check_exports(choose_formats(["npz", "nerfstudio"]), tmp_path, sequence, names)
    assert not list(tmp_path.iterdir())
