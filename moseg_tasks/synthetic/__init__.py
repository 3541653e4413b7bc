"""The ``synthetic`` data set: scenes declared as data and rendered with exact masks, flow, depth and tracks."""

from moseg.tasks.synthetic.render import RenderedScene, render_scene
from moseg.tasks.synthetic.scene import Scene
from moseg.tasks.synthetic.scenes import SCENES
from moseg.tasks.synthetic.scenes_still import STILL_SCENES
from moseg.tasks.synthetic.view import Camera, camera_at

__all__ = ["SCENES", "STILL_SCENES", "Camera", "RenderedScene", "Scene", "camera_at", "render_scene"]
