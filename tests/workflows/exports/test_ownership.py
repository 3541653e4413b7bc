"""Files of moseg are recognised by their mark; the same files saved by another program are not."""

import json

import av
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.exports import summarise_sequence, write_masks, write_motion, write_overlay
from moseg.workflows.exports.outputs import check_outputs
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.ownership import OwnedFile, is_own_archive, is_own_mask, is_own_overlay, is_own_summary

LABELS = np.zeros((3, 32, 48), np.uint16)
LABELS[:, 8:20, 8:30] = 1
IMAGES = np.full((3, 32, 48, 3), 90, np.uint8)


@pytest.fixture
def out(tmp_path):
    """A folder as `moseg segment` leaves it."""
    folder = tmp_path / "out"
    write_masks(folder / "masks", LABELS)
    write_overlay(folder / "overlay.mp4", IMAGES, LABELS, 10)
    write_motion(folder / "motion.json", summarise_sequence("dog", LABELS, 10.0, 2, {1: 1}))
    return folder


def _without_mark(path):
    with av.open(str(path)) as source, av.open(str(path) + ".new", "w", format="mp4") as target:
        stream = target.add_stream_from_template(source.streams.video[0])
        for packet in source.demux(video=0):
            if packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    (path.parent / f"{path.name}.new").replace(path)


def test_what_moseg_wrote_is_replaced(out):
    check_outputs(str(out), None)
    assert is_own_mask(out / "masks" / "00000.png")
    assert is_own_overlay(out / "overlay.mp4")
    assert is_own_summary(out / "motion.json")


@pytest.mark.parametrize("has_summary", [True, False])
def test_a_mask_corrected_by_hand_is_kept(out, has_summary):
    path = out / "masks" / "00001.png"
    with Image.open(path) as image:
        image.load()
    image.putpixel((0, 0), 1)
    image.save(path)
    if not has_summary:
        (out / "motion.json").unlink()
    with pytest.raises(InputError, match=r"a file not known as moseg's own in .*00001\.png; expected another output"):
        check_outputs(str(out), None)


def test_a_foreign_summary_does_not_make_foreign_masks_ours(out):
    Image.new("P", (48, 32)).save(out / "masks" / "00002.png")
    (out / "motion.json").write_text("{}")
    with pytest.raises(InputError, match=r"not known as moseg's own in .*00002\.png"):
        check_outputs(str(out), None)


def test_a_foreign_summary_is_kept(out):
    (out / "motion.json").write_text(json.dumps({"frames": []}))
    with pytest.raises(InputError, match=r"not known as moseg's own in .*motion\.json"):
        check_outputs(str(out), None)


def test_a_foreign_video_is_kept_and_allowed_where_no_overlay_is_written(out):
    _without_mark(out / "overlay.mp4")
    with pytest.raises(InputError, match=r"not known as moseg's own in .*overlay\.mp4"):
        check_outputs(str(out), None)
    check_outputs(str(out), None, has_overlay=False)
    (out / "overlay.mp4").write_bytes(b"")
    with pytest.raises(InputError, match=r"not known as moseg's own in .*overlay\.mp4"):
        check_outputs(str(out), None)


def test_an_overlay_whose_other_texts_are_not_utf8_is_still_ours(out):
    path = out / "overlay.mp4"
    content = path.read_bytes()
    encoder = content.index(b"Lavf")
    path.write_bytes(content[:encoder] + b"\xe9" + content[encoder + 1 :])
    assert is_own_overlay(path)


def test_a_run_killed_in_the_middle_can_be_continued(out):
    (out / "motion.json").unlink()
    (out / "masks" / "00002.png").unlink()
    check_outputs(str(out), None)


def test_a_shorter_run_does_not_remove_an_image_that_is_not_ours(out):
    Image.new("P", (48, 32)).save(out / "masks" / "00002.png")
    write_masks(out / "masks", LABELS[:1])
    assert sorted(path.name for path in (out / "masks").iterdir()) == ["00000.png", "00002.png"]


def test_an_impossible_name_is_reported_before_the_work(tmp_path):
    with pytest.raises(InputError, match=r"cannot write .*File name too long"):
        OwnedFile(tmp_path / ("n" * 252 + ".npz"), is_own_mask).check()


def test_an_archive_of_a_later_version_is_not_ours(tmp_path):
    path = tmp_path / "labels.npz"
    np.savez(path, labels=LABELS)
    content = bytearray(path.read_bytes())
    content[content.index(b"PK\1\2") + 6] = 127
    path.write_bytes(content)
    assert not is_own_archive(path)


def test_a_listing_nested_too_deeply_is_named(tmp_path):
    (tmp_path / ".moseg-export.json").write_text("[" * 100_000)
    with pytest.raises(InputError, match=r"listing of an export cannot be read in .*json"):
        OwnedFolder(tmp_path, ["00000.png"]).check()


@pytest.mark.parametrize("name", ["", ".", "..", "masks/00000.png", "/", 1])
def test_a_listing_of_what_is_no_file_name_is_named(tmp_path, name):
    (tmp_path / ".moseg-export.json").write_text(json.dumps([name]))
    with pytest.raises(InputError, match="expected a list of file names"):
        OwnedFolder(tmp_path, ["00000.png"]).check()
