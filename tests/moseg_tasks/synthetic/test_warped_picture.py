"""A picture before a moving camera: its points move as the ramp of depth and the camera say, and no border shows."""

import cv2
import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.synthetic.paths import Path
from moseg.tasks.synthetic.scene import CameraPath
from moseg.tasks.synthetic.warped_picture import (
    Bump,
    PictureScene,
    draw_picture_scene,
    margin,
    place_points,
    warp_picture,
)

SHAPE = HEIGHT, WIDTH = 81, 121
FOCAL, MIDDLE = 0.9 * WIDTH, 4
BUMP = Bump(place=(0.1, 0.05), radius=0.12, height=0.3)
Y, X = np.mgrid[:HEIGHT, :WIDTH].astype(float)


def scene(velocity=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0), **fields):
    camera = CameraPath(position=Path(velocity=velocity), angles=Path(velocity=turn), focal=0.9)
    return PictureScene(camera=camera, num_frames=2 * MIDDLE + 1, **fields)


def inverse_depth(far=0.15, bump=None):
    """Ramp and bump, written again."""
    depth = far + (1 - far) * Y / (HEIGHT - 1)
    if bump is None:
        return depth
    x, y = bump.place[0] * WIDTH + (WIDTH - 1) / 2, bump.place[1] * WIDTH + (HEIGHT - 1) / 2
    square = ((X - x) ** 2 + (Y - y) ** 2) / (bump.radius * WIDTH) ** 2
    return depth + bump.height * np.exp(-square / 2)


@pytest.mark.parametrize("frame", [0, 3, 8])
def test_a_sideways_camera_moves_points_by_their_inverse_depth(frame):
    moved = scene((0.01, 0.0, 0.0), bumps=(BUMP,))
    x, y = place_points(moved, SHAPE, frame, X, Y)
    np.testing.assert_allclose(x - X, -FOCAL * 0.01 * (frame - MIDDLE) * inverse_depth(bump=BUMP), atol=1e-9)
    np.testing.assert_allclose(y, Y, atol=1e-9)


def test_a_forward_camera_moves_points_away_from_the_centre():
    x, y = place_points(scene((0.0, 0.0, 0.01)), SHAPE, 7, X, Y)
    growth = 1 / (1 - 0.03 * inverse_depth())
    np.testing.assert_allclose(x - 60, (X - 60) * growth, atol=1e-9)
    np.testing.assert_allclose(y - 40, (Y - 40) * growth, atol=1e-9)


def test_a_turning_camera_moves_points_whatever_their_depth():
    turned = {"turn": (0.1, 0.2, 0.3)}
    plain, bumpy = (place_points(scene(**turned, **given), SHAPE, 7, X, Y) for given in ({}, {"bumps": (BUMP,)}))
    np.testing.assert_allclose(plain, bumpy, atol=1e-9)
    assert np.abs(plain[0] - X).max() > 1


@pytest.mark.parametrize("velocity", [(0.01, 0.0, 0.0), (0.004, -0.005, 0.01)])
def test_frames_show_each_point_of_the_picture_at_its_place(velocity):
    """Check pixels, not maps: on a picture whose colours are its coordinates, a frame's colours name points."""
    moved = scene(velocity, (0.05, 0.1, 0.1), bumps=(BUMP,))
    picture = np.stack([2 * X, 3 * Y, X + Y], axis=-1).astype(np.uint8)
    left, top = margin(moved, SHAPE)
    for frame, image in enumerate(warp_picture(picture, moved)):
        shown_x, shown_y = image[..., 0] / 2, image[..., 1] / 3
        x, y = place_points(moved, SHAPE, frame, shown_x, shown_y)
        rows, columns = np.mgrid[: image.shape[0], : image.shape[1]]
        assert np.abs(x - left - columns).max() < 0.35
        assert np.abs(y - top - rows).max() < 0.35


def test_the_camera_sees_the_picture_itself_in_the_middle():
    picture = np.random.default_rng(0).integers(0, 256, (*SHAPE, 3), np.uint8)
    moved = scene((0.01, 0.0, 0.0))
    left, top = margin(moved, SHAPE)
    frames = warp_picture(picture, moved)
    np.testing.assert_array_equal(frames[MIDDLE], picture[top:-top, left:-left])
    assert (frames[0] != frames[MIDDLE]).any()


@pytest.mark.parametrize("seed", range(12))
def test_no_border_shows_and_no_homography_explains_the_parallax(seed):
    """Check drawn scenes: a frame of pale pixels within a dark border must not show the border."""
    drawn = draw_picture_scene(np.random.default_rng(seed))
    picture = np.full((120, 214, 3), 200, np.uint8)
    picture[[0, -1]] = picture[:, [0, -1]] = 0
    frames = warp_picture(picture, drawn)
    assert len(frames) == 24 and (frames == 200).all()
    assert frames.shape[1] > 90 and frames.shape[2] > 170
    y, x = np.mgrid[:120:8, :214:8].astype(float)
    places = (np.stack(place_points(drawn, (120, 214), frame, x, y), axis=-1).reshape(-1, 2) for frame in (0, 23))
    start, end = places
    homography, _ = cv2.findHomography(start, end)
    assert np.abs(cv2.perspectiveTransform(start[None], homography)[0] - end).max() > 0.5


def test_frames_depend_on_the_picture_and_the_seed_alone():
    picture = np.random.default_rng(1).integers(0, 256, (90, 160, 3), np.uint8)
    first, again, other = (warp_picture(picture, draw_picture_scene(np.random.default_rng(seed))) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert first.shape != other.shape or (first != other).any()


@pytest.mark.parametrize(
    ("picture", "moved", "message"),
    [
        (np.zeros((40, 50), np.uint8), scene(), "not a picture"),
        (np.zeros((18, 30, 3), np.uint8), scene((0.02, 0.02, 0.0)), "too small for the motion"),
        (
            np.zeros((400, 400, 3), np.uint8),
            scene((0.1, 0.0, 0.0), bumps=(BUMP.model_copy(update={"radius": 0.01}),)),
            "hides a part",
        ),
    ],
)
def test_what_gives_no_frames_is_refused(picture, moved, message):
    with pytest.raises(InputError, match=message):
        warp_picture(picture, moved)
