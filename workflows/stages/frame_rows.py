"""Maps of frames in a row, which are read where a kernel indexes them: kernels of objects read few of their pixels."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from moseg.workflows.stages.inputs import ArtifactView
from moseg.workflows.stages.reduced_frame import reduced_levels


class FrameRows:
    """A read-only stack of maps, indexed like an array whose first axis counts frames.

    Parameters
    ----------
    shape : tuple of int
        Of the stack.
    read : function of a frame's index
        Returns its map.
    convert : function of an array
        Applied to what is indexed.
    """

    def __init__(
        self,
        shape: tuple[int, ...],
        read: Callable[[int], np.ndarray],
        convert: Callable[[np.ndarray], np.ndarray] = lambda part: part,
    ):
        self.shape = shape
        self._read = read
        self._convert = convert

    def __getitem__(self, index: tuple) -> np.ndarray:
        """Return a part: the first index is a frame or a slice of frames."""
        frame, *rest = index
        if isinstance(frame, slice):
            return np.stack([self[each, *rest] for each in range(*frame.indices(self.shape[0]))])
        return self._convert(self._read(frame)[tuple(rest)])


def reduced_images(frames: Sequence[ArtifactView], shape: tuple[int, int]) -> FrameRows:
    """Return the frames on the working grid of `shape`, uint8 (frame, y, x, rgb)."""
    return FrameRows((len(frames), *shape, 3), lambda frame: reduced_levels(frames[frame], shape))


def maps_of(artifacts: Sequence[ArtifactView], name: str) -> FrameRows:
    """Return float16 maps of one artifact a frame as float32 (frame, ...)."""
    from moseg.tasks.half_floats import to_float32

    @cache
    def read(frame: int) -> np.ndarray:
        return artifacts[frame].array(name)

    return FrameRows((len(artifacts), *artifacts[0].shape(name)), read, to_float32)
