"""OpenCV's decoding of images, of which not a word goes to standard error."""

from functools import partial

import cv2
import numpy as np

from moseg.workflows.sources.decoder_noise import listen_to


def decode_quietly(content: bytes, flags: int) -> tuple[np.ndarray | None, list[str]]:
    """What OpenCV decodes, and what the decoders below it have to complain of.

    Parameters
    ----------
    content : bytes
        Of the whole file.
    flags : int
        OpenCV's ``IMREAD_*``.

    Returns
    -------
    image : (y, x) or (y, x, channel), or None
        Colours in OpenCV's order; None where OpenCV cannot decode the bytes.
    complaints : list of str
        Lines of libpng and libjpeg.
    """
    return listen_to(partial(_decode, content, flags))


def _decode(content: bytes, flags: int) -> np.ndarray | None:
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        return cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error:
        return None
    finally:
        cv2.utils.logging.setLogLevel(level)
