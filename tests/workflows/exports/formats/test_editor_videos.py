"""Videos for editors, decoded again: as many frames as masks, white or opaque exactly where something moves."""

import av
import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.exports.encode_video import Encoding, encode_video
from moseg.workflows.exports.formats import FORMATS, choose_formats, export
from moseg.workflows.exports.formats.editor_videos import MATTE, PRORES, PRORES_ENCODING, WEBM
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.ownership import is_own_overlay
from moseg.workflows.sources import ImageFiles

HEIGHT, WIDTH, NUM_FRAMES = 45, 61, 5


@pytest.fixture
def cut(tmp_path, write_saved):
    """Return a segmentation of odd sizes with its frames, labels uint16 (frame, y, x) and colours."""
    labels = np.zeros((NUM_FRAMES, HEIGHT, WIDTH), np.uint16)
    for index in range(NUM_FRAMES):
        labels[index, 10:30, 5 + 4 * index : 25 + 4 * index] = 1
    labels[3] = 0
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    frames = [np.dstack([x * 3, y * 4, np.full_like(x, 40 * index)]).astype(np.uint8) for index in range(NUM_FRAMES)]
    saved = write_saved(labels, tuple(f"{index}.png" for index in range(NUM_FRAMES)))
    return saved, labels, frames


@pytest.fixture
def with_frames(cut, tmp_path):
    """Return the segmentation with the folder of its frames."""
    from PIL import Image

    saved, _, frames = cut
    (tmp_path / "frames").mkdir()
    paths = [tmp_path / "frames" / name for name in saved.names]
    for path, frame in zip(paths, frames, strict=True):
        Image.fromarray(frame).save(path)
    return saved.from_video(FrameOrigin(str(tmp_path / "frames"), ImageFiles(tuple(map(str, paths)), 1000)))


def _decode(path, decoder=None):
    """Return the frames uint8 (y, x, 4), the pixel format in the file and its rate; FFmpeg's own VP9 has no alpha."""
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        codec = stream.codec_context if decoder is None else av.CodecContext.create(decoder, "r")
        decoded = [frame for packet in container.demux(stream) for frame in codec.decode(packet)]
        return [frame.to_ndarray(format="rgba") for frame in decoded], decoded[0].format.name, stream.average_rate


def test_a_matte_is_white_where_something_moves(cut, tmp_path):
    saved, labels, _ = cut
    (path,) = export(saved, [MATTE], tmp_path)
    frames, _, rate = _decode(path)
    assert (path, len(frames), rate) == (tmp_path / "matte.mp4", NUM_FRAMES, 25)
    for frame, mask in zip(frames, labels > 0, strict=True):
        # H.264 in 4:2:0 has even sizes.
        shown = frame[:HEIGHT, :WIDTH, :3]
        assert frame.shape[:2] == (HEIGHT + 1, WIDTH + 1)
        assert not mask.any() or shown[mask].min() > 225
        assert shown[~mask].max() < 30


@pytest.mark.parametrize(
    ("entry", "file", "decoder", "kind", "tolerance"),
    [(PRORES, "cutout.mov", None, "yuva444p", 2), (WEBM, "cutout.webm", "libvpx-vp9", "yuva420p", 30)],
)
def test_a_cut_out_has_the_colours_and_is_opaque_where_something_moves(
    cut, with_frames, tmp_path, entry, file, decoder, kind, tolerance
):
    _, labels, images = cut
    (path,) = export(with_frames, [entry], tmp_path)
    frames, pixels, rate = _decode(path, decoder)
    assert (path, len(frames), rate) == (tmp_path / file, NUM_FRAMES, 25)
    assert pixels.startswith(kind)
    for frame, mask, image in zip(frames, labels > 0, images, strict=True):
        assert frame.shape == (HEIGHT, WIDTH, 4)
        assert not mask.any() or frame[mask, 3].min() >= 255 - tolerance
        assert frame[~mask, 3].max() <= tolerance
        assert np.abs(frame[..., :3].astype(int) - image).mean() < 6


def test_the_alpha_of_a_large_frame_is_the_mask(tmp_path):
    # At this size swscale shares a frame among threads, unless it is told not to.
    masks = np.zeros((8, 480, 854), np.uint8)
    for index, mask in enumerate(masks):
        mask[60 + 7 * index : 420 - 5 * index, 100 + 31 * index : 500 + 31 * index] = 255
    colours = np.full((480, 854, 3), (40, 120, 200), np.uint8)
    path = tmp_path / "cutout.mov"
    encode_video(path, (np.dstack([colours, mask]) for mask in masks), 25, PRORES_ENCODING)
    # Read without a conversion, which could be at fault itself.
    with av.open(str(path)) as container:
        planes = [np.frombuffer(frame.planes[3], np.uint16).reshape(480, -1) for frame in container.decode(video=0)]
    alpha = np.array(planes)[:, :, :854]
    np.testing.assert_array_equal(alpha, np.where(masks > 0, alpha.max(), 0))
    assert alpha.max() > 0


def test_binary_masks_are_black_and_white(cut, tmp_path):
    from PIL import Image

    saved, labels, _ = cut
    (path,) = export(saved, choose_formats(["binary"]), tmp_path)
    masks = [np.asarray(Image.open(path / f"{index}.png")) for index in range(NUM_FRAMES)]
    np.testing.assert_array_equal(masks, np.where(labels > 0, 255, 0))


@pytest.mark.parametrize("entry", [MATTE, PRORES, WEBM])
def test_an_own_video_is_replaced_and_another_one_kept(with_frames, tmp_path, entry):
    (path,) = export(with_frames, [entry], tmp_path)
    assert is_own_overlay(path)
    export(with_frames, [entry], tmp_path)
    path.write_bytes(b"precious")
    with pytest.raises(InputError, match="not known as moseg's own"):
        export(with_frames, [entry], tmp_path)
    assert path.read_bytes() == b"precious"


@pytest.mark.parametrize("entry", [PRORES, WEBM])
def test_a_cut_out_needs_the_frames(cut, tmp_path, entry):
    with pytest.raises(InputError, match=rf"needs the frames in {entry.name}; got masks alone; expected --video"):
        export(cut[0], [entry], tmp_path)
    assert not list(tmp_path.glob("cutout.*"))


def test_a_missing_encoder_is_found_before_the_work(monkeypatch):
    monkeypatch.setattr(av, "codecs_available", {"libx264"})
    choose_formats(["matte"])
    with pytest.raises(InputError, match=r"no ProRes encoder in PyAV .*; expected a build with prores_ks"):
        choose_formats(["prores"])


def test_only_formats_with_frames_need_them():
    assert {name for name, entry in FORMATS.items() if entry.needs_frames} == {"prores", "webm"}
    assert Encoding("x", "y", "z", "w").has_even_sizes
