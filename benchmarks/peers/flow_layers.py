"""Expectation maximisation over quadratic flow models: our own short implementation of the classical form.

The flow of a frame is a mixture of `NUM_LAYERS` layers. Each has a quadratic model of 12 parameters (6 monomials for
each component) and a noise scale of its own. The background is the layer that covers most of the frame's border.
There is no learning beyond a frame, except that a frame may also start from the layers of the frame before.

References
----------
Jepson, Black, "Mixture models for optical flow computation", CVPR 1993; Weiss, Adelson, "A unified mixture framework
for motion segmentation", CVPR 1996, from which the smooth shares of the layers are. The quadratic model with 12
parameters is that of Meunier, Badoual, Bouthemy, "EM-driven unsupervised learning for efficient motion segmentation",
TPAMI 2023, whose network is not part of this.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import cv2
import numpy as np
from dense_flow import flow_of_each
from frame_size import enlarged, reduced

NUM_LAYERS = 2
GRID_SIDE = 214
"""Longer side of the grid on which layers are estimated, px."""
MIN_NOISE = 0.2
"""Smallest noise scale of a layer, px of the grid: the error of the flow itself."""
SMOOTHNESS = 1.5
"""Standard deviation over which the layers' shares are averaged, px of the grid."""
MIN_SHARE = 1e-4
MAX_STEPS, MIN_GAIN = 25, 1e-3
"""Iterations end when the mean log likelihood of a pixel rises by less than `MIN_GAIN`."""
CARRIED = 0.8
"""Weight of the layers of the frame before, against equal shares, where a frame starts from them."""
ROBUST_STEPS = 15
MIN_LEFT = 30
"""Pixels of the grid that the robust model must leave, for other layers to start from them."""


class Mixture(NamedTuple):
    """Shares float64 (y, x, layer) of the layers in each pixel, and the mean log likelihood of a pixel."""

    shares: np.ndarray
    log_likelihood: float


def segment(frames: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the mask bool (y, x) of the pixels that more probably belong to another layer than the background's."""
    carried = None
    for flow in flow_of_each(frames):
        small = reduced([flow], GRID_SIDE)[0].astype(np.float64)
        small *= small.shape[1] / flow.shape[1]
        starts = [initial_shares(small)] if carried is None else [initial_shares(small), carried]
        mixture = max((fit_layers(small, start) for start in starts), key=lambda each: each.log_likelihood)
        carried = _carry(mixture.shares, small)
        yield enlarged(1 - mixture.shares[..., background_layer(mixture.shares)], flow.shape[:2])


def fit_layers(flow: np.ndarray, shares: np.ndarray) -> Mixture:
    """Fit layers to a flow by expectation maximisation.

    Parameters
    ----------
    flow : float64 (y, x, 2)
        px of the grid.
    shares : float64 (y, x, layer)
        Probability of each layer in each pixel to start from; they sum to 1.
    """
    monomials, vectors = _monomials(*flow.shape[:2]), flow.reshape(-1, 2)
    before = -np.inf
    for _ in range(MAX_STEPS):
        prior = np.maximum(cv2.GaussianBlur(shares, (0, 0), SMOOTHNESS), MIN_SHARE)
        log_joint = np.log(prior).reshape(len(vectors), -1)
        for layer, weights in enumerate(shares.reshape(len(vectors), -1).T):
            squared = _squared_residual(monomials, vectors, weights)
            variance = max(weights @ squared / (2 * max(weights.sum(), 1.0)), MIN_NOISE**2)
            log_joint[:, layer] -= squared / (2 * variance) + np.log(2 * np.pi * variance)
        largest = log_joint.max(axis=1, keepdims=True)
        likelihood = np.exp(log_joint - largest)
        total = likelihood.sum(axis=1, keepdims=True)
        shares = (likelihood / total).reshape(shares.shape)
        mean = float((largest + np.log(total)).mean())
        if mean - before < MIN_GAIN:
            break
        before = mean
    return Mixture(shares, mean)


def initial_shares(flow: np.ndarray) -> np.ndarray:
    """Return shares (y, x, layer) to start from: what one robust model explains, and k-means of what it leaves.

    The k-means are over the residual flow and the place of the pixels that the model leaves.
    """
    height, width = flow.shape[:2]
    monomials, vectors = _monomials(height, width), flow.reshape(-1, 2)
    weights = np.ones(len(vectors))
    for _ in range(ROBUST_STEPS):
        residual = vectors - monomials @ _fit(monomials, vectors, weights)
        length = np.linalg.norm(residual, axis=1)
        scale = max(1.4826 * float(np.median(length)), MIN_NOISE)
        weights = 1 / (1 + (length / scale) ** 2) ** 2
    layer = np.zeros(len(vectors), int)
    left = length > 3 * scale
    if np.count_nonzero(left) >= MIN_LEFT:
        y, x = np.indices((height, width)) / max(height, width)
        features = np.column_stack([residual / residual[left].std(), x.ravel(), y.ravel()])[left].astype(np.float32)
        cv2.setRNGSeed(0)
        criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 20, 0.01)
        _, group, _ = cv2.kmeans(features, NUM_LAYERS - 1, None, criteria, 2, cv2.KMEANS_PP_CENTERS)
        layer[left] = 1 + group.ravel()
    shares = 0.05 + np.eye(NUM_LAYERS)[layer]
    return (shares / shares.sum(axis=1, keepdims=True)).reshape(height, width, NUM_LAYERS)


def background_layer(shares: np.ndarray) -> int:
    """Return the layer that covers most of the frame's border."""
    border = np.concatenate([shares[0], shares[-1], shares[1:-1, 0], shares[1:-1, -1]])
    return int(border.mean(axis=0).argmax())


def _monomials(height: int, width: int) -> np.ndarray:
    """Return 1, x, y, x², xy, y² of every pixel, float64 (N, 6), in units of half the longer side."""
    y, x = np.indices((height, width)).reshape(2, -1)
    x, y = (2 * x - width + 1) / max(height, width), (2 * y - height + 1) / max(height, width)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)


def _fit(monomials: np.ndarray, vectors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the parameters (6, 2) of the model that fits the vectors best by weighted least squares."""
    weighted = monomials * weights[:, None]
    normal = weighted.T @ monomials
    # A layer may have hardly any pixels.
    return np.linalg.solve(normal + (1e-9 * np.trace(normal) + 1e-12) * np.eye(6), weighted.T @ vectors)


def _squared_residual(monomials: np.ndarray, vectors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    return ((vectors - monomials @ _fit(monomials, vectors, weights)) ** 2).sum(axis=1)


def _carry(shares: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """Return shares moved along the flow, px of the grid, and mixed with equal ones."""
    y, x = np.indices(shares.shape[:2], np.float32)
    # The flow at the target stands for that at the source.
    sources = x - flow[..., 0].astype(np.float32), y - flow[..., 1].astype(np.float32)
    moved = cv2.remap(shares.astype(np.float32), *sources, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    moved = CARRIED * moved.astype(np.float64) + (1 - CARRIED) / shares.shape[2]
    return moved / moved.sum(axis=2, keepdims=True)
