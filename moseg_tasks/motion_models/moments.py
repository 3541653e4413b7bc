"""Moments of each object's flow under a model: all that fits and residuals need of the pixels.

The moments are kept as a triangular factor, not as the normal equations: with ``[A b] = Q [[R, t], [0, s]]`` the squared
error of any parameters is ``|R theta - t|² + s²``, a sum of squares that nothing cancels in. ``b'b - 2 theta'A'b +
theta'A'A theta`` would lose residuals below 1e-8 of the flow.

Three steps keep the factor as accurate as a QR decomposition of all rows, at the cost of the normal equations: the sums
run over coordinates local to the object, where the monomials are well conditioned; they are taken over what a first fit
to a coarse grid of pixels leaves, so that the residual is summed itself; and the model's columns, which may be nearly
dependent in image coordinates, are reduced by Householder QR afterwards.
"""

import math
from typing import NamedTuple

import cv2
import numpy as np
from scipy import ndimage

from moseg_tasks.motion_models.flow_model import FlowModel
from moseg_tasks.motion_models.monomials import Frame, evaluate_monomials, image_coordinates, recentring
from moseg_tasks.motion_models.pixel_sums import Pixels, sum_pixels
from schemas.errors import InputError
from schemas.parameters import FlowModelParams

_FIRST_FIT_PIXELS = 512
_GRAM_RANK = 1e-14  # eigenvalue of a Gram matrix of unit columns below which it is rounding


class Moments(NamedTuple):
    """Unpacked moments of K objects under a model of P parameters.

    Attributes
    ----------
    factor : float64 (K, P, P)
        Upper triangular R.
    target : float64 (K, P)
        t, px.
    rest : float64 (K,)
        s: root of the squared error of the object's own least-squares fit, px.
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
    """Moments of every object in one frame pair.

    Parameters
    ----------
    flow : float32 (H, W, 2)
        px/frame; pixels that are not finite are left out.
    inverse_depth : float32 (H, W), optional
        Relative; any positive scale, for ``oc_depth`` also any shift. None is a constant.
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
        inverse depth in units of its deviation over the frame, from its mean where the model has a free shift.

    Raises
    ------
    InputError
        Where shapes disagree or the masks hold an object beyond K.
    """
    masks, flow, rho = _checked(flow, inverse_depth if model.uses_depth else None, masks, num_objects, params)
    gauge = _depth_gauge(rho, model)
    boxes = ndimage.find_objects(masks, max_label=num_objects)
    present = [k for k, box in enumerate(boxes) if box is not None]
    crops = [_crop(boxes[k], k + 1, flow, rho, masks) for k in present]
    moments = np.zeros((num_objects, (model.num_parameters + 1) ** 2 + 1))
    if not crops:
        return moments

    firsts = [_first_sums(pixels) for pixels in crops]
    columns = np.stack([_local_columns(frame, gauge, model) for frame, *_ in firsts])
    factor, target, _ = _reduce(np.stack([f[1] for f in firsts]), np.stack([f[2] for f in firsts]), columns)
    first_theta = (np.linalg.pinv(factor, rcond=1e-12) @ target[..., None])[..., 0]
    priors = np.einsum("kcmp,kp->kmc", columns, first_theta)

    sums = [sum_pixels(pixels, first[0], prior) for pixels, first, prior in zip(crops, firsts, priors, strict=True)]
    factor, target, explained = _reduce(np.stack([s.gram for s in sums]), np.stack([s.cross for s in sums]), columns)
    energy = np.array([s.energy for s in sums])
    target = target + np.einsum("kqp,kp->kq", factor, first_theta)
    rest = np.sqrt(np.maximum(energy - explained, 0.0))
    moments[present] = _pack(factor, target, rest, np.array([s.count for s in sums]))
    return moments


def unpack_moments(moments: np.ndarray) -> Moments:
    """Triangular factors, targets, own errors and pixel counts of packed moments, float64 (K, (P + 1)² + 1)."""
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
    """Masks with objects 1 .. K (0: not used), flow and inverse depth without non-finite values."""
    shape = masks.shape
    if flow.shape != (*shape, 2) or (inverse_depth is not None and inverse_depth.shape != shape):
        depth_shape = None if inverse_depth is None else inverse_depth.shape
        expected = f"flow {(*shape, 2)} and depth {shape} as the masks"
        raise InputError("frame sizes disagree", where="flow fit", got=f"{flow.shape}, {depth_shape}", expected=expected)
    if masks.size and int(masks.max()) >= num_objects:
        raise InputError("unknown object", where="masks", got=int(masks.max()), expected=f"ids below {num_objects}")
    labels = masks.astype(np.int32) + 1
    if params.erosion:
        size = 2 * params.erosion + 1
        kernel = np.ones((size, size), np.uint8)
        labels[cv2.erode(masks, kernel) != cv2.dilate(masks, kernel)] = 0
    # One sum tells whether any value is not finite; only then are the pixels looked for.
    if not np.isfinite(flow.sum(dtype=np.float64)):
        bad = ~np.isfinite(flow).all(axis=-1)
        labels[bad], flow = 0, np.where(bad[..., None], 0, flow)
    if inverse_depth is not None and not np.isfinite(inverse_depth.sum(dtype=np.float64)):
        bad = ~np.isfinite(inverse_depth)
        labels[bad], inverse_depth = 0, np.where(bad, 0, inverse_depth)
    return labels, flow, inverse_depth


def _depth_gauge(rho, model) -> tuple[float, float]:
    """Shift and scale that bring the frame's inverse depth to unit size; no shift where the model would change."""
    if rho is None:
        return 0.0, 1.0
    sample = rho[::4, ::4].astype(np.float64)
    shift = float(sample.mean()) if model.has_free_shift else 0.0
    scale = float(np.sqrt(np.mean((sample - shift) ** 2)))
    return shift, scale if scale > 0 else 1.0


def _crop(box, label, flow, rho, labels) -> Pixels:
    corner = (box[0].start, box[1].start)
    return Pixels(labels[box] == label, flow[box], None if rho is None else rho[box], corner, labels.shape)


def _first_sums(pixels: Pixels) -> tuple[Frame, np.ndarray, np.ndarray]:
    """Local coordinates, Gram matrix (9, 9) and cross products (9, 2) of a coarse grid of the object's pixels."""
    h, w = pixels.mask.shape
    step = max(1, math.isqrt(int(np.count_nonzero(pixels.mask)) // _FIRST_FIT_PIXELS))
    rows, columns = np.nonzero(pixels.mask[::step, ::step])
    rows, columns = rows * step, columns * step
    x, y = image_coordinates(*pixels.image_shape)
    top, left = pixels.corner
    half = max(h, w) / max(pixels.image_shape)
    x0, y0 = (x[left] + x[left + w - 1]) / 2, (y[top] + y[top + h - 1]) / 2
    local = Frame(x0, y0, half, 0.0, 0.0, 0.0, 1.0)
    xi, eta = pixels.local_axes(local)
    xi, eta, zeta = xi[columns], eta[rows], np.zeros(len(rows))
    if pixels.rho is not None:
        local, zeta = _with_depth_plane(local, xi, eta, pixels.rho[rows, columns].astype(np.float64))
    monomials = evaluate_monomials(xi, eta, zeta)
    return local, monomials.T @ monomials, monomials.T @ pixels.flow[rows, columns].astype(np.float64)


def _with_depth_plane(local: Frame, xi, eta, rho) -> tuple[Frame, np.ndarray]:
    """The frame with a plane fitted to the inverse depth at some points, and zeta at these points."""
    axes = np.stack([np.ones_like(xi), xi, eta], axis=1)
    plane = np.linalg.lstsq(axes, rho)[0]
    left = rho - axes @ plane
    deviation = math.sqrt(float(left @ left) / max(len(left), 1))
    scale = deviation if deviation > 0 else 1.0
    return local._replace(rho0=plane[0], rho_x=plane[1], rho_y=plane[2], rho_scale=scale), left / scale


def _local_columns(frame: Frame, gauge: tuple[float, float], model: FlowModel) -> np.ndarray:
    """The model's terms on the object's local monomials, u and v: float64 (2, 9, P)."""
    shift, scale = gauge
    plane = {name: getattr(frame, name) / scale for name in ("rho_x", "rho_y", "rho_scale")}
    centred = recentring(frame._replace(rho0=(frame.rho0 - shift) / scale, **plane))
    return np.stack([centred @ model.u_terms, centred @ model.v_terms])


def _reduce(gram, cross, columns) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From sums over monomials to the model: R (K, P, P), t (K, P) and the energy that t explains (K,)."""
    sizes = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    sizes = np.where(sizes > 0, sizes, 1.0)
    values, vectors = np.linalg.eigh(gram / (sizes[:, :, None] * sizes[:, None, :]))
    known = values > _GRAM_RANK
    roots = np.sqrt(np.where(known, values, 0.0))
    root = roots[:, :, None] * vectors.transpose(0, 2, 1) * sizes[:, None, :]
    inverse = np.where(known, 1.0 / np.where(known, roots, 1.0), 0.0)
    data = inverse[:, :, None] * (vectors.transpose(0, 2, 1) @ (cross / sizes[:, :, None]))
    num = len(gram)
    stacked = (root[:, None] @ columns).reshape(num, -1, columns.shape[-1])
    q, r = np.linalg.qr(stacked)
    target = (q.transpose(0, 2, 1) @ data.transpose(0, 2, 1).reshape(num, -1, 1))[..., 0]
    return r, target, (target**2).sum(axis=1)
