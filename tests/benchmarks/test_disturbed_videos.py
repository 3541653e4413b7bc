"""Ground truth goes with the pixels of a disturbed video, in the layouts of masks and of labelled points."""

import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
import scipy.io

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks" / "disturbed_videos"
SHAPE, NUM_FRAMES = (30, 40), 4


@pytest.fixture(scope="module", autouse=True)
def _on_the_path():
    sys.path.insert(0, str(FOLDER))
    yield
    sys.path.remove(str(FOLDER))


@pytest.fixture
def road(tmp_path):
    """Folder of a clip of KT3DMoSeg: a point that moves right, one that is hidden at last, and one that never shows."""
    images = tmp_path / "road" / "Seq005_Clip01" / "images"
    images.mkdir(parents=True)
    for number in range(NUM_FRAMES):
        cv2.imwrite(str(images / f"{number:06}.png"), np.full((*SHAPE, 3), 10 * number, np.uint8))
    points, visible = np.ones((3, 3, NUM_FRAMES)), np.ones((3, NUM_FRAMES), np.uint8)
    points[:2, 0] = [[5.2, 6.2, 7.2, 8.2], [9] * 4]
    points[:2, 1] = [[30] * 4, [20] * 4]
    visible[1, 3], visible[2] = 0, 0
    data = {"ySparse": points, "visibleSparse": visible, "GtLabel": np.uint8([[2], [1], [3]])}
    scipy.io.savemat(tmp_path / "road" / "Seq005_Clip01_Tracks.mat", {"Data": data})
    return tmp_path / "road"


def _disturbed(layout, root, target, name):
    from disturbances import DISTURBANCES

    (sequence,) = layout.sequences(root)
    layout.write(target, sequence, DISTURBANCES[name][1](layout.read(root, sequence), np.random.default_rng(0)))
    data = scipy.io.loadmat(target / f"{sequence}_Tracks.mat")["Data"][0, 0]
    return data["ySparse"], data["visibleSparse"], data["GtLabel"].ravel().tolist()


@pytest.mark.parametrize(
    ("name", "moving", "hidden"),
    [
        ("none", [5, 6, 7, 8], 3),
        ("mirrored", [36, 35, 34, 33], 3),
        ("reversed", [8, 7, 6, 5], 0),
        ("every-second", [5, 7], None),
        ("noisy", [5, 6, 7, 8], 3),
    ],
)
def test_labelled_points_go_with_their_pixels(road, tmp_path, name, moving, hidden):
    from layouts import LAYOUTS

    points, visible, labels = _disturbed(LAYOUTS["kt3dinsmoseg"], road, tmp_path / "out", name)
    # Tracks are in the order of their labels.
    assert labels == [1, 2]
    assert points[0, 1].tolist() == moving and (points[1, 1] == 9).all() and visible[1].all()
    seen = np.arange(len(moving)) != hidden
    assert visible[0].astype(bool).tolist() == seen.tolist()
    assert (points[0, 0, seen] == (11 if name == "mirrored" else 30)).all()
    assert len(list((tmp_path / "out" / "Seq005_Clip01" / "images").iterdir())) == len(moving)


def test_points_go_with_the_picture_into_a_canvas(road, tmp_path):
    from layouts import LAYOUTS

    layout = LAYOUTS["kt3dinsmoseg"]
    points, visible, _ = _disturbed(layout, road, tmp_path / "out", "canvas")
    # 40 px of 53.
    assert points[0, 1].tolist() == [12, 13, 14, 15] and (points[1, 1] == 9).all() and visible[1].all()
    frames = layout.read(tmp_path / "out", "Seq005_Clip01").frames
    assert all(frame.shape == (30, 54, 3) for frame in frames)
    assert not frames[3][:, :7].any() and not frames[3][:, -7:].any() and (frames[3][:, 7:-7] == 30).all()


def test_what_was_written_is_a_data_set(road, tmp_path, moseg):
    from layouts import LAYOUTS

    _disturbed(LAYOUTS["kt3dinsmoseg"], road, tmp_path / "out", "mirrored")
    ran = moseg("datasets", "show", "kt3dinsmoseg", "--root", tmp_path / "out")
    assert (ran.code, ran.err) == (0, "") and "Seq005_Clip01" in ran.out
    scored = moseg("eval", "--dataset", "kt3dinsmoseg", "--root", tmp_path / "out", "--store", tmp_path / "store")
    assert scored.code == 0 and "Seq005_Clip01" in scored.out


def test_masks_go_with_their_pixels(tmp_path):
    from disturbances import DISTURBANCES
    from layouts import Davis

    layout = Davis()
    for folder, suffix in ((layout.frames, "jpg"), (layout.truths, "png")):
        (tmp_path / folder / "a").mkdir(parents=True)
        for number in range(NUM_FRAMES):
            image = np.zeros((*SHAPE, 3) if suffix == "jpg" else SHAPE, np.uint8)
            image[5:15, number : number + 10] = 255
            cv2.imwrite(str(tmp_path / folder / "a" / f"{number:05}.{suffix}"), image)
    read = layout.read(tmp_path, "a")
    layout.write(tmp_path / "out", "a", DISTURBANCES["mirrored"][1](read, np.random.default_rng(0)))
    found = layout.read(tmp_path / "out", "a")
    np.testing.assert_array_equal(found.truths, np.array(read.truths)[:, :, ::-1])
    assert layout.sequences(tmp_path / "out") == ["a"]


def test_a_sequence_that_is_not_there_is_named(road):
    from layouts import LAYOUTS

    for layout in LAYOUTS.values():
        with pytest.raises(FileNotFoundError, match=r"no frames in .*none"):
            layout.read(road, "none")


@pytest.mark.parametrize("shape", [(64, 96), (63, 95)])
def test_encoded_frames_are_like_the_frames_and_keep_their_size(shape):
    from disturbances import Video, encode

    rng = np.random.default_rng(0)
    scene = cv2.GaussianBlur(rng.uniform(0, 255, (shape[0], shape[1] + 20, 3)), (0, 0), 3)
    scene = np.clip(128 + 4 * (scene - scene.mean()), 0, 255).astype(np.uint8)
    frames = [scene[:, 4 * number : 4 * number + shape[1]] for number in range(5)]
    coded = encode(Video(frames, frames), rng)
    assert coded.truths is frames
    assert [frame.shape for frame in coded.frames] == [(*shape, 3)] * 5
    for frame, other in zip(frames, coded.frames, strict=True):
        errors = [np.abs(other.astype(float) - each).mean() for each in frames]
        assert errors[[each is frame for each in frames].index(True)] == min(errors) > 0
    rough = encode(Video(frames, frames), rng, quality=45)
    error = [np.abs(np.subtract(each.frames, frames, dtype=float)).mean() for each in (coded, rough)]
    assert error[0] < error[1]
