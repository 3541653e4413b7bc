"""Deviation of point tracks from a rigid scene seen by a moving camera.

The focal length is chosen first (`focal_length`). Then, for each frame pair:

1. `relative_pose` or `given_camera`: the camera's motion; `parallax`: displacements split along and across its
   epipolar lines.
2. `ground` and `contact`, or `given_depth`: how far along them a static point may be (`deviation`).
3. `neighbours`: medians over similar neighbours.
4. `patch_test`: whether a rigid position explains the patch as well.

`evidence` combines these into one error per track, `estimate` runs over the pairs of a window.
"""

from moseg.tasks.rigidity.estimate import TRACK_EVIDENCE, GivenCameras, Rigidity, estimate_rigidity

__all__ = ["TRACK_EVIDENCE", "GivenCameras", "Rigidity", "estimate_rigidity"]
