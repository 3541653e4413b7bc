"""Cameras of the frames of a video, and the depth that they see, by a network that relates several views."""

from moseg.tasks.cameras.estimate import PairCameras, estimate_cameras

__all__ = ["PairCameras", "estimate_cameras"]
