"""A static sequence from one picture: the picture is the texture of a smooth surface before a moving camera.

The surface is a ramp of inverse depth, as of ground (nearer at the bottom), with a few smooth bumps, so that no
homography explains its parallax. It is smooth and the motion small, so that no part hides another one, and each frame
is the picture seen through an invertible map. Inverse depth is relative: 1 at the bottom of the ramp, and positions of
the camera are in units of the depth there.
"""

from typing import NamedTuple

import cv2
import numpy as np
from pydantic import Field

from moseg.schemas.errors import InputError
from moseg.schemas.frozen import Frozen
from moseg.tasks.synthetic.paths import Path, Pose, Sway, compose, inverse, pose_of
from moseg.tasks.synthetic.scene import CameraPath

NUM_BUMPS = 4
MAX_ROUNDS = 30
TOLERANCE = 1e-3
"""Largest last step of the inversion of a map, px."""
BORDER = 3.0
"""Picture kept around the outermost sample, px: two for bicubic interpolation, one for the surface's curvature."""
GRID_STEP = 8
"""Distance of the points at which the largest displacement is sought, px."""
MIN_SIDE = 16
"""Shortest side of a frame, px."""


class Bump(Frozen):
    """A Gaussian added to the inverse depth; place and radius in widths of the picture, from its centre."""

    place: tuple[float, float]
    radius: float = Field(gt=0)
    height: float = Field(ge=0)


class PictureScene(Frozen):
    """A picture before a moving camera, which sees it unchanged in the middle of the sequence.

    Attributes
    ----------
    camera : CameraPath
        Position in depths of the ramp's bottom; the focal length is constant.
    far : float
        Inverse depth of the ramp's top; its bottom has 1.
    bumps : tuple of Bump
    """

    camera: CameraPath
    far: float = Field(0.15, gt=0, le=1)
    bumps: tuple[Bump, ...] = ()
    num_frames: int = Field(24, ge=2)


class _Map(NamedTuple):
    """Camera of one frame relative to the picture's, focal length (px) and the surface."""

    pose: Pose
    focal: float
    scene: PictureScene
    shape: tuple[int, int]


def draw_picture_scene(rng: np.random.Generator) -> PictureScene:
    """Draw a camera that moves sideways, forward, in an orbit or as hand-held, and the bumps of the surface."""
    speed, sign = rng.uniform(0.7, 1.2), rng.choice([-1.0, 1.0])
    position, turn = [
        (Path(velocity=(0.0045 * sign * speed, 0.0, 0.0)), Path()),
        (Path(velocity=(0.0, 0.0, 0.007 * speed)), Path()),
        # Points of inverse depth 0.5 stay about where they are: degrees per frame of a radius of 2.
        (
            Path(velocity=(0.006 * sign * speed, 0.0, 0.0)),
            Path(velocity=(0.0, float(np.degrees(-0.003 * sign * speed)), 0.0)),
        ),
        (
            Path(velocity=(0.0, 0.0, 0.003), sways=(Sway(amplitude=(0.02 * speed, 0.012, 0.0), period=13.0),)),
            Path(sways=(Sway(amplitude=(0.25, 0.3, 0.4), period=9.0, phase=0.3),)),
        ),
    ][rng.integers(4)]
    shake = Sway(amplitude=(0.08, 0.08, 0.1), period=7.3, phase=float(rng.random()))
    angles = turn.model_copy(update={"sways": (*turn.sways, shake)})
    bumps = tuple(
        Bump(
            place=(float(rng.uniform(-0.45, 0.45)), float(rng.uniform(-0.25, 0.25))),
            radius=float(rng.uniform(0.08, 0.18)),
            height=float(rng.uniform(0.1, 0.3)),
        )
        for _ in range(NUM_BUMPS)
    )
    return PictureScene(camera=CameraPath(position=position, angles=angles, focal=0.9), bumps=bumps)


def warp_picture(picture: np.ndarray, scene: PictureScene) -> np.ndarray:
    """Return the frames of a static sequence made from one picture.

    Parameters
    ----------
    picture : uint8 (y, x, 3)
        RGB.
    scene : PictureScene

    Returns
    -------
    uint8 (T, h, w, 3)
        RGB, bicubic samples of the picture. A frame is smaller than the picture by the `margin` on each side, so that
        no border shows.

    Raises
    ------
    InputError
        The picture is not uint8 (y, x, 3), or too small for the motion; or the surface would hide a part of itself.
    """
    if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8:
        got = f"{picture.dtype} {picture.shape}"
        raise InputError("not a picture", where="warp_picture", got=got, expected="uint8 (y, x, 3)")
    shape = picture.shape[:2]
    left, top = margin(scene, shape)
    height, width = shape[0] - 2 * top, shape[1] - 2 * left
    if min(height, width) < MIN_SIDE:
        got, expected = f"{shape[1]}x{shape[0]} px", f"{MIN_SIDE} px or more within margins of {left} and {top} px"
        raise InputError("picture is too small for the motion", where="warp_picture", got=got, expected=expected)
    x, y = np.meshgrid(np.arange(left, left + width, dtype=np.float32), np.arange(top, top + height, dtype=np.float32))
    frames = np.empty((scene.num_frames, height, width, 3), np.uint8)
    found = (x, y)
    for frame in range(scene.num_frames):
        found = _invert(_map_of(scene, shape, frame), x, y, found)
        frames[frame] = cv2.remap(picture, *found, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return frames


def margin(scene: PictureScene, shape: tuple[int, int]) -> tuple[int, int]:
    """Return the columns and rows of a picture of (height, width) `shape` that are cut from each side of the frames."""
    height, width = shape
    x, y = np.meshgrid(_spaced(width), _spaced(height))
    largest = np.zeros(2)
    for frame in range(scene.num_frames):
        x1, y1 = place_points(scene, shape, frame, x, y)
        largest = np.maximum(largest, (np.abs(x1 - x).max(), np.abs(y1 - y).max()))
    across, down = np.ceil(largest + BORDER)
    return int(across), int(down)


def place_points(
    scene: PictureScene, shape: tuple[int, int], frame: int, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the places in a frame of points of the picture.

    Parameters
    ----------
    scene : PictureScene
    shape : (int, int)
        Height and width of the picture, px.
    frame : int
    x, y : float array
        Picture coordinates, px, pixel centres at integers.

    Returns
    -------
    x, y : float array
        In the coordinates of the picture: the frames' own are less by the `margin`.
    """
    return _project(_map_of(scene, shape, frame), x, y)


def _map_of(scene: PictureScene, shape: tuple[int, int], frame: int) -> _Map:
    def camera(t: float) -> Pose:
        return pose_of(scene.camera.position.at(t), scene.camera.angles.at(t))

    moved = compose(inverse(camera(frame)), camera((scene.num_frames - 1) / 2))
    return _Map(moved, scene.camera.focal * shape[1], scene, shape)


def _inverse_depth(scene: PictureScene, shape: tuple[int, int], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    height, width = shape
    depth = scene.far + (1.0 - scene.far) / (height - 1) * y
    for bump in scene.bumps:
        dx = (x - (width - 1) / 2) / width - bump.place[0]
        dy = (y - (height - 1) / 2) / width - bump.place[1]
        depth = depth + bump.height * np.exp((dx * dx + dy * dy) * (-0.5 / bump.radius**2))
    return depth


def _project(view: _Map, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return ``K (R K^-1 x + rho t)`` of points of the picture with inverse depth rho."""
    rotation, translation = view.pose.rotation.tolist(), view.pose.translation.tolist()
    center = (view.shape[1] - 1) / 2, (view.shape[0] - 1) / 2
    rho = _inverse_depth(view.scene, view.shape, x, y)
    u, v = (x - center[0]) / view.focal, (y - center[1]) / view.focal
    px, py, pz = (
        row[0] * u + row[1] * v + row[2] + shift * rho for row, shift in zip(rotation, translation, strict=True)
    )
    return view.focal * px / pz + center[0], view.focal * py / pz + center[1]


def _invert(
    view: _Map, x: np.ndarray, y: np.ndarray, start: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of the picture that a frame shows at (x, y), by fixed-point iteration, float32."""
    found_x, found_y = start
    for _ in range(MAX_ROUNDS):
        seen_x, seen_y = _project(view, found_x, found_y)
        step_x, step_y = x - seen_x, y - seen_y
        found_x, found_y = found_x + step_x, found_y + step_y
        if max(np.abs(step_x).max(), np.abs(step_y).max()) < TOLERANCE:
            return found_x, found_y
    raise InputError("the surface hides a part of itself", where="warp_picture", expected="a smaller motion")


def _spaced(size: int) -> np.ndarray:
    """Return positions that include the first and the last pixel, px."""
    return np.linspace(0.0, size - 1, max(2, size // GRID_STEP + 2))
