"""What a segmentation says of itself."""

import base64
import io
import re
from importlib import import_module

import cv2
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.api import MovingObject, segment_video
from moseg.workflows.exports import OverlayMode, OverlayStyle
from moseg.workflows.exports.doubts import BY_HAND
from moseg.workflows.exports.summarise import summarise_sequence


def test_nothing_is_read_before_it_is_asked_for(segmented, config):
    result = segment_video(segmented.frames, config, store=segmented.store, progress=False)
    assert "labels" not in vars(result)
    assert result.labels is result.labels


def test_objects_are_those_of_the_labels(segmented):
    result = segmented.result
    assert {each.identity for each in result.objects} == set(np.unique(result.labels).tolist()) - {0}
    for each in result.objects:
        seen = np.flatnonzero((result.labels == each.identity).any(axis=(1, 2)))
        assert (each.first_frame, each.last_frame, each.num_frames) == (seen[0], seen[-1], len(seen))


def test_scores_are_the_clearest_evidence_of_a_motion_model(segmented):
    assert segmented.result.objects
    for each in segmented.result.objects:
        assert set(each.static_support) <= {"trajs", "oc_depth"}
        assert all(0 <= support <= 1 for support in each.static_support.values())
        assert each.score == 1 - min(each.static_support.values())
        assert each.score > 0.5


def test_affinities_and_residuals_have_a_row_for_the_background_and_each_object(segmented):
    result = segmented.result
    size = len(result.row_identities)
    assert result.row_identities[0] == 0
    assert {each.identity for each in result.objects} <= set(result.row_identities)
    assert list(result.affinities) == list(result.residuals) == ["trajs", "oc_depth"]
    for affinity in result.affinities.values():
        assert affinity.shape == (size, size)
    assert result.residuals["oc_depth"].shape == (len(result.labels) - 1, size, size)


def test_without_motion_models_there_is_no_evidence(segmented, config):
    result = segment_video(segmented.frames, config, variant="base", store=segmented.store, progress=False)
    assert result.affinities == result.residuals == {}
    assert result.objects and all(each.score is None for each in result.objects)


def test_affinities_by_hypotheses_come_without_residuals(segmented, config, tmp_path):
    config = config | {"affinity.method": "hypotheses"}
    result = segment_video(segmented.frames, config, variant="oc", store=segmented.store, progress=False)
    assert list(result.affinities) == ["oc"] and result.residuals == {}


def test_frames_and_overlays_are_pictures_of_the_video(segmented, pixels):
    result = segmented.result
    np.testing.assert_array_equal(np.stack(list(result.frames())), pixels)
    frame = result.overlay(-1)
    assert frame.dtype == np.uint8 and (frame != pixels[-1]).any()
    far = cv2.dilate((result.labels[-1] > 0).astype(np.uint8), np.ones((5, 5), np.uint8)) == 0
    np.testing.assert_array_equal(frame[far], pixels[-1][far])
    assert result.overlay(4, OverlayStyle(is_side_by_side=True)).shape == (96, 256, 3)
    mask = result.overlay(4, OverlayStyle(mode=OverlayMode.MASK))
    np.testing.assert_array_equal(mask.any(axis=-1), result.labels[4] > 0)
    with pytest.raises(IndexError):
        result.overlay(len(pixels))


def test_a_figure_holds_as_many_frames_as_asked_for(segmented):
    one, three, all_of_them = (segmented.result.figure(number, side=64) for number in (1, 3, 99))
    assert one.width == 64 and three.width > 3 * 64 and three.height == one.height
    assert all_of_them.height == 4 * one.height
    with pytest.raises(InputError, match="num_frames"):
        segmented.result.figure(0)


def test_a_notebook_shows_frames_and_objects(segmented):
    html = segmented.result._repr_html_()
    picture = re.search(r"data:image/webp;base64,([^\"]+)", html).group(1)
    assert Image.open(io.BytesIO(base64.b64decode(picture))).width > 600
    assert html.count("<tr>") == 1 + len(segmented.result.objects)
    assert "http" not in html


def test_names_and_tags_are_escaped(segmented, config):
    name = "<script>alert('a: b')<script>"
    result = segment_video(segmented.frames, config, name=name, store=segmented.store, progress=False)
    object.__setattr__(result, "objects", (MovingObject(1, 1, 0, 3, 2, 0.1, "<b>car</b>"),))
    html = result._repr_html_()
    assert "<script" not in html and "<b>" not in html
    assert "&lt;b&gt;car" in html and "0 to 3 (2 of them)" in html
    assert repr(result).startswith("<MotionSegmentation") and "\n" not in repr(result)


def test_exports_are_written_beside_the_masks(segmented, tmp_path):
    written = segmented.result.save(tmp_path, style=None, exports=["npz"])
    assert [path.name for path in written] == ["masks", "motion.json", f"{segmented.result.name}.npz"]
    assert not (tmp_path / "overlay.mp4").exists()
    np.testing.assert_array_equal(np.load(written[-1])["labels"], segmented.result.labels)
    with pytest.raises(InputError, match="coco"):
        segmented.result.save(tmp_path / "none", exports=["cocoa"])
    assert not (tmp_path / "none").exists()


def test_a_report_is_written_where_it_is_asked_for(segmented, config, tmp_path):
    page = tmp_path / "report.html"
    segment_video(segmented.frames, config, name="the squares", report=page, store=segmented.store, progress=False)
    assert "the squares" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"style": "cutout"}, "in style; got 'cutout'"),
        ({"exports": 3}, "in exports; got 3"),
        ({"exports": [3]}, "in exports"),
        ({"exports": "colmap", "dilation": -1}, "in dilation; got -1; expected 0 or more"),
        ({"exports": "colmap", "dilation": 1.5}, "in dilation"),
        ({"exports": "npz", "dilation": 2}, "in dilation"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_written(segmented, tmp_path, options, says):
    with pytest.raises(InputError, match=says):
        segmented.result.save(tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_a_style_that_is_none_is_told(segmented):
    with pytest.raises(InputError, match="in style"):
        segmented.result.overlay(0, "mask")
    with pytest.raises(InputError, match=r"in num_frames; got 2\.5"):
        segmented.result.figure(2.5)
    with pytest.raises(InputError, match="in folder; got 3"):
        segmented.result.save(3)


def test_one_format_may_stand_for_itself(segmented, tmp_path):
    written = segmented.result.save(tmp_path, style=None, exports="npz")
    assert written[-1].suffix == ".npz"


def test_a_folder_that_cannot_be_written_is_told(segmented, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="file"):
        segmented.result.save(tmp_path / "file")


def test_python_advises_what_the_file_of_a_result_advises(segmented, config, monkeypatch):
    module, given = import_module("moseg.workflows.api.segment_video"), []

    def summarise(*arguments, **options):
        given.append(options.get("advice"))
        return summarise_sequence(*arguments, **options)

    monkeypatch.setattr(module, "summarise_sequence", summarise)
    result = segment_video(segmented.frames, config, store=segmented.store, progress=False)
    assert given == [result._stored.advice] and given != [BY_HAND]
