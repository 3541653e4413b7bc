"""Inference of the motion network by OpenCV."""

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.tasks.motion_network.encoding import CHANNELS

STRIDE = 16
"""Sides of the network's input are multiples of this."""


def read_network(onnx: bytes) -> cv2.dnn.Net:
    """Read a network of the architecture of `MotionUNet` from the bytes of an ONNX file.

    Raises
    ------
    InputError
        It is no ONNX file, or not one that gives one logit a pixel for the channels of `encode_motion`.
    """
    expected = f"an ONNX file of {len(CHANNELS)} channels and one logit"
    try:
        network = cv2.dnn.readNetFromONNX(np.frombuffer(onnx, np.uint8))
        network.setInput(np.zeros((1, len(CHANNELS), STRIDE, STRIDE), np.float32))
        shape = network.forward().shape
    except cv2.error as error:
        raise InputError("not a motion network", got=error.err.strip().partition("\n")[0], expected=expected) from error
    if shape != (1, 1, STRIDE, STRIDE):
        raise InputError("not a motion network", got=f"output {shape}", expected=expected)
    return network


def motion_network_logit(network: cv2.dnn.Net, channels: np.ndarray) -> np.ndarray:
    """Return the logit of each pixel to move on its own.

    Parameters
    ----------
    network : cv2.dnn.Net
        Of `read_network`.
    channels : float16 or float32 (channel, y, x)
        Of `encode_motion`.

    Returns
    -------
    logit : float32 (y, x)
    """
    height, width = channels.shape[1:]
    sides = ((0, 0), (0, -height % STRIDE), (0, -width % STRIDE))
    padded = np.pad(channels.astype(np.float32), sides, mode="edge")
    network.setInput(np.ascontiguousarray(padded[None]))
    return network.forward()[0, 0, :height, :width].copy()
