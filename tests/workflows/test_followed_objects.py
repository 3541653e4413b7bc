"""Objects that rest, hide or are small, from frames to identities, on painted scenes with a moving camera."""

import json
from typing import NamedTuple

import cv2
import numpy as np
import pytest

from moseg import segment_video

HEIGHT, WIDTH = 120, 200
RED, BLUE, DARK = ((150, 40, 30), (230, 90, 60)), ((40, 40, 120), (110, 90, 220)), ((30, 30, 60), (90, 90, 140))


def paint(rng, height, width, colours, blur=1.5):
    """A texture between two colours, float32 (height, width, 3)."""
    low, high = (np.array(colour, np.float32) for colour in colours)
    pattern = cv2.GaussianBlur(rng.standard_normal((height, width, 3)).astype(np.float32), (0, 0), blur)
    return np.clip((low + high) / 2 + pattern / pattern.std() * (high - low) / 4, 0, 255)


class Sprite(NamedTuple):
    """An ellipse, or a box that never moves, of (width, height) whose centre is at path(frame) in the world."""

    size: tuple[int, int]
    path: object
    colours: tuple
    is_box: bool = False


def render(sprites, num_frames, camera=0.5):
    """Frames, and the label of each moving sprite, before a wall along which the camera moves; the last is nearest."""
    rng = np.random.default_rng(3)
    wall = paint(rng, HEIGHT + 20, WIDTH + 80, ((70, 90, 70), (150, 160, 140)), 2)
    skins = [paint(rng, height, width, colours) for (width, height), _, colours, _ in sprites]
    frames, labels = [], []
    for t in range(num_frames):
        image, label = _place(wall, -10 - camera * t, -10), np.zeros((HEIGHT, WIDTH), np.uint8)
        for number, (sprite, skin) in enumerate(zip(sprites, skins, strict=True), start=1):
            (width, height), (x, y) = sprite.size, sprite.path(t)
            v, u = np.mgrid[:height, :width].astype(np.float32)
            shape = np.hypot((2 * u + 1) / width - 1, (2 * v + 1) / height - 1) < 1
            corner = x - width / 2 - camera * t, y - height / 2
            cover = _place((shape | sprite.is_box).astype(np.float32), *corner)
            image += (_place(skin, *corner, cv2.BORDER_REPLICATE) - image) * cover[..., None]
            label[cover > 0.5] = 0 if sprite.is_box else number
        noisy = image + rng.normal(0, 1, image.shape)
        frames.append(np.clip(np.rint(noisy), 0, 255).astype(np.uint8))
        labels.append(label)
    return np.stack(frames), np.stack(labels)


def render_disc(num_frames, diameter, x, blur):
    """Frames and labels of a disc of a diameter, whose centre is at x, both functions of the frame, before a wall."""
    rng = np.random.default_rng(3)
    wall = paint(rng, HEIGHT + 20, WIDTH + 80, ((70, 90, 70), (150, 160, 140)), 2)
    side = 400
    skin, centre = paint(rng, side, side, RED, blur), (side - 1) / 2
    v, u = np.mgrid[:side, :side]
    disc = (np.hypot(u - centre, v - centre) < centre).astype(np.float32)
    frames, labels = [], []
    for t in range(num_frames):
        scale, corner = diameter(t) / side, (x(t) - diameter(t) / 2, 60 - diameter(t) / 2)
        matrix = np.float32([[scale, 0, corner[0]], [0, scale, corner[1]]])
        cover = cv2.warpAffine(disc, matrix, (WIDTH, HEIGHT))
        surface = cv2.warpAffine(skin, matrix, (WIDTH, HEIGHT), borderMode=cv2.BORDER_REPLICATE)
        image = _place(wall, -10 - 0.5 * t, -10)
        image += (surface - image) * cover[..., None]
        frames.append(np.clip(np.rint(image + rng.normal(0, 1, image.shape)), 0, 255).astype(np.uint8))
        labels.append((cover > 0.5).astype(np.uint8))
    return np.stack(frames), np.stack(labels)


def render_approach(num_frames=52, near=20):
    """Frames and labels of a disc that comes near, fills the frame for more than twelve frames, and leaves again."""

    def diameter(t):
        return 40 * np.exp(0.1 * min(t, near, num_frames - 1 - t))

    def x(t):
        return 92 + 1.5 * min(max(t - near, 0), num_frames - 2 * near - 1)

    return render_disc(num_frames, diameter, x, blur=6)


def _place(picture, x, y, border=cv2.BORDER_CONSTANT):
    return cv2.warpAffine(picture, np.float32([[1, 0, x], [0, 1, y]]), (WIDTH, HEIGHT), borderMode=border)


def overlap(found, true):
    """Mean IoU over the frames in which something is true."""
    shown = true.any(axis=(1, 2))
    return ((found & true).sum((1, 2))[shown] / (found | true).sum((1, 2))[shown]).mean()


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """An ellipse that moves for 14 of 50 frames and rests."""
    frames, labels = render([Sprite((40, 34), lambda t: (40 + 3 * min(t, 14), 65), RED)], 50)
    return segment_video(frames, store=tmp_path_factory.mktemp("stopped")), labels


def test_what_was_seen_moving_stays_an_object_while_it_rests(stopped):
    result, labels = stopped
    (found,) = result.objects
    assert (found.first_frame, found.last_frame) == (0, 49)
    assert overlap(result.labels[30:] > 0, labels[30:] > 0) > 0.9


def test_it_is_reported_in_which_frames_it_moves(stopped):
    (found,) = stopped[0].objects
    ((first, last),) = found.moving_frames
    assert first == 0 and last in (13, 14, 15)
    assert found.moves_now(5) and not found.moves_now(40)
    (line,) = stopped[0].look_at
    assert line.startswith("object 1 stops: it rests in frames 1") and line.endswith("to 49")


def test_an_object_that_is_found_whole_is_sure_and_complete_in_each_frame(stopped):
    result, labels = stopped
    (found,) = result.objects
    assert found.per_frame.frame == tuple(range(50))
    assert 0.8 < found.sure <= 1 and 0.8 < found.complete <= 1
    assert len(found.per_frame.sure) == len(found.per_frame.complete) == 50
    truth = (labels > 0).mean(axis=(1, 2))
    np.testing.assert_allclose(found.per_frame.area_fraction, truth, rtol=0.25)


def test_an_object_that_hides_for_a_second_has_its_identity_back(tmp_path):
    pillar = Sprite((76, 116), lambda t: (115, 60), DARK, is_box=True)
    frames, labels = render([Sprite((30, 28), lambda t: (28 + 3.5 * t, 60), RED), pillar], 52)
    hidden = np.flatnonzero(~labels.any(axis=(1, 2)))
    result = segment_video(frames, store=tmp_path)
    (found,) = result.objects
    assert len(hidden) > 10 and found.first_frame < hidden[0] and found.last_frame > hidden[-1]
    assert found.num_frames < 52 - len(hidden) / 2


def test_frames_that_an_object_fills_are_filled_from_those_before_and_after(tmp_path):
    frames, labels = render_approach()
    is_filled = labels.mean(axis=(1, 2)) > 0.95
    result = segment_video(frames, store=tmp_path)
    assert is_filled.sum() >= 12 and len(result.objects) == 1
    assert overlap(result.labels[is_filled] > 0, labels[is_filled] > 0) > 0.8


def test_a_small_object_is_found_beside_a_large_one_of_another_motion(tmp_path):
    large = Sprite((110, 70), lambda t: (64 + 1.6 * t, 80), RED)
    small = Sprite((26, 22), lambda t: (160 - 1.5 * t, 22), BLUE)
    frames, labels = render([large, small], 20)
    result = segment_video(frames, store=tmp_path)
    assert len(result.objects) == 2 and {found.motion for found in result.objects} == {1, 2}
    by_size = sorted(result.objects, key=lambda found: -found.mean_area_fraction)
    for number, found in enumerate(by_size, start=1):
        assert overlap(result.labels == found.identity, labels == number) > 0.8


def test_what_goes_away_is_no_doubt(tmp_path, moseg):
    folder, store = tmp_path / "frames", tmp_path / "store"
    folder.mkdir()
    # From frame 10 on, it halves its area in eight frames.
    frames, _ = render_disc(36, lambda t: 90 * 2 ** (-max(t - 10, 0) / 16), lambda t: 70 + 1.5 * t, blur=9)
    for number, frame in enumerate(frames):
        cv2.imwrite(str(folder / f"{number:03}.png"), frame[..., ::-1])
    result = segment_video(folder, store=store)
    (found,) = result.objects
    area = found.per_frame.area_fraction
    assert max(area) / area[-1] > 2.5 and found.num_frames == 36
    moseg("segment", str(folder), "--store", str(store), "--out", str(tmp_path / "out"))
    written = json.loads((tmp_path / "out" / "motion.json").read_text())
    assert list(result.look_at) == written["look_at"]
    assert not any("loses half its area" in line for line in result.look_at)
