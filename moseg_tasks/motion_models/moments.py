"""Moments of each object's flow under a model: the statistics of the pixels that fits and residuals need.

The moments are kept as a triangular factor, not as the normal equations: with ``[A b] = Q [[R, t], [0, s]]`` the
squared error of any parameters is ``|R theta - t|² + s²``, a sum of squares without cancellation. ``b'b - 2 theta'A'b
+ theta'A'A theta`` would lose residuals below 1e-8 of the flow.

Three steps keep the factor as accurate as a QR decomposition of all rows, at the cost of the normal equations: the sums
run over coordinates local to the object, where the monomials are well conditioned; they are sums of the residual of a
first fit to a coarse grid of pixels; and the model's columns, which may be nearly dependent in image coordinates, are
reduced by Householder QR afterwards.
"""

import math
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowModelParams
from moseg.tasks.motion_models.coarse_sums import sum_coarsely
from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.motion_models.pixel_sums import Pixels, sum_pixels
from moseg.tasks.motion_models.triangular import local_columns, reduce_to_model


class Moments(NamedTuple):
    """Unpacked moments of K objects under a model of P parameters.

    Attributes
    ----------
    factor : float64 (K, P, P)
        Upper triangular R.
    target : float64 (K, P)
        t, px.
    rest : float64 (K,)
        s: root of the squared error that no parameters can reduce, px.
    count : int64 (K,)
        Pixels; 0 where the object is absent.
    """

    factor: np.ndarray
    target: np.ndarray
    rest: np.ndarray
    count: np.ndarray


def flow_moments(
    flow: np.ndarray,
    inverse_depth: np.ndarray | None,
    masks: np.ndarray,
    num_objects: int,
    model: FlowModel,
    params: FlowModelParams,
) -> np.ndarray:
    """Return the moments of every object in one frame pair.

    Parameters
    ----------
    flow : float32 (H, W, 2)
        px/frame; pixels that are not finite are ignored.
    inverse_depth : float32 (H, W), optional
        Relative, of any positive scale, for ``oc_depth`` also of any shift. None: constant.
    masks : uint16 (H, W)
        Object of each pixel, 0 = background.
    num_objects : int
        K: objects are 0 .. K - 1.
    model : FlowModel
    params : FlowModelParams

    Returns
    -------
    float64 (K, (P + 1)² + 1)
        Per object the upper triangular ``[[R, t], [0, s]]`` row by row, then the number of pixels. Parameters refer to
        inverse depth in units of its deviation over the frame, from its mean if the model has a free shift.

    Raises
    ------
    InputError
        If shapes disagree or the masks contain an object beyond K.
    """
    masks, flow, rho = _checked(flow, inverse_depth if model.uses_depth else None, masks, num_objects, params)
    gauge = depth_gauge(rho, model)
    found = [_crop(masks == k + 1, flow, rho) for k in range(num_objects)]
    present = [k for k, pixels in enumerate(found) if pixels is not None]
    crops = [found[k] for k in present]
    moments = np.zeros((num_objects, (model.num_parameters + 1) ** 2 + 1))
    if not crops:
        return moments

    firsts = [sum_coarsely(pixels) for pixels in crops]
    columns = np.stack([local_columns(frame, gauge, model) for frame, *_ in firsts])
    factor, target, _ = reduce_to_model(np.stack([f[1] for f in firsts]), np.stack([f[2] for f in firsts]), columns)
    first_theta = (np.linalg.pinv(factor, rcond=1e-12) @ target[..., None])[..., 0]
    priors = np.einsum("kcmp,kp->kmc", columns, first_theta)

    sums = [sum_pixels(pixels, first[0], prior) for pixels, first, prior in zip(crops, firsts, priors, strict=True)]
    factor, target, explained = reduce_to_model(
        np.stack([s.gram for s in sums]), np.stack([s.cross for s in sums]), columns
    )
    energy = np.array([s.energy for s in sums])
    target = target + np.einsum("kqp,kp->kq", factor, first_theta)
    rest = np.sqrt(np.maximum(energy - explained, 0.0))
    moments[present] = _pack(factor, target, rest, np.array([s.count for s in sums]))
    return moments


def unpack_moments(moments: np.ndarray) -> Moments:
    """Unpack factors, targets, fixed errors and pixel counts from moments float64 (K, (P + 1)² + 1)."""
    side = math.isqrt(moments.shape[1] - 1)
    augmented = moments[:, :-1].reshape(-1, side, side)
    count = np.rint(moments[:, -1]).astype(np.int64)
    return Moments(augmented[:, :-1, :-1], augmented[:, :-1, -1], augmented[:, -1, -1], count)


def _pack(factor, target, rest, count) -> np.ndarray:
    num, size = target.shape
    augmented = np.zeros((num, size + 1, size + 1))
    augmented[:, :size, :size], augmented[:, :size, size], augmented[:, size, size] = factor, target, rest
    return np.concatenate([augmented.reshape(num, -1), count[:, None]], axis=1)


def _checked(flow, inverse_depth, masks, num_objects, params):
    """Return checked masks with objects 1 .. K (0: not used), and flow and inverse depth without non-finite values."""
    # Here, because the names of the models are listed by commands that compute nothing.
    import cv2

    shape = masks.shape
    if flow.shape != (*shape, 2) or (inverse_depth is not None and inverse_depth.shape != shape):
        got = f"flow {flow.shape}, inverse depth {None if inverse_depth is None else inverse_depth.shape}"
        raise InputError("frame sizes disagree", where="flow fit", got=got, expected=f"{shape} as the masks")
    if masks.size and int(masks.max()) >= num_objects:
        raise InputError("unknown object", where="masks", got=int(masks.max()), expected=f"ids below {num_objects}")
    labels = masks.astype(np.int32) + 1
    if params.erosion:
        size = 2 * params.erosion + 1
        kernel = np.ones((size, size), np.uint8)
        labels[cv2.erode(masks, kernel) != cv2.dilate(masks, kernel)] = 0
    finite = np.isfinite(flow)
    if not finite.all():
        bad = ~finite.all(axis=-1)
        labels[bad], flow = 0, np.where(bad[..., None], 0, flow)
    if inverse_depth is not None and not np.isfinite(inverse_depth).all():
        bad = ~np.isfinite(inverse_depth)
        labels[bad], inverse_depth = 0, np.where(bad, 0, inverse_depth)
    return labels, flow, inverse_depth


def depth_gauge(rho, model) -> tuple[float, float]:
    """Return shift and scale that bring the frame's inverse depth to unit size; no shift if it changes the model."""
    if rho is None:
        return 0.0, 1.0
    sample = rho[::4, ::4].astype(np.float64)
    shift = float(sample.mean()) if model.has_free_shift else 0.0
    scale = float(np.sqrt(np.mean((sample - shift) ** 2)))
    return shift, scale if scale > 0 else 1.0


def _crop(mask, flow, rho) -> Pixels | None:
    """Return the bounding box of one object's pixels; None if it has none."""
    import cv2

    x, y, width, height = cv2.boundingRect(mask.view(np.uint8))
    if width == 0:
        return None
    box = slice(y, y + height), slice(x, x + width)
    return Pixels(mask[box], flow[box], None if rho is None else rho[box], (y, x), mask.shape)
