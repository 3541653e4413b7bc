"""The ``synthetic`` data set: scenes declared as data, rendered with exact masks, flow, depth and tracks."""

from moseg_tasks.synthetic.camera import Camera, camera_at
from moseg_tasks.synthetic.render import RenderedScene, render_scene
from moseg_tasks.synthetic.scene import Scene
from moseg_tasks.synthetic.scenes import SCENES

__all__ = ["SCENES", "Camera", "RenderedScene", "Scene", "camera_at", "render_scene"]
