"""Two-layer background: a second affine motion may explain the outliers of the first if it spans the frame."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.background import AffineMotion, affine_flow, fit_background
from moseg.tasks.saliency.grid import vector_length


class Background(NamedTuple):
    """Background flow and the residual of the observed flow.

    Attributes
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    residual : float32 (y, x)
        px/frame.
    first_layer : AffineMotion or None
        Motion of the first layer; None for a rigid scene.
    is_at_rest : bool
        Whether it does not move at all, and so leaves no residual of its own.
    """

    flow: np.ndarray
    residual: np.ndarray
    first_layer: AffineMotion | None = None
    is_at_rest: bool = False


def fit_layers(flow: np.ndarray, params: SaliencyParams) -> Background:
    """Fit a background motion of one or two affine layers, and return its flow and the residual.

    A second layer (ground under a far scene, a wall beside a road) is only accepted when one connected part of its
    support lies along the frame's border, so that a large object in the middle is not taken for background.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    params : SaliencyParams

    Returns
    -------
    Background
        Each pixel has the flow of the layer that explains it better.
    """
    first_layer = fit_background(flow, params)
    first = _explain(flow, first_layer)
    typical = typical_residual(first.residual, params.border_band)
    outliers = first.residual > max(params.layer_residual, params.layer_medians * typical)
    if outliers.mean() < params.layer_area or not outliers.any():
        return first
    motion = fit_background(flow, params, among=outliers)
    second = _explain(flow, motion)
    reach = max(params.layer_residual, params.layer_scales * motion.scale)
    support = second.residual < np.minimum(reach, params.layer_gain * first.residual)
    if _border_share(support) <= params.layer_border:
        return first
    better = (second.residual < first.residual).astype(np.uint8)
    cv2.copyTo(second.flow, better, first.flow)
    return Background(first.flow, cv2.min(first.residual, second.residual), first_layer)


def _explain(flow: np.ndarray, motion: AffineMotion) -> Background:
    background = affine_flow(motion, flow.shape[:2])
    return Background(background, vector_length(flow - background), motion)


def _border_share(support: np.ndarray) -> float:
    """Return the largest share of the frame's border that one connected part of the opened support covers."""
    opened = cv2.morphologyEx(support.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    count, labels = cv2.connectedComponents(opened)
    border = np.concatenate([labels[0], labels[-1], labels[1:-1, 0], labels[1:-1, -1]])
    covered = np.bincount(border, minlength=count)
    return float(covered[1:].max(initial=0)) / border.size


def typical_residual(residual: np.ndarray, border_band: float) -> float:
    """Return the median of a residual float32 (y, x), in the whole frame or in the border band, whichever is less.

    The median over the frame would be an object's if that fills more than half of the frame.
    """
    # Neighbours are similar: every other row and column suffices.
    some = residual[::2, ::2]
    width = max(1, round(border_band * some.shape[0]))
    in_band = np.ones(some.shape, bool)
    in_band[width:-width, width:-width] = False
    return min(float(np.median(some)), float(np.median(some[in_band])))
