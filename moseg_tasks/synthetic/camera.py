"""The pinhole camera of a scene at one instant."""

from typing import NamedTuple

from moseg.tasks.synthetic.paths import Pose, pose_of
from moseg.tasks.synthetic.scene import CameraPath


class Camera(NamedTuple):
    """Pose (camera to world), focal length and principal point, px."""

    pose: Pose
    focal: float
    center: tuple[float, float]


def camera_at(path: CameraPath, t: float, height: int, width: int) -> Camera:
    """The camera at time ``t``, frames, for frames of the given size, px."""
    focal = path.focal * width * (1.0 + path.zoom * t)
    return Camera(pose_of(path.position.at(t), path.angles.at(t)), focal, ((width - 1) / 2.0, (height - 1) / 2.0))
