"""Frames on the working grid, which several stages read."""

from functools import partial

import numpy as np

from moseg.workflows.stages.inputs import ArtifactView


def reduced_levels(frame: ArtifactView, shape: tuple[int, int]) -> np.ndarray:
    """Return a frame on the working grid of `shape`, uint8 (y, x, rgb), read-only; it is made once in a process."""
    from moseg.tasks.frame_grid import resample

    height, width = shape
    return frame.derived("image", f"{height}x{width}", partial(resample, shape=(height, width)))
