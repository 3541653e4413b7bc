"""What a result leaves in a folder, and what it leaves alone."""

import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from threading import Event

import av
import pytest

import moseg
from moseg.schemas.errors import InputError
from moseg.workflows.api import segmentation


def _contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_ground_truth_is_never_overwritten(segmented, squares):
    before = _contents(squares)
    with pytest.raises(InputError, match=r"a file not known as moseg's own in .*00000\.png") as caught:
        segmented.result.save(squares / "squares")
    assert "--out" not in str(caught.value)
    assert _contents(squares) == before


@pytest.mark.parametrize("folder", ["", " "])
def test_no_folder_is_not_the_folder_one_stands_in(segmented, tmp_path, monkeypatch, folder):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="no output folder named in folder"):
        segmented.result.save(folder)
    assert not list(tmp_path.iterdir())


def test_a_video_is_not_replaced_by_its_own_overlay(segmented, config, tmp_path, monkeypatch):
    segmented.result.save(tmp_path)
    monkeypatch.chdir(tmp_path)
    result = moseg.segment_video("overlay.mp4", config, variant="base", store=tmp_path / "store", progress=False)
    before = _contents(tmp_path)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for style in (None, moseg.OverlayStyle()):
        with pytest.raises(InputError, match=r"would replace their input .*overlay\.mp4; expected another folder"):
            result.save(tmp_path, style=style)
    assert _contents(tmp_path) == before


def test_an_overlay_of_somebody_else_stays(segmented, tmp_path):
    (tmp_path / "overlay.mp4").write_bytes(b"precious")
    segmented.result.save(tmp_path, style=None)
    with pytest.raises(InputError, match=r"not known as moseg's own in .*overlay\.mp4"):
        segmented.result.save(tmp_path)
    assert (tmp_path / "overlay.mp4").read_bytes() == b"precious"


def test_exports_of_somebody_else_stop_it_before_the_masks(segmented, tmp_path):
    (tmp_path / "coco.json").write_text("{}")
    with pytest.raises(InputError, match=r"not known as moseg's own in .*coco\.json"):
        segmented.result.save(tmp_path, exports=["npz", "coco"])
    assert [path.name for path in tmp_path.iterdir()] == ["coco.json"]


def test_masks_of_one_result_never_stand_beside_the_summary_of_another(segmented, tmp_path, monkeypatch):
    result = segmented.result
    result.save(tmp_path)

    def fail(*arguments, **options):
        raise InputError("no room left")

    monkeypatch.setattr("moseg.workflows.pipelines.write_segmentation.write_overlay", fail)
    with pytest.raises(InputError, match="no room left"):
        result.save(tmp_path)
    assert not (tmp_path / "motion.json").exists()
    monkeypatch.undo()
    result.save(tmp_path)
    assert json.loads((tmp_path / "motion.json").read_text())["num_frames"] == result.num_frames


def test_a_rate_that_a_container_states_is_kept_and_played_as_near_as_players_can(segmented, tmp_path):
    replace(segmented.result, fps=3e9).save(tmp_path)
    assert json.loads((tmp_path / "motion.json").read_text())["fps"] == 3e9
    with av.open(str(tmp_path / "overlay.mp4")) as container:
        assert container.streams.video[0].average_rate == 1000


@pytest.mark.parametrize("fps", [1e-5, 0.09, 1001, 3e9, float("nan")])
def test_rates_beyond_those_of_the_command_line_are_refused_before_the_work(segmented, tmp_path, fps):
    with pytest.raises(InputError, match="not a frame rate in fps"):
        moseg.segment_video(segmented.frames, fps=fps, store=tmp_path / "store", progress=False)
    assert not (tmp_path / "store").exists()


def test_an_overlay_can_have_the_size_of_the_video_where_it_can_be_read_again(segmented, pixels, config, tmp_path):
    options = {"config": config | {"max_side": 64}, "store": tmp_path / "store", "progress": False, "variant": "base"}
    result = moseg.segment_video(segmented.frames, **options)
    for size, (height, width) in (("analysed", result.analysed_shape), ("video", result.shape)):
        result.save(tmp_path / "out", overlay_size=size)
        with av.open(str(tmp_path / "out" / "overlay.mp4")) as container:
            assert (container.streams.video[0].width, container.streams.video[0].height) == (width, height)
    with pytest.raises(InputError, match=r"in overlay_size; got 'large'"):
        result.save(tmp_path / "out", overlay_size="large")
    of_arrays = moseg.segment_video(pixels, **options)
    with pytest.raises(InputError, match=r"no overlay of the video's own size in overlay_size; got frames .* arrays"):
        of_arrays.save(tmp_path / "other", overlay_size="video")
    assert not (tmp_path / "other").exists()


@pytest.fixture
def save_both(monkeypatch):
    """Return a function that saves a second result in a folder while a first one is being written to it."""
    is_waiting = Event()

    def lock_folder(folder, on_wait):
        return lock(folder, is_waiting.set)

    lock, write = segmentation.lock_folder, segmentation.write_segmentation
    monkeypatch.setattr(segmentation, "lock_folder", lock_folder)

    def call(first, second, folder, **outputs):
        with ThreadPoolExecutor(1) as pool:
            started = []

            def write_first(*arguments):
                if not started:
                    started.append(pool.submit(second.save, folder, **outputs))
                    assert is_waiting.wait(60)
                return write(*arguments)

            monkeypatch.setattr(segmentation, "write_segmentation", write_first)
            first.save(folder, **outputs)
            return started[0].result(60)

    return call


def test_of_two_runs_at_a_time_one_writes_after_the_other(segmented, config, save_both, tmp_path):
    nothing = moseg.segment_video(segmented.frames, config, motions=1, store=segmented.store, progress=False)
    assert len(segmented.result.objects) > len(nothing.objects) == 0
    save_both(segmented.result, nothing, tmp_path / "both", exports="coco")
    nothing.save(tmp_path / "alone", exports="coco")
    both, alone = (
        {path.relative_to(folder): content for path, content in _contents(folder).items()}
        for folder in (tmp_path / "both", tmp_path / "alone")
    )
    assert both == alone


def test_of_two_videos_at_a_time_the_first_keeps_its_results(segmented, config, pixels, save_both, tmp_path):
    other = moseg.segment_video(pixels, config, name="other", store=segmented.store, progress=False)
    with pytest.raises(InputError, match="the results of another video"):
        save_both(segmented.result, other, tmp_path / "out")
    assert json.loads((tmp_path / "out" / "motion.json").read_text())["name"] == segmented.result.name


def test_a_result_is_saved_although_its_video_is_gone(segmented, config, tmp_path):
    shutil.copytree(segmented.frames, tmp_path / "clip")
    result = moseg.segment_video(tmp_path / "clip", config, store=tmp_path / "store", progress=False)
    video = json.loads((segmented.out / "motion.json").read_text())["video"]
    shutil.rmtree(tmp_path / "clip")
    assert result.corrections.video == video
    result.save(tmp_path / "out")
    assert json.loads((tmp_path / "out" / "motion.json").read_text())["video"] == video
