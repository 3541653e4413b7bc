"""A scene at one instant in its camera: poses of the parts, and projections of their material points."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.synthetic.paths import Pose, Vector, compose, inverse, pose_of
from moseg.tasks.synthetic.scene import CameraPath, Part, Scene
from moseg.tasks.synthetic.shapes import NEAREST_DEPTH, Billboard, Rays


class Camera(NamedTuple):
    """Pose (camera to world), focal length and principal point, px."""

    pose: Pose
    focal: float
    center: tuple[float, float]


def camera_at(path: CameraPath, t: float, height: int, width: int) -> Camera:
    """Return the camera at time ``t``, frames, for frames of the given size, px."""
    focal = path.focal * width * (1.0 + path.zoom * t)
    return Camera(pose_of(path.position.at(t), path.angles.at(t)), focal, ((width - 1) / 2.0, (height - 1) / 2.0))


class View(NamedTuple):
    """A camera and, for each part of the scene, its pose (local to camera coordinates) and its bend."""

    camera: Camera
    parts: tuple[Part, ...]
    poses: tuple[Pose, ...]
    bends: tuple[Vector, ...]


def view_at(scene: Scene, t: float) -> View:
    """Return the scene at time ``t``, frames; parts in the order backdrop, then each object's."""
    camera = camera_at(scene.camera, t, scene.height, scene.width)
    to_camera = inverse(camera.pose)
    parts = list(scene.backdrop)
    poses = [compose(to_camera, _part_pose(part, t)) for part in scene.backdrop]
    for thing in scene.things:
        carried = compose(to_camera, pose_of(thing.position.at(t), thing.angles.at(t)))
        parts.extend(thing.parts)
        poses.extend(compose(carried, _part_pose(part, t)) for part in thing.parts)
    bends = [part.shape.bend.at(t) if isinstance(part.shape, Billboard) else (0.0, 0.0, 0.0) for part in parts]
    return View(camera, tuple(parts), tuple(poses), tuple(bends))


def object_of_parts(scene: Scene) -> np.ndarray:
    """Return the identity of each part's object, uint16 (parts,), in the order of `view_at`."""
    owners = [0] * len(scene.backdrop)
    for identity, thing in enumerate(scene.things, start=1):
        owners.extend([identity] * len(thing.parts))
    return np.array(owners, np.uint16)


def rays_at(view: View, part: int, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Rays]:
    """Return origin and directions, in a part's local coordinates, of rays through pixels, with depth as parameter."""
    rotation = view.poses[part].rotation
    focal, center = view.camera.focal, view.camera.center
    x, y = (x - center[0]) / focal, (y - center[1]) / focal
    origin = inverse(view.poses[part]).translation
    return origin, tuple(rotation[0, axis] * x + (rotation[1, axis] * y + rotation[2, axis]) for axis in range(3))


def material_points(view: View, part: int, x: np.ndarray, y: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return material coordinates, float64 (N, 3), of the points of a part seen at pixels (N,) and depths (N,)."""
    origin, direction = rays_at(view, part, x, y)
    points = np.stack([start + depth * along for start, along in zip(origin, direction, strict=True)], axis=1)
    shape = view.parts[part].shape
    return shape.bent(points, view.bends[part], -1.0) if isinstance(shape, Billboard) else points


def project_points(view: View, part: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return pixels x, y and depths, float64 (N,) each, of material points (N, 3) of a part.

    A point that is not in front of the camera gets ``NEAREST_DEPTH``, at which nothing is ever seen.
    """
    shape = view.parts[part].shape
    local = shape.bent(points, view.bends[part]) if isinstance(shape, Billboard) else points
    rotation, translation = view.poses[part]
    x, y, z = (
        rotation[row, 0] * local[:, 0] + rotation[row, 1] * local[:, 1] + rotation[row, 2] * local[:, 2] + shift
        for row, shift in enumerate(translation)
    )
    z = np.maximum(z, NEAREST_DEPTH)
    focal, center = view.camera.focal, view.camera.center
    return focal * x / z + center[0], focal * y / z + center[1], z


def _part_pose(part: Part, t: float) -> Pose:
    pivot = pose_of(part.position.at(t), part.angles.at(t))
    return compose(pivot, Pose(np.eye(3), np.array(part.offset, np.float64)))
