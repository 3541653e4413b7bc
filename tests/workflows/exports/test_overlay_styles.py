"""Each style of overlay draws its parts, and the video plays in a browser."""

import base64
import io

import av
import cv2
import numpy as np
import pytest

from moseg.workflows.exports import (
    OverlayMode,
    OverlayStyle,
    draw_labels,
    draw_names,
    encode_overlay,
    identity_colours,
    write_overlay,
)
from moseg.workflows.exports.draw_names import label_of
from moseg.workflows.exports.draw_overlay import CUTOUT_DIMMING, draw_overlay

SHAPE = (40, 60)
COLOUR = (200, 100, 40)
BOX = np.s_[10:30, 20:50]
INSIDE, OUTSIDE = (20, 35), (3, 3)


@pytest.fixture
def image():
    return np.full((*SHAPE, 3), COLOUR, np.uint8)


@pytest.fixture
def labels():
    labels = np.zeros(SHAPE, np.uint16)
    labels[BOX] = 5
    return labels


def test_fill_tints_by_the_opacity_and_draws_no_line(image, labels):
    colour = identity_colours(np.uint16(5)).astype(float)
    for opacity in (0.0, 0.3, 1.0):
        drawn = draw_labels(image, labels, OverlayStyle(mode=OverlayMode.FILL, opacity=opacity))
        expected = (1 - opacity) * np.array(COLOUR) + opacity * colour
        np.testing.assert_allclose(drawn[BOX].reshape(-1, 3), np.tile(expected, (20 * 30, 1)), atol=1)
        np.testing.assert_array_equal(drawn[labels == 0], image[labels == 0])


@pytest.mark.parametrize("width", [1, 2, 3, 6])
def test_contour_draws_a_line_of_its_width_and_leaves_the_rest(image, labels, width):
    drawn = draw_labels(image, labels, OverlayStyle(mode=OverlayMode.CONTOUR, outline_width=width))
    changed = (drawn != image).any(axis=-1)
    assert changed[20].sum() == changed[:, 35].sum() == 2 * width
    assert {tuple(colour) for colour in drawn[changed].tolist()} == {tuple(identity_colours(np.uint16(5)).tolist())}


def test_no_outline_is_a_fill(image, labels):
    drawn = draw_labels(image, labels, OverlayStyle(outline_width=0))
    np.testing.assert_array_equal(drawn, draw_labels(image, labels, OverlayStyle(mode=OverlayMode.FILL)))


def test_mask_shows_the_identities_colours_on_black(image, labels):
    drawn = draw_labels(image, labels, OverlayStyle(mode=OverlayMode.MASK))
    np.testing.assert_array_equal(drawn, identity_colours(labels))


def test_cutout_keeps_the_objects_and_greys_the_rest(image, labels):
    drawn = draw_labels(image, labels, OverlayStyle(mode=OverlayMode.CUTOUT))
    np.testing.assert_array_equal(drawn[BOX], image[BOX])
    red, green, blue = drawn[OUTSIDE].tolist()
    assert red == green == blue == pytest.approx(CUTOUT_DIMMING * (0.299 * 200 + 0.587 * 100 + 0.114 * 40), abs=1)


@pytest.mark.parametrize("mode", OverlayMode)
def test_side_by_side_has_the_untouched_frame_at_the_left(image, labels, mode):
    style = OverlayStyle(mode=mode)
    both = draw_overlay(image, labels, style.model_copy(update={"is_side_by_side": True}))
    np.testing.assert_array_equal(both[:, :60], image)
    np.testing.assert_array_equal(both[:, 60:], draw_overlay(image, labels, style))


def test_numbers_lie_on_their_objects_and_inside_the_frame(image, labels):
    labels[:, :] = 0
    labels[0:6, 0:6], labels[25:40, 30:50] = 3, 12
    drawn = draw_overlay(image, labels, OverlayStyle(mode=OverlayMode.CONTOUR, outline_width=0, has_identities=True))
    rows, columns = np.nonzero((drawn > 200).all(axis=-1))
    assert (columns < 25).any() and (columns > 30).any()
    right = columns > 25
    assert rows[right].mean() == pytest.approx(32, abs=3)
    assert columns[right].mean() == pytest.approx(39.5, abs=3)
    assert min(rows.min(), columns.min()) > 0


NUMBERED = OverlayStyle(mode=OverlayMode.CONTOUR, outline_width=0, has_identities=True)


def _written(labels, name):
    """Return where a name, or the number of object 5 alone, is written, bool (y, x)."""
    image = np.zeros((*labels.shape, 3), np.uint8)
    return draw_overlay(image, labels, NUMBERED, {} if name is None else {5: name}).any(axis=-1)


@pytest.fixture(params=["OpenCV", "Pillow"])
def font(request, monkeypatch):
    """A source of the font: OpenCV before version 5 has none for all languages."""
    caches = (draw_names._draw_text, draw_names._has_glyph, draw_names._missing)
    if request.param == "OpenCV" and not hasattr(cv2, "FontFace"):
        pytest.skip("this OpenCV has no font for all languages")
    if request.param == "Pillow":
        monkeypatch.delattr(cv2, "FontFace", raising=False)
    for cache in caches:
        cache.cache_clear()
    yield request.param
    for cache in caches:
        cache.cache_clear()


@pytest.fixture
def large():
    labels = np.zeros((240, 640), np.uint16)
    labels[100:200, 200:500] = 5
    return labels


@pytest.mark.parametrize("name", ["bear", "<b>&amp;", "?"])
def test_a_name_stands_beside_the_number(font, large, name):
    alone, named = _written(large, None), _written(large, name)
    assert np.ptp(np.nonzero(named)[1]) > np.ptp(np.nonzero(alone)[1]) + 5
    assert not np.array_equal(named, _written(large, "other"))


@pytest.mark.parametrize(
    "name", ["ourse", "ours\u00e9", "\u718a", "\U0001f43b", "\u0645\u0631", "a\u202eb", "bear\uffff"]
)
def test_a_name_is_drawn_with_all_its_characters_or_not_at_all(font, large, name):
    label = label_of(5, name)
    assert label in ("5", f"5 {name}")
    assert (label == "5") == np.array_equal(_written(large, name), _written(large, None))
    assert not np.array_equal(_written(large, name), _written(large, "?" * len(name)))
    assert label_of(5, "ourse") == "5 ourse" and label_of(5, "\U0001f43b") == label_of(5, "a\u202eb") == "5"


@pytest.mark.skipif(not hasattr(cv2, "FontFace"), reason="this OpenCV has no font for all languages")
def test_names_in_other_scripts_are_drawn(large):
    names = [
        "\u718a",
        "\u043c\u0435\u0434\u0432\u0435\u0434\u044c",
        "\u03ac\u03c1\u03ba\u03c4\u03bf\u03c2",
        "\uacf0",
        "a\u00e9\u00f1\u00df",
    ]
    assert [label_of(5, name) for name in names] == [f"5 {name}" for name in names]
    assert len({_written(large, name).tobytes() for name in names}) == len(names)


def test_a_long_name_is_cut_and_stays_inside_the_frame(font, large):
    label = label_of(5, 40 * "m")
    assert len(label) == 24 and label.endswith("m\u2026")
    assert draw_overlay(np.zeros((20, 30, 3), np.uint8), large[90:110, 190:220], NUMBERED, {5: 40 * "m"}).shape == (
        20,
        30,
        3,
    )
    columns = np.flatnonzero(_written(large, 40 * "m").any(axis=0))
    assert columns[0] > 0 and columns[-1] < 639


def test_an_encoded_overlay_is_reduced_and_smaller_at_a_lower_quality(image, labels):
    rng = np.random.default_rng(0)
    frames = rng.integers(0, 256, (4, *SHAPE, 3)).astype(np.uint8)
    masks = np.stack([labels] * 4)
    fine, coarse = (encode_overlay(frames, masks, 10, crf=crf) for crf in (18, 40))
    assert len(coarse) < len(fine)
    small = encode_overlay(frames, masks, 10, max_side=30)
    assert _size(small) == (20, 30)
    assert _size(encode_overlay(frames, masks, 10, style=OverlayStyle(is_side_by_side=True))) == (40, 120)


def _size(content):
    with av.open(io.BytesIO(content)) as container:
        stream = container.streams.video[0]
        return stream.height, stream.width


@pytest.mark.parametrize("mode", OverlayMode)
def test_a_style_is_the_same_in_every_frame_and_run(image, labels, mode):
    style = OverlayStyle(mode=mode, has_identities=True)
    np.testing.assert_array_equal(draw_overlay(image, labels, style), draw_overlay(image, labels, style))


def test_the_video_plays_in_a_browser(new_page, tmp_path, image, labels):
    style = OverlayStyle(is_side_by_side=True)
    write_overlay(tmp_path / "overlay.mp4", [image] * 12, [labels] * 12, 24, style)
    source = base64.b64encode((tmp_path / "overlay.mp4").read_bytes()).decode()
    page = new_page()
    page.set_content(f'<video muted src="data:video/mp4;base64,{source}"></video>')
    played = page.evaluate(
        """async () => {
            const video = document.querySelector('video');
            await video.play();
            await new Promise(ended => video.addEventListener('ended', ended));
            return [video.duration, video.readyState, video.videoWidth, video.videoHeight, video.error];
        }"""
    )
    page.close()
    assert played[0] == pytest.approx(0.5, abs=0.05)
    assert played[1] >= 2
    assert played[2:] == [120, 40, None]
