"""Input of the motion network: deviations of a frame's flow from the background's, free of scale."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
import poselib

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.frame_grid import reduced_shape
from moseg.tasks.half_floats import to_float16
from moseg.tasks.saliency.background import AffineMotion, affine_flow, fit_background, sample_flow
from moseg.tasks.saliency.grid import vector_length, warp
from moseg.tasks.saliency.photometric import colour_error

GRID_SIDE = 213
"""Longer side of the network's grid, px; smaller working grids are not enlarged."""
PER_DIRECTION = (
    "residual_u",
    "residual_v",
    "relative_u",
    "relative_v",
    "remainder",
    "flow_u",
    "flow_v",
    "background_error",
    "observed_error",
    "inconsistency",
    "epipolar",
)
"""Channels of each time direction."""
CHANNELS = (*(f"{name}_{side}" for side in ("previous", "next") for name in PER_DIRECTION), "noise", "height")
_SIGNED = [index for index, name in enumerate(PER_DIRECTION) if name.endswith(("_u", "_v"))]
_ERROR_OFFSET = 4.0  # grey levels: error of a pixel whose motion is right
_CONTRAST = np.float32(3.0)  # of flow relative to the largest in the frame
_EPIPOLAR_STEP = 20  # px between the points of the fundamental matrix
_LIMIT = 8.0  # of every channel


class Neighbour(NamedTuple):
    """Previous or next frame, on the working grid.

    Attributes
    ----------
    image : float32 (h, w, 3)
        Grey levels 0..255.
    flow : float32 (h, w, 2)
        From the frame looked at to this one, px.
    back : float32 (h, w, 2)
        From this one to the frame looked at, px.
    residual : float32 (h, w, 2)
        `flow` less the flow of the chosen background: of one or two layers, or of a rigid scene.
    first_layer : AffineMotion, optional
        The background's motion that most of `flow` follows; fitted again if it is not given.
    """

    image: np.ndarray
    flow: np.ndarray
    back: np.ndarray
    residual: np.ndarray
    first_layer: AffineMotion | None = None


def encode_motion(
    image: np.ndarray, previous: Neighbour | None, next: Neighbour | None, params: SaliencyParams
) -> np.ndarray:
    """Encode the motion of a frame against its background.

    Parameters
    ----------
    image : float32 (h, w, 3)
        The frame on the working grid, grey levels 0..255.
    previous, next : Neighbour or None
        At the ends of a video the neighbour on the other side stands for the missing one.
    params : SaliencyParams
        Those of the fits of the background.

    Returns
    -------
    channels : float16 (len(CHANNELS), grid y, grid x)
        In -8..8; zeros without any neighbour.
    """
    shape = reduced_shape(image.shape[:2], GRID_SIDE)
    encoded, noises = [], []
    for neighbour, sign in ((previous, -1.0), (next, 1.0)):
        if neighbour is not None:
            channels, noise = _encode_direction(image, neighbour, params, shape)
            channels[..., _SIGNED] *= np.float32(sign)
            encoded.append(channels)
            noises.append(noise)
    if not encoded:
        return np.zeros((len(CHANNELS), *shape), np.float16)
    noise = np.full((*shape, 1), np.log(np.mean(noises)), np.float32)
    height = np.broadcast_to(np.linspace(-1, 1, shape[0], dtype=np.float32)[:, None, None], (*shape, 1))
    stacked = np.concatenate([encoded[0], encoded[-1], noise, height], axis=-1)
    return to_float16(np.ascontiguousarray(np.clip(stacked, -_LIMIT, _LIMIT).transpose(2, 0, 1)))


def _encode_direction(
    image: np.ndarray, neighbour: Neighbour, params: SaliencyParams, shape: tuple[int, int]
) -> tuple[np.ndarray, float]:
    """Return the channels float32 (grid y, grid x, channel) of one direction, and the noise of its flow, px."""
    flow = neighbour.flow
    motion = neighbour.first_layer or fit_background(flow, params)
    first = flow - affine_flow(motion, flow.shape[:2])
    noise = np.float32(motion.scale)
    background_error, observed_error = (
        cv2.log(colour_error(image, neighbour.image, by) * np.float32(1 / _ERROR_OFFSET) + 1)
        for by in (flow - neighbour.residual, flow)
    )
    residual = _asinh(first * (1 / noise))
    remainder, inconsistency, epipolar = (
        _asinh(length * (1 / noise))
        for length in (
            vector_length(neighbour.residual),
            vector_length(flow + warp(neighbour.back, flow)),
            _epipolar_distance(flow),
        )
    )
    # Four channels at a time, as many as OpenCV reduces at once without a loop.
    linear = _reduce((*np.moveaxis(first, -1, 0), *np.moveaxis(flow, -1, 0)), shape)
    linear[..., :2] *= _CONTRAST / _scale(vector_length(first), 98, noise)
    linear[..., 2:] *= _CONTRAST / _scale(vector_length(flow), 95, noise)
    bent = _reduce((*np.moveaxis(residual, -1, 0), remainder, background_error), shape)
    rest = _reduce((observed_error, inconsistency, epipolar), shape)
    parts = (bent[..., :2], linear[..., :2], bent[..., 2:3], linear[..., 2:], bent[..., 3:], rest)
    return np.concatenate(parts, axis=-1), float(noise)


def _asinh(values: np.ndarray) -> np.ndarray:
    """Return the inverse hyperbolic sine of float32 values, several times faster than by numpy."""
    size = np.abs(values)
    return np.copysign(cv2.log(size + np.sqrt(size * size + 1)), values)


def _reduce(channels: Sequence[np.ndarray], shape: tuple[int, int]) -> np.ndarray:
    """Average channels float32 (h, w) over the cells of a grid of `shape`, float32 (grid y, grid x, channel)."""
    return cv2.resize(np.stack(channels, axis=-1), shape[::-1], interpolation=cv2.INTER_AREA)


def _scale(length: np.ndarray, percentile: float, floor: float) -> np.float32:
    return np.float32(max(float(np.percentile(length[::2, ::2], percentile)), floor))


def _epipolar_distance(flow: np.ndarray) -> np.ndarray:
    """Return the distance float32 (h, w), px, of each pixel's end from its epipolar line; zeros without a geometry."""
    height, width = flow.shape[:2]
    points, vectors = sample_flow(flow, _EPIPOLAR_STEP)
    if len(points) < 16:
        return np.zeros((height, width), np.float32)
    options = {"max_epipolar_error": 0.5, "min_iterations": 30, "max_iterations": 100, "seed": 0}
    matrix, report = poselib.estimate_fundamental(points, points + vectors, options, {})
    if report["num_inliers"] < 8 or not np.isfinite(matrix).all():
        return np.zeros((height, width), np.float32)
    x, y = np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)[:, None]
    a, b, c = (np.float32(row[0]) * x + (np.float32(row[1]) * y + np.float32(row[2])) for row in matrix)
    distance = a * (x + flow[..., 0]) + b * (y + flow[..., 1]) + c
    return np.abs(distance) / np.sqrt(a * a + b * b + np.float32(1e-20))
