"""Dense inverse search (DIS) optical flow."""

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowParams
from moseg.tasks.check_frame import check_frame

_PRESETS = {
    "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
    "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
    "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    "fine": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
}
# An 8 px patch on the presets' finest level, a quarter of full size. Below it OpenCV raises, returns NaN or crashes.
_MIN_SIDE = 32


def estimate_flow(image0: np.ndarray, image1: np.ndarray, params: FlowParams) -> np.ndarray:
    """Estimate the flow that maps each pixel of `image0` to its position in `image1`.

    Frames with a side under 32 px are extended by replicating their border, and the flow is cropped.

    Parameters
    ----------
    image0, image1 : uint8 (y, x, 3)
        RGB frames of one size.
    params : FlowParams
        `preset` is the trade of speed for accuracy.

    Returns
    -------
    flow : float32 (y, x, 2)
        xy displacement, px/frame.

    Raises
    ------
    InputError
        The images are not two uint8 RGB frames of one size.

    References
    ----------
    Kroeger, Timofte, Dai, Van Gool, "Fast Optical Flow using Dense Inverse Search", ECCV 2016.
    """
    check_frame(image0, "image0")
    check_frame(image1, "image1")
    if image0.shape != image1.shape:
        raise InputError("frames of a pair differ in size", got=image1.shape[:2], expected=image0.shape[:2])
    height, width = image0.shape[:2]
    search = cv2.DISOpticalFlow_create(_PRESETS[params.preset])
    if params.preset == "fine":
        # The other presets end at half or a quarter of full size and enlarge the flow.
        search.setFinestScale(0)
    flow = search.calc(_searchable_gray(image0), _searchable_gray(image1), None)
    return np.ascontiguousarray(flow[:height, :width])


def _searchable_gray(image: np.ndarray) -> np.ndarray:
    """Convert to grey levels, extended below and to the right to the smallest side that DIS can search."""
    height, width = image.shape[:2]
    gray = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    below, right = max(_MIN_SIDE - height, 0), max(_MIN_SIDE - width, 0)
    return cv2.copyMakeBorder(gray, 0, below, 0, right, cv2.BORDER_REPLICATE) if below or right else gray
