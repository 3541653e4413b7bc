"""Random crops of a video's frames and labels, with changes of size, colour and sharpness."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import VideoNetworkParams
from moseg.tasks.video_network.labels import IGNORED

_MIDDLE = 128
_RANGE = np.array([64, 24, 24], np.float32)  # of L, a and b, which differ in how far they vary
_SHARE_BLURRED = 0.3
_BLUR = (0.3, 1.2)


class Crop(NamedTuple):
    """Input float32 (y, x, Lab) of the network, and its labels uint8 (y, x)."""

    colours: np.ndarray
    labels: np.ndarray


def lab_bytes(image: np.ndarray) -> np.ndarray:
    """Return an RGB image uint8 (y, x, 3) in CIELAB, uint8."""
    return cv2.cvtColor(image, cv2.COLOR_RGB2LAB)


def network_input(lab: np.ndarray) -> np.ndarray:
    """Return the network's input float32 (y, x, 3), about -2..2, of an image of `lab_bytes`."""
    return (lab.astype(np.float32) - _MIDDLE) / _RANGE


def draw_crop(lab: np.ndarray, labels: np.ndarray, rng: np.random.Generator, params: VideoNetworkParams) -> Crop:
    """Draw a crop of a random frame.

    Parameters
    ----------
    lab : uint8 (T, y, x, 3)
        Of `lab_bytes`.
    labels : uint8 (T, y, x)
        Of `sure_labels`.
    rng : numpy.random.Generator
    params : VideoNetworkParams
    """
    frame = rng.integers(len(lab))
    height, width = labels.shape[1:]
    zoom = np.exp(rng.uniform(*np.log((params.min_zoom, params.max_zoom))))
    seen_height, seen_width = min(params.crop_height / zoom, height), min(params.crop_width / zoom, width)
    scale_y, scale_x = seen_height / params.crop_height, seen_width / params.crop_width
    top, left = rng.uniform(0, height - seen_height), rng.uniform(0, width - seen_width)
    if rng.random() < 0.5:
        scale_x, left = -scale_x, left + seen_width
    # From the pixel of the crop to that of the frame; pixel centres at integers.
    place = np.array([[scale_x, 0, left + scale_x / 2 - 0.5], [0, scale_y, top + scale_y / 2 - 0.5]])
    size = (params.crop_width, params.crop_height)
    colours = cv2.warpAffine(
        lab[frame], place, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )
    cut = cv2.warpAffine(
        labels[frame], place, size, flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP, borderValue=IGNORED
    )
    return Crop(_disturb(network_input(colours), rng, params), cut)


def _disturb(colours: np.ndarray, rng: np.random.Generator, params: VideoNetworkParams) -> np.ndarray:
    """Change contrast, brightness and colour of a crop, and add blur and noise."""
    gain = rng.uniform(1 - params.colour_gain, 1 + params.colour_gain, 3).astype(np.float32)
    shift = rng.normal(0, params.colour_shift, 3).astype(np.float32) if params.colour_shift else np.float32(0)
    colours = colours * gain + shift
    if rng.random() < _SHARE_BLURRED:
        colours = cv2.GaussianBlur(colours, (0, 0), rng.uniform(*_BLUR))
    noise = rng.standard_normal(colours.shape, np.float32)
    return colours + noise * np.float32(rng.uniform(0, params.max_noise))
