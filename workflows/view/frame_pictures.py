"""Pictures of frames and of objects cut out of them, and labels, as the page reads them."""

import gzip

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.reports.timelines import cut_out
from moseg.workflows.view.shown_result import ShownResult

FRAME_QUALITY = 92
"""Of the JPEG of a frame, 0..100: masks are corrected on it by eye."""
THUMBNAIL_QUALITY = 80
COMPRESSION = 1
"""Of labels: runs of equal values are short at any level."""


def encode_jpeg(image: np.ndarray, quality: int = FRAME_QUALITY) -> bytes:
    """Return uint8 (y, x, 3) RGB as JPEG."""
    done, encoded = cv2.imencode(".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise InputError("a frame that cannot be encoded", got=image.shape)
    return encoded.tobytes()


def pack_labels(labels: np.ndarray) -> bytes:
    """Return labels (y, x) as rows of little-endian uint16, compressed by gzip."""
    return gzip.compress(labels.astype("<u2").tobytes(), COMPRESSION, mtime=0)


def draw_thumbnail(shown: ShownResult, identity: int, frame: int) -> bytes | None:
    """Return an object cut out of a frame as JPEG; None where the frame does not show it.

    An object that is not in the result is looked for among all that were proposed.
    """
    mask = shown.labels(frame) == identity
    if not mask.any():
        mask = shown.proposals(frame) == identity
    return encode_jpeg(cut_out(shown.image(frame), mask), THUMBNAIL_QUALITY) if mask.any() else None
