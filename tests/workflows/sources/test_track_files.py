import io

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.sources import TrackFile

SIZE = (48, 64)
NUM_FRAMES = 5
POINTS = np.random.default_rng(0).uniform(0, 47, (7, NUM_FRAMES, 2)).astype(np.float32)
VISIBLE = np.random.default_rng(1).random((7, NUM_FRAMES)) < 0.7


@pytest.fixture
def read(tmp_path):
    """Return a function that writes tracks and reads them."""

    def call(points=POINTS, visible=VISIBLE, max_side=100, **more):
        np.savez(tmp_path / "dog.npz", points=points, visible=visible, **more)
        return TrackFile(str(tmp_path / "dog.npz"), NUM_FRAMES, SIZE, max_side).read()

    return call


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64])
def test_visible_points_are_read_as_float32_and_the_others_as_zero(read, dtype):
    points, visible = read(POINTS.astype(dtype), names=np.array(["a", "b"]))
    assert (points.dtype, visible.dtype) == (np.float32, bool)
    np.testing.assert_array_equal(visible, VISIBLE)
    np.testing.assert_array_equal(points, np.where(VISIBLE[..., None], POINTS.astype(dtype), 0))


def test_a_pixel_keeps_its_place_in_reduced_frames(read):
    corners = np.zeros((2, NUM_FRAMES, 2))
    corners[0], corners[1] = (-0.5, -0.5), (63.25, 47.25)
    points, visible = read(corners, np.ones((2, NUM_FRAMES), bool), max_side=32)
    assert visible.all()
    np.testing.assert_allclose(points[0], -0.5)
    # Three quarters into the last pixel are seven eighths into one twice as large.
    np.testing.assert_allclose(points[1], np.full((NUM_FRAMES, 2), (31.375, 23.375)))


def test_a_point_outside_the_frame_is_not_visible(read):
    points = np.full((1, NUM_FRAMES, 2), 10.0)
    points[0, 3], points[0, 4] = (63.5, 10), (10, -0.6)
    found, visible = read(points, np.ones((1, NUM_FRAMES), bool))
    assert visible.tolist() == [[True, True, True, False, False]]
    assert not found[0, 3:].any()


def test_invisible_points_may_have_any_value(read):
    points = np.where(VISIBLE[..., None], POINTS, np.nan)
    found, _ = read(points)
    np.testing.assert_array_equal(found, np.where(VISIBLE[..., None], POINTS, 0))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_visible_points_must_be_finite(read, bad):
    points = POINTS.copy()
    track, frame = np.argwhere(VISIBLE)[0]
    points[track, frame, 1] = bad
    with pytest.raises(InputError, match=r"not finite in .*dog\.npz; got 1 visible"):
        read(points)


def test_points_of_larger_frames_are_refused(read):
    with pytest.raises(InputError, match=r"outside the frame in .*dog\.npz; got .* expected .* 64x48 px"):
        read(POINTS * 10)


@pytest.mark.parametrize(
    "points", [POINTS / 47, POINTS / 23.5 - 1, np.zeros_like(POINTS)], ids=["0 to 1", "-1 to 1", "0"]
)
def test_coordinates_that_are_shares_of_the_frame_are_refused(read, points):
    with pytest.raises(InputError, match=r"not in px in .*dog\.npz; got visible points .* expected .* 64x48 px"):
        read(points)


@pytest.mark.parametrize("num_tracks", [0, 7])
def test_tracks_without_a_visible_point_are_refused(read, num_tracks):
    with pytest.raises(InputError, match=rf"no visible point in .*dog\.npz; got {num_tracks} tracks"):
        read(POINTS[:num_tracks], np.zeros((num_tracks, NUM_FRAMES), bool))


@pytest.mark.parametrize("num_frames", [NUM_FRAMES - 1, NUM_FRAMES + 1])
def test_tracks_over_another_number_of_frames_are_refused(read, num_frames):
    points, visible = np.ones((3, num_frames, 2)), np.ones((3, num_frames), bool)
    with pytest.raises(InputError, match=rf"dog\.npz; got {num_frames} frames; expected {NUM_FRAMES}"):
        read(points, visible)


@pytest.mark.parametrize(
    ("points", "visible"),
    [
        (POINTS.astype(int), VISIBLE),
        (POINTS, VISIBLE.astype(np.uint8)),
        (POINTS, VISIBLE.T),
        (POINTS[0], VISIBLE[0]),
        (np.dstack([POINTS, POINTS]), VISIBLE),
    ],
    ids=["int", "not-bool", "frames-first", "one-track", "four-columns"],
)
def test_other_arrays_are_refused_as_tracks(read, points, visible):
    with pytest.raises(InputError, match=r"not tracks in .*dog\.npz; .* expected points float \(N, F, 2\)"):
        read(points, visible)


def _bytes_of(save, *arrays, **named):
    content = io.BytesIO()
    save(content, *arrays, **named)
    return content.getvalue()


def _flip(content, position):
    return content[:position] + bytes([content[position] ^ 1]) + content[position + 1 :]


NPZ = _bytes_of(np.savez, points=POINTS, visible=VISIBLE)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"text",
        _bytes_of(np.savez, points=POINTS),
        _bytes_of(np.save, POINTS),
        _bytes_of(np.savez, points=np.array([{}], object), visible=VISIBLE),
        NPZ[:-40],
        _flip(NPZ, 300),
        _flip(_bytes_of(np.savez_compressed, points=POINTS, visible=VISIBLE), 300),
        _flip(NPZ, NPZ.index(b"PK\1\2") + 8),
    ],
    ids=["empty", "text", "no-visible", "npy", "pickle", "cut", "flipped", "flipped-compressed", "encrypted"],
)
def test_other_bytes_are_refused_as_tracks(tmp_path, content):
    (tmp_path / "dog.npz").write_bytes(content)
    with pytest.raises(InputError, match=r"tracks.* in .*dog\.npz"):
        TrackFile(str(tmp_path / "dog.npz"), NUM_FRAMES, SIZE, 100).read()


def test_the_fingerprint_follows_bytes_and_frames_and_not_the_name(tmp_path):
    for name, points in (("a", POINTS), ("b", POINTS), ("c", POINTS + 1)):
        np.savez(tmp_path / f"{name}.npz", points=points, visible=VISIBLE)

    def fingerprint(name, num_frames=NUM_FRAMES, size=SIZE, max_side=100):
        return TrackFile(str(tmp_path / f"{name}.npz"), num_frames, size, max_side).fingerprint()

    same = fingerprint("a")
    assert same == fingerprint("b")
    others = [fingerprint("c"), fingerprint("a", 6), fingerprint("a", size=(64, 48)), fingerprint("a", max_side=32)]
    assert len({same, *others}) == 5
