"""The overlay plays, and shows each frame once with its objects."""

from fractions import Fraction

import av
import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.exports import draw_labels, identity_colours, write_overlay

GREY = 120


def scene(num_frames=5, shape=(48, 64)):
    """A grey video in which a box of identity 3 moves to the right."""
    images = np.full((num_frames, *shape, 3), GREY, dtype=np.uint8)
    labels = np.zeros((num_frames, *shape), dtype=np.uint16)
    for index in range(num_frames):
        labels[index, 12:36, 8 + 4 * index : 32 + 4 * index] = 3
    return images, labels


def decode(path):
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        return np.stack(frames), stream


def test_video_has_every_frame_at_its_size_and_rate_in_a_format_browsers_play(tmp_path):
    path = tmp_path / "new" / "overlay.mp4"
    assert write_overlay(path, *map(iter, scene()), fps=29.97) == 5
    frames, stream = decode(path)
    assert frames.shape == (5, 48, 64, 3)
    assert stream.average_rate == Fraction(2997, 100)
    assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
    content = path.read_bytes()
    assert 0 < content.find(b"moov") < content.find(b"mdat")
    assert [entry.name for entry in path.parent.iterdir()] == ["overlay.mp4"]


def test_decoded_pixels_are_the_drawn_ones(tmp_path):
    images, labels = scene()
    write_overlay(tmp_path / "overlay.mp4", images, labels, fps=10)
    frames, _ = decode(tmp_path / "overlay.mp4")
    for index in (0, 4):
        expected = draw_labels(images[index], labels[index])
        inside, outside = (24, 20 + 4 * index), (4, 4)
        np.testing.assert_allclose(frames[index][inside].astype(int), expected[inside], atol=8)
        np.testing.assert_allclose(frames[index][outside].astype(int), GREY, atol=8)


def test_odd_sizes_are_padded_with_the_last_row_and_column(tmp_path):
    images, labels = scene(2, shape=(47, 63))
    write_overlay(tmp_path / "overlay.mp4", images, labels, fps=10)
    frames, _ = decode(tmp_path / "overlay.mp4")
    assert frames.shape == (2, 48, 64, 3)
    np.testing.assert_allclose(frames[0, -1, -1].astype(int), GREY, atol=8)


def test_drawing_tints_objects_outlines_them_by_two_pixels_and_leaves_the_rest():
    images, labels = scene(1)
    before = images[0].copy()
    drawn = draw_labels(images[0], labels[0])
    np.testing.assert_array_equal(images[0], before)
    assert drawn[0, 0].tolist() == [GREY] * 3
    colour = identity_colours(np.array(3, dtype=np.uint16)).astype(float)
    np.testing.assert_allclose(drawn[24, 20], 0.55 * GREY + 0.45 * colour, atol=1)
    bright = (drawn[24] == colour).all(axis=-1)
    assert np.flatnonzero(bright).tolist() == [7, 8, 31, 32]


def test_a_frame_without_objects_is_left_as_it_is():
    images, labels = scene(1)
    np.testing.assert_array_equal(draw_labels(images[0], labels[0] * 0), images[0])


@pytest.mark.parametrize(
    ("num_images", "num_labels", "message"), [(3, 2, "no mask 2"), (2, 3, "no frame 2"), (0, 0, "no frame to write")]
)
def test_a_video_that_does_not_fit_its_masks_leaves_no_file(tmp_path, num_images, num_labels, message):
    images, labels = scene(3)
    with pytest.raises(InputError, match=message):
        write_overlay(tmp_path / "overlay.mp4", images[:num_images], labels[:num_labels], fps=10)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_rewrite_keeps_the_old_video(tmp_path):
    images, labels = scene()
    write_overlay(tmp_path / "overlay.mp4", images, labels, fps=10)
    old = (tmp_path / "overlay.mp4").read_bytes()
    with pytest.raises(InputError, match=r"wrong size of mask 0 in .*; got \(48, 60\); expected \(48, 64\)"):
        write_overlay(tmp_path / "overlay.mp4", images, labels[:, :, :60], fps=10)
    assert (tmp_path / "overlay.mp4").read_bytes() == old


def test_bad_rates_and_paths_are_named(tmp_path):
    images, labels = scene(1)
    for fps in (0, -1.0, float("nan"), float("inf")):
        with pytest.raises(InputError, match=f"impossible frame rate in .*; got {fps}"):
            write_overlay(tmp_path / "overlay.mp4", images, labels, fps=fps)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot write in .*overlay.mp4; got File exists"):
        write_overlay(tmp_path / "file" / "overlay.mp4", images, labels, fps=10)


@pytest.mark.parametrize(("fps", "played"), [(1e-5, Fraction(1, 1001)), (1 / 500, Fraction(1, 500)), (3e9, 1000)])
def test_a_rate_beyond_the_players_limits_is_replaced_by_the_nearest_within(tmp_path, fps, played):
    write_overlay(tmp_path / "overlay.mp4", *scene(2), fps=fps)
    _, stream = decode(tmp_path / "overlay.mp4")
    assert float(stream.average_rate) == pytest.approx(float(played))
