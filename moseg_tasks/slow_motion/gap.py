"""Distance of the pictures of a pair, by how much neighbouring frames move."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import SaliencyParams, SlowMotionParams
from moseg.tasks.saliency.grid import vector_length
from moseg.tasks.saliency.layers import fit_layers


class SlowMotion(NamedTuple):
    """Motion of a stretch of video.

    Attributes
    ----------
    gap : int
        Distance of the pictures of a pair, 1 where motion is not slow.
    residual : float
        Motion from frame to frame that is not the background's, px, which most pairs do not exceed.
    motion : float
        Motion from frame to frame, the camera's included, px: that of the fastest pair.
    """

    gap: int
    residual: float
    motion: float


def choose_gap(
    flows: Iterable[np.ndarray], longest: int, params: SlowMotionParams, saliency_params: SaliencyParams
) -> SlowMotion:
    """Choose how far apart the pictures are between which motion is seen.

    Flow has an error of some tenths of a pixel however little moves, so that what moves by less from frame to frame (a
    film in slow motion or of many frames a second, a far or slow thing) does not rise above it. Farther apart, it
    does. Parallax grows as well: the whole motion apart from the background's is brought to what it is in ordinary
    videos, not beyond.

    Parameters
    ----------
    flows : iterable of float32 (y, x, 2)
        Flow of pairs of neighbouring frames on the working grid, px; at least one.
    longest : int
        Largest distance, in pictures.
    params : SlowMotionParams
    saliency_params : SaliencyParams
        The fit of the background's layers.

    Returns
    -------
    SlowMotion
    """
    residuals, motions = [], []
    for flow in flows:
        residuals.append(np.percentile(fit_layers(flow, saliency_params).residual, params.percentile))
        motions.append(np.percentile(vector_length(flow), params.percentile))
    residual = float(np.quantile(residuals, params.share_of_pairs, method="inverted_cdf"))
    motion = float(max(motions))
    # Nothing at all moves in a film of one picture.
    shares = [limit / moved for limit, moved in ((params.residual, residual), (params.motion, motion)) if moved > 0]
    return SlowMotion(max(int(min([longest, *shares])), 1), residual, motion)
