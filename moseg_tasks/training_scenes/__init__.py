"""Random scenes with known moving pixels, three frames each, to train the motion network on.

A scene is a stack of flat layers under the image motion of a camera (Longuet-Higgins and Prazdny, 1980), rendered in a
tenth of a second. It is varied rather than realistic: the network sees motion and photometric error, no colour.
"""

from moseg.tasks.training_scenes.scene import TrainingScene, draw_scene
from moseg.tasks.training_scenes.textures import paint_textures

__all__ = ["TrainingScene", "draw_scene", "paint_textures"]
