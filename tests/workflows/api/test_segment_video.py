"""`segment_video` gives what the command line gives, from whatever the video is handed over as."""

import asyncio
import os
import subprocess
import sys
import tempfile

import cv2
import dask
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError, MosegError, StoreError
from moseg.workflows.api import segment_video
from moseg.workflows.api.process_settings import kept_process_settings
from moseg.workflows.process.resources import pin_threads


def _masks(folder) -> np.ndarray:
    return np.stack([np.asarray(Image.open(path)) for path in sorted((folder / "masks").iterdir())])


def test_labels_are_those_of_the_command_line(segmented):
    result = segmented.result
    assert result.labels.dtype == np.uint16 and result.labels.any()
    np.testing.assert_array_equal(result.labels, _masks(segmented.out))
    np.testing.assert_array_equal(result.moving, result.labels > 0)


def test_what_the_command_line_computed_is_not_computed_again(segmented):
    assert segmented.result.store_use.computed == 0
    assert segmented.result.store_use.reused > 0


def test_saved_files_are_those_of_the_command_line(segmented, tmp_path):
    folder = tmp_path / "new" / "out"
    assert {path.name for path in segmented.result.save(folder)} == {"masks", "overlay.mp4", "motion.json"}
    for path in (*sorted((segmented.out / "masks").iterdir()), segmented.out / "motion.json"):
        assert (folder / path.relative_to(segmented.out)).read_bytes() == path.read_bytes()
    assert (folder / "overlay.mp4").stat().st_size > 0


@pytest.mark.parametrize("kind", ["array", "list", "generator"])
def test_pixels_have_the_artifacts_of_the_files_that_decode_to_them(segmented, pixels, kind, config):
    video = {"array": pixels, "list": list(pixels), "generator": (frame for frame in pixels)}[kind]
    result = segment_video(video, config, store=segmented.store, progress=False)
    assert result.store_use.computed <= 1
    np.testing.assert_array_equal(result.labels, segmented.result.labels)
    again = segment_video(pixels, config, store=segmented.store, progress=False)
    assert again.store_use.computed == 0


def test_grey_is_three_equal_channels(pixels, tmp_path, config):
    grey = pixels[:5, ..., 1]
    config = config | {"max_side": 64}
    result = segment_video(grey, config, store=tmp_path / "store", progress=False)
    same = segment_video(np.stack([grey] * 3, axis=-1), config, store=tmp_path / "store", progress=False)
    assert same.store_use.computed == 0
    assert (result.analysed_shape, result.shape, result.labels.shape[1:]) == ((48, 64), (96, 128), (96, 128))
    np.testing.assert_array_equal(result.labels, same.labels)


def test_arrays_reach_worker_processes_and_what_these_need_does_not_stay(segmented, pixels, tmp_path, config):
    before = dict(os.environ)
    result = segment_video(iter(pixels), config, store=tmp_path / "store", workers=1, progress=False)
    np.testing.assert_array_equal(result.labels, segmented.result.labels)
    changed = {name for name in before.keys() | os.environ if before.get(name) != os.environ.get(name)}
    assert not {name for name in changed if "THREADS" in name or "MALLOC" in name}


def test_it_runs_under_a_running_event_loop(segmented, pixels, tmp_path, config):
    async def cell():
        result = segment_video(pixels[:4], config, store=tmp_path / "store", progress=False)
        return result.labels, result._repr_html_()

    labels, html = asyncio.run(cell())
    assert labels.any() and "<img" in html


def test_standard_output_stays_empty_and_progress_can_be_silent(pixels, tmp_path, capsys, config, monkeypatch):
    monkeypatch.setattr("moseg.workflows.process.progress_displays.PLAIN_FIRST_SEC", 0)
    segment_video(pixels[:3], config, store=tmp_path / "store")
    told = capsys.readouterr()
    assert told.out == "" and "artifacts" in told.err
    segment_video(pixels[1:4], config, store=tmp_path / "store", progress=False)
    assert capsys.readouterr() == ("", "")


def test_the_callers_threads_and_scheduler_are_put_back(segmented, monkeypatch, config):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    before = cv2.getNumThreads()
    cv2.setNumThreads(2)
    try:
        with dask.config.set(scheduler="threads"):
            segment_video(segmented.frames, config, store=segmented.store, progress=False)
            assert dask.config.get("scheduler") == "threads"
        assert cv2.getNumThreads() == 2
        assert os.environ["OMP_NUM_THREADS"] == "3"
    finally:
        cv2.setNumThreads(before)


def test_the_frame_rate_is_the_callers_or_24(segmented, config):
    assert segmented.result.fps == 24
    assert segment_video(segmented.frames, config, store=segmented.store, fps=12.5, progress=False).fps == 12.5


def test_given_masks_take_the_place_of_proposals(squares, tmp_path):
    frames, masks = squares / "squares" / "frames", squares / "squares" / "masks"
    result = segment_video(frames, variant="base", proposals=masks, store=tmp_path / "store", progress=False)
    np.testing.assert_array_equal(
        result.labels, np.stack([cv2.imread(str(path), 0) for path in sorted(masks.iterdir())])
    )


BLACK = np.zeros((3, 20, 30, 3), np.uint8)


@pytest.mark.parametrize(
    ("video", "options", "says"),
    [
        (BLACK.astype(np.float32), {}, "float32; expected uint8"),
        ([frame / 255 for frame in BLACK], {}, "frame 0; got float64; expected uint8"),
        (BLACK[0], {}, r"\(20, 30, 3\)"),
        (np.zeros((40, 60, 4), np.uint8), {}, r"may be one image; got \(40, 60, 4\); .* list\(array\)"),
        (np.zeros((40, 60, 1), np.uint8), {}, "may be one image"),
        (np.zeros((3, 40, 60), np.uint8), {}, "may be one image"),
        (np.zeros((5, 3, 40, 60), np.uint8), {}, r"frame 0; got \(3, 40, 60\)"),
        (BLACK[0, 0], {}, "not the array of a video"),
        (np.zeros((3, 20, 30, 4), np.uint8), {}, r"frame 0; got \(20, 30, 4\)"),
        (BLACK[:1], {}, "too few frames"),
        (BLACK[:0], {}, "no frame"),
        (BLACK, {"start": len(BLACK)}, "no frame chosen; got 3 frames; expected start and end within them"),
        (iter(()), {}, "no frame"),
        ([BLACK[0], BLACK[0, :10]], {}, "frame 1; got 30x10 px; expected 30x20 px as the first"),
        ([BLACK[0], None], {}, "frame 1"),
        (["a.png", "b.png"], {}, "frame 0"),
        (7, {}, "not a video; got int"),
        (None, {}, "not a video"),
        (b"video.mp4", {}, "not a video; got bytes"),
        ("", {}, "no video named"),
        ("missing.mp4", {}, "missing.mp4"),
        (BLACK, {"fps": 0}, "fps"),
        (BLACK, {"fps": float("nan")}, "fps"),
        (BLACK, {"variant": "fuse"}, "variant"),
        (BLACK, {"motions": "gt"}, "ground truth"),
        (BLACK, {"motions": 0}, "clustering.motions"),
        (BLACK, {"preset": "papers"}, "paper"),
        (BLACK, {"sensitivity": "2"}, r"in sensitivity; got '2' \(str\); expected a number or None"),
        (BLACK, {"sensitivity": 0}, r"track_objects\.sensitivity; got 0\.0; expected greater than 0"),
        (
            BLACK,
            {"sensitivity": 2, "config": {"proposal_source": "saliency"}},
            "in sensitivity; got proposals saliency; expected proposal_source=motion-prompts or proposal_source=auto or"
            " proposal_source=tracks",
        ),
        (BLACK, {"config": {"flow.method": "groundtruth"}}, "ground truth"),
        (BLACK, {"config": {"depth": {"method": "folder"}}}, "depth=PATH"),
        (BLACK, {"config": 3}, "not a configuration; got int"),
        (BLACK, {"fps": 1e-4}, r"0\.1\.\.1000 frames per second"),
        (BLACK, {"fps": 3e9}, "not a frame rate in fps"),
        (BLACK, {"fps": "24"}, r"in fps; got '24' \(str\); expected a number or None"),
        (BLACK, {"workers": -1}, "in workers; got -1; expected 0 or more"),
        (BLACK, {"workers": "2"}, "in workers; got '2'"),
        (BLACK, {"workers": 1.5}, "in workers; got 1.5"),
        (BLACK, {"workers": 10**6}, "in workers; got 1000000"),
        (BLACK, {"threads": 1.5}, "in threads; got 1.5"),
        (BLACK, {"threads": True}, "in threads; got True"),
        (BLACK, {"batch": 0}, "in batch; got 0; expected 1 or more"),
        (BLACK, {"device": "gpu"}, "in device; got 'gpu'"),
        (BLACK, {"device": 0}, "in device; got 0"),
        (BLACK, {"store": 7}, "in store; got 7 .*; expected a path"),
        (BLACK, {"depth": 3}, "in depth; got 3 .*; expected a path or None"),
        (BLACK, {"offline": "yes"}, "in offline"),
        (BLACK, {"preset": 3}, "in preset; got 3"),
        (BLACK, {"motions": 2.5}, "in motions; got 2.5"),
        (BLACK, {"name": 3}, "in name; got 3"),
        (BLACK, {"name": "a/b"}, "in name; got 'a/b'"),
        (BLACK, {"name": " "}, "in name; got ' '"),
        (BLACK, {"name": "x" * 300}, "in name; got str; expected up to 200 bytes"),
        (BLACK, {"name": "f\udcff"}, "in name"),
        (BLACK, {"flow": "nowhere"}, "nowhere"),
    ],
)
def test_bad_input_is_told_in_one_line(in_empty_folder, video, options, says):
    with pytest.raises(InputError, match=says) as raised:
        segment_video(video, progress=False, **options)
    assert "\n" not in str(raised.value) and "--" not in str(raised.value)


def test_a_report_plays_at_the_rate_of_the_call(pixels, tmp_path, config):
    video, page = tmp_path / "clip.mp4", tmp_path / "report.html"
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter_fourcc(*"mp4v"), 30, pixels.shape[2:0:-1])
    for frame in pixels:
        writer.write(frame[..., ::-1])
    writer.release()
    result = segment_video(video, config, fps=5, report=page, store=tmp_path / "store", progress=False)
    assert result.fps == 5
    assert '"fps": 5.0' in page.read_text(encoding="utf-8")


def test_calls_that_overlap_put_the_callers_settings_back(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    before, first, second = cv2.getNumThreads(), kept_process_settings(), kept_process_settings()
    cv2.setNumThreads(2)
    try:
        with dask.config.set(scheduler="threads"):
            first.__enter__()
            pin_threads()
            second.__enter__()
            first.__exit__(None, None, None)
            assert os.environ["OMP_NUM_THREADS"] == "1"
            second.__exit__(None, None, None)
            assert (cv2.getNumThreads(), os.environ["OMP_NUM_THREADS"]) == (2, "3")
            assert dask.config.get("scheduler") == "threads"
    finally:
        cv2.setNumThreads(before)


def test_what_must_be_known_comes_with_the_result(segmented, config):
    assert segmented.result.notes == ()
    options = {"variant": "oc", "store": segmented.store, "progress": False}
    result = segment_video(segmented.frames, config | {"affinity.method": "ork"}, **options)
    (note,) = result.notes
    assert "number of motions" in note and "--" not in note
    assert note in result._repr_html_()
    again = segment_video(segmented.frames, config | {"affinity.method": "ork"}, motions=2, **options)
    assert again.notes == ()


def test_a_full_or_missing_disk_of_temporary_files_is_the_stores_fault(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    with pytest.raises(StoreError, match="cannot keep the frames"):
        segment_video(BLACK, store=tmp_path / "store", progress=False)
    monkeypatch.setattr(tempfile, "tempdir", "/dev/full")
    with pytest.raises(StoreError, match="cannot keep the frames"):
        segment_video(BLACK, store=tmp_path / "store", progress=False)


def test_an_error_of_the_callers_frames_is_the_callers(tmp_path):
    def broken():
        yield BLACK[0]
        raise OSError("the camera is gone")

    with pytest.raises(OSError, match="the camera is gone") as raised:
        segment_video(broken(), store=tmp_path / "store", progress=False)
    assert not isinstance(raised.value, MosegError)


def test_a_script_without_a_main_guard_is_told_of_it(segmented, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import moseg, numpy as np\n"
        "frames = np.random.default_rng(0).integers(0, 255, (5, 30, 40, 3)).astype(np.uint8)\n"
        f"moseg.segment_video(frames, store={str(tmp_path / 'store')!r}, workers=1, progress=False)\n"
    )
    ran = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert "a worker ended while it started in workers 1" in ran.stderr
    assert "the code must stand below if __name__ == '__main__':" in ran.stderr
