"""A static sequence made from one picture."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.tasks.synthetic.warped_picture import PictureScene, draw_picture_scene, margin, warp_picture
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.frames import FrameDescription
from moseg.workflows.sources.image_files import DECODING_VERSION, decode_image
from moseg.workflows.sources.resize import shrink_to, working_size

WARP_VERSION = 2
"""Raised when `draw_picture_scene` or `warp_picture` gives other frames for the same picture."""


@dataclass(frozen=True)
class WarpedPicture:
    """Frames of a camera that moves before a picture, with motion and depth drawn from the file's content.

    Attributes
    ----------
    path : str
        An image file.
    max_side : int
        A picture whose longer side exceeds it is area-resized to it before it is warped, px.
    """

    path: str
    max_side: int

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes, of the decode parameters and of the versions of decoder and warp."""
        params = [WARP_VERSION, DECODING_VERSION, self.max_side, digest_file(self.path)]
        return digest_json("source", ["warped picture", *params])

    def read(self) -> Iterator[np.ndarray]:
        """Yield each frame as uint8 (y, x, 3) RGB; raise InputError for a file that cannot be a frame."""
        yield from warp_picture(self._picture(), self._scene())

    def describe(self) -> FrameDescription:
        """Return the size of the frames, which is that of the working picture less its margins."""
        height, width = self._picture().shape[:2]
        across, down = margin(self._scene(), (height, width))
        return FrameDescription((height - 2 * down, width - 2 * across), None)

    def num_frames(self) -> int:
        """Return the number of frames."""
        return self._scene().num_frames

    def chunks(self, size: int) -> tuple["WarpedPicture", ...]:
        """Return the source itself: the picture is decoded once for all frames."""
        return (self,)

    def _picture(self) -> np.ndarray:
        picture = decode_image(read_bytes(self.path), self.path)
        return shrink_to(picture, working_size(picture.shape[:2], self.max_side))

    def _scene(self) -> PictureScene:
        return draw_picture_scene(np.random.default_rng(int(digest_file(self.path), 16)))
