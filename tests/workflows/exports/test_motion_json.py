"""motion.json holds what moves, when and how large it is."""

import json

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.exports import summarise_sequence, write_motion
from moseg.workflows.exports.motion_json import frame_names, read_motion
from moseg.workflows.sources import ImageFiles, VideoFile


@pytest.fixture
def labels():
    """Identity 2 covers 8 px of frames 1 and 3, identity 5 covers 20 px of frame 2; a frame has 80 px."""
    volume = np.zeros((4, 8, 10), dtype=np.uint16)
    volume[1::2, 0:2, 0:4] = 2
    volume[2, 2:6, 5:10] = 5
    return volume


def test_summary_follows_each_identity(labels):
    summary = summarise_sequence("dog", iter(labels), 25, 3, motions={2: 1, 5: 2, 9: 2})
    assert (summary.num_frames, summary.width, summary.height, summary.num_motions) == (4, 10, 8, 3)
    second, fifth = summary.objects
    assert (second.identity, second.motion) == (2, 1)
    assert (second.first_frame, second.last_frame, second.num_frames) == (1, 3, 2)
    assert second.mean_area_fraction == pytest.approx(0.1)
    assert (fifth.first_frame, fifth.last_frame, fifth.num_frames) == (2, 2, 1)
    assert fifth.mean_area_fraction == pytest.approx(0.25)


def test_file_holds_the_summary(tmp_path, labels):
    write_motion(tmp_path / "new" / "motion.json", summarise_sequence("dog", labels, 25, 2, {2: 1, 5: 1}))
    content = json.loads((tmp_path / "new" / "motion.json").read_text())
    assert content["name"] == "dog"
    assert [entry["identity"] for entry in content["objects"]] == [2, 5]
    assert [entry.name for entry in (tmp_path / "new").iterdir()] == ["motion.json"]


def test_each_frame_of_an_object_has_its_area_and_how_sure_and_complete_it_is(tmp_path, labels):
    confidences = [(np.full(6, 0.9), np.full(6, 0.8)) for _ in labels]
    confidences[3] = (np.full(6, 0.7), np.full(6, np.nan))
    summary = summarise_sequence("dog", labels, 25, 2, {2: 1, 5: 1}, confidences=confidences)
    second = summary.objects[0]
    assert second.per_frame.model_dump() == {
        "frame": (1, 3),
        "area_fraction": (0.1, 0.1),
        "sure": (0.9, 0.7),
        "complete": (0.8, None),
    }
    assert second.sure == pytest.approx(0.8) and second.complete == 0.8
    write_motion(tmp_path / "motion.json", summary)
    assert read_motion(tmp_path / "motion.json") == summary


def test_where_confidence_is_not_known_in_all_frames_it_is_left_open(labels):
    some = [None, None, (np.ones(6), np.ones(6)), (np.ones(6), np.ones(6))]
    found = summarise_sequence("dog", labels, 25, 2, {2: 1, 5: 1}, confidences=some).objects[0]
    assert found.sure is None and found.per_frame.sure is None and found.per_frame.frame == (1, 3)


def test_frames_of_a_folder_are_named_and_those_of_a_video_are_not(tmp_path):
    images = ImageFiles((str(tmp_path / "größe 1.png"), str(tmp_path / "犬.jpg")), 100)
    assert frame_names(images) == ("größe 1.png", "犬.jpg")
    assert frame_names(VideoFile(str(tmp_path / "a.mp4"), 100)) is None


def test_a_name_that_json_cannot_hold_is_one_line():
    with pytest.raises(InputError, match=r"frame in here; got 'a\\udcff\.png'; expected a name in UTF-8"):
        frame_names(ImageFiles(("here/a\udcff.png",), 100))


def test_a_summary_is_read_as_it_was_written(tmp_path, labels):
    summary = summarise_sequence("dog", labels, 29.97, 2, {2: 1, 5: 1}, {2: "dog"}, tuple("abcd"))
    write_motion(tmp_path / "motion.json", summary)
    assert read_motion(tmp_path / "motion.json") == summary


def test_a_still_video_has_no_objects(labels):
    assert summarise_sequence("still", labels * 0, 25, 1, {}).objects == ()


def test_no_frame_is_refused():
    with pytest.raises(InputError, match="no frame to summarise in dog"):
        summarise_sequence("dog", [], 25, 1, {})


def test_a_path_that_cannot_be_written_is_named(tmp_path, labels):
    (tmp_path / "motion.json").mkdir()
    with pytest.raises(InputError, match=r"cannot write in .*motion.json"):
        write_motion(tmp_path / "motion.json", summarise_sequence("dog", labels, 25, 2, {2: 1, 5: 1}))
    assert [entry.name for entry in tmp_path.iterdir()] == ["motion.json"]


def test_a_name_that_is_not_utf_8_is_escaped(tmp_path):
    summary = summarise_sequence("f\udcffr", np.zeros((1, 2, 2), np.uint16), 24.0, 1, {})
    write_motion(tmp_path / "motion.json", summary)
    assert json.loads((tmp_path / "motion.json").read_text())["name"] == "f\\udcffr"


def test_an_object_that_grows_has_its_mean_area():
    volume = np.zeros((3, 8, 10), np.uint16)
    for index in range(3):
        volume[index, : 2 + index, :4] = 2
    (found,) = summarise_sequence("dog", volume, 25, 2, {2: 1}).objects
    assert found.mean_area_fraction == pytest.approx(12 / 80)


def test_frames_in_which_it_is_not_known_to_move_are_no_motion():
    volume = np.zeros((4, 8, 10), np.uint16)
    volume[:, :2, :4] = 2
    moves = [np.array([-1, -1, each], np.int8) for each in (1, 0, -1, 1)]
    (found,) = summarise_sequence("dog", volume, 25, 2, {2: 1}, moves=moves).objects
    assert found.moving_frames == ((0, 0), (3, 3))
