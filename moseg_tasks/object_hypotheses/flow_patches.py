"""Flow models of random patches of a frame, and the residuals of every object under them.

A patch is a rectangle of blocks. The normal equations of each block are summed once; those of any rectangle then follow
from four entries of their summed-area table, so that a hypothesis costs a small linear system for any size of its
patch, and all its pixels are used.
"""

import numpy as np

from moseg.schemas.parameters import FlowModelParams, ObjectHypothesisParams
from moseg.tasks.motion_models import FlowModel, flow_moments, unpack_moments
from moseg.tasks.motion_models.moments import depth_gauge
from moseg.tasks.motion_models.monomials import MONOMIALS, evaluate_monomials, image_coordinates

_NUM = len(MONOMIALS)


def flow_patch_residuals(
    flow: np.ndarray,
    inverse_depth: np.ndarray | None,
    nodes: np.ndarray,
    num_nodes: int,
    model: FlowModel,
    flow_params: FlowModelParams,
    params: ObjectHypothesisParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the mean squared error of every node's flow under the models of random patches of the frame.

    Parameters
    ----------
    flow : float32 (H, W, 2)
        px/frame; pixels that are not finite are ignored.
    inverse_depth : float32 (H, W), optional
        As in ``flow_moments``.
    nodes : uint16 (H, W)
        Object or part of the background of each pixel.
    num_nodes : int
        N.
    model : FlowModel
    flow_params : FlowModelParams
    params : ObjectHypothesisParams
    rng : numpy.random.Generator

    Returns
    -------
    float64 (num_hypotheses, N)
        px². NaN for a node with fewer than `flow_params.min_pixels` pixels, infinite under a patch with fewer.

    Raises
    ------
    InputError
        If shapes disagree or a pixel is of a node beyond N.
    """
    inverse_depth = inverse_depth if model.uses_depth else None
    moments = flow_moments(flow, inverse_depth, nodes, num_nodes, model, flow_params)
    patches = draw_patches(block_sums(flow, inverse_depth, model, params.block), params, rng)
    # The first monomial is 1: the sum of its square is the number of pixels.
    too_few = patches[:, 0, 0] < max(flow_params.min_pixels, model.num_parameters)
    theta = solve_patches(np.where(too_few[:, None, None], 0.0, patches), model, flow_params.rank_tolerance)
    factor, target, rest, count = unpack_moments(moments)
    error = np.einsum("jqp,hp->hjq", factor, theta) - target
    residual = ((error**2).sum(axis=2) + rest**2) / np.maximum(count, 1)
    residual[too_few] = np.inf
    residual[:, count < flow_params.min_pixels] = np.nan
    return residual


def block_sums(flow: np.ndarray, inverse_depth: np.ndarray | None, model: FlowModel, block: int) -> np.ndarray:
    """Sum the products of the nine monomials with themselves, u and v over each block's known pixels.

    The result is float64 (rows, columns, 9, 11), with inverse depth in the unit of the model's moments.
    """
    height, width = flow.shape[:2]
    x, y = image_coordinates(height, width)
    known = np.isfinite(flow).all(axis=2)
    rho = np.ones((height, width))
    if inverse_depth is not None:
        finite = np.isfinite(inverse_depth)
        known &= finite
        rho = np.where(finite, inverse_depth, 0.0).astype(np.float64)
        shift, scale = depth_gauge(rho, model)
        rho = (rho - shift) / scale
    rows, columns = -(-height // block), -(-width // block)
    terms = np.zeros((rows * block, columns * block, _NUM + 2))
    seen = terms[:height, :width]
    seen[..., :_NUM] = evaluate_monomials(np.broadcast_to(x, rho.shape), np.broadcast_to(y[:, None], rho.shape), rho)
    seen[..., _NUM:] = flow
    seen[~known] = 0.0
    blocks = terms.reshape(rows, block, columns, block, -1).swapaxes(1, 2).reshape(rows, columns, block * block, -1)
    return blocks[..., :_NUM].swapaxes(-1, -2) @ blocks


def draw_patches(sums: np.ndarray, params: ObjectHypothesisParams, rng: np.random.Generator) -> np.ndarray:
    """Return the sums over random rectangles of blocks, float64 (num_hypotheses, 9, 11).

    All scales from `min_patch` blocks to the shorter side of the frame, all places and all elongations are equally
    likely.
    """
    rows, columns = sums.shape[:2]
    num = params.num_hypotheses
    table = np.zeros((rows + 1, columns + 1, *sums.shape[2:]))
    np.cumsum(np.cumsum(sums, axis=0), axis=1, out=table[1:, 1:])
    largest = np.log(max(min(rows, columns), params.min_patch))
    side = rng.uniform(np.log(params.min_patch), largest, num)
    stretch = rng.uniform(-0.5, 0.5, num) * np.log(params.elongation)
    heights = np.clip(np.rint(np.exp(side + stretch)), 1, rows).astype(np.int64)
    widths = np.clip(np.rint(np.exp(side - stretch)), 1, columns).astype(np.int64)
    top = (rng.random(num) * (rows - heights + 1)).astype(np.int64)
    left = (rng.random(num) * (columns - widths + 1)).astype(np.int64)
    bottom, right = top + heights, left + widths
    return table[bottom, right] - table[top, right] - table[bottom, left] + table[top, left]


def solve_patches(patches: np.ndarray, model: FlowModel, rank_tolerance: float) -> np.ndarray:
    """Return least-squares parameters of each patch, float64 (H, P), of minimal norm for columns of unit size."""
    terms = (model.u_terms, model.v_terms)
    gram = sum(t.T @ patches[..., :_NUM] @ t for t in terms)
    cross = sum(patches[..., _NUM + index] @ t for index, t in enumerate(terms))
    size = np.sqrt(np.maximum(np.diagonal(gram, axis1=1, axis2=2), 0.0))
    # For a zero column, differences of the table are rounding.
    size = np.where(size > 1e-6 * size.max(axis=1, keepdims=True), size, 1.0)
    values, vectors = np.linalg.eigh(gram / (size[:, :, None] * size[:, None, :]))
    # These are the squares of the design's singular values; below 1e-12 they are rounding.
    known = values > max(rank_tolerance**2, 1e-12) * values[:, -1:]
    along = (vectors.swapaxes(1, 2) @ (cross / size)[..., None])[..., 0]
    along = np.where(known, along, 0.0) / np.where(known, values, 1.0)
    return (vectors @ along[..., None])[..., 0] / size
