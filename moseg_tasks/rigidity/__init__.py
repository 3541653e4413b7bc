"""Deviation of point tracks from a rigid scene seen by a moving camera.

For each frame pair: the camera's motion (`relative_pose`), displacements split along and across epipolar lines
(`parallax`), the ground (`ground`), what stands on it (`contact`), medians over similar neighbours (`neighbours`) and a
look at the patches (`patch_test`); `evidence` combines them. The focal length is chosen first (`focal_length`).
"""

from moseg.tasks.rigidity.estimate import Rigidity, estimate_rigidity

__all__ = ["Rigidity", "estimate_rigidity"]
