"""Motion or rest of each object in a frame: its motion against the background's, beyond the noise of the flow."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters import MovesNowParams
from moseg.tasks.saliency.grid import vector_length

UNSEEN, RESTS, MOVES = -1, 0, 1


def moves_now(
    labels: np.ndarray,
    flows: Sequence[np.ndarray | None],
    residual_flows: Sequence[np.ndarray | None],
    num_objects: int,
    params: MovesNowParams,
) -> np.ndarray:
    """Return whether each object of a frame moves.

    The smaller residual of both time directions counts, as in the saliency: an occlusion affects only one.

    Parameters
    ----------
    labels : uint16 (y, x)
        Object of each pixel of the working grid; 0 = background.
    flows, residual_flows : two of float32 (y, x, 2) or None
        Flow to the previous and to the next frame, and the same less the background's, px/frame; None at the ends.
    num_objects : int
        Number of labels, that of the background included.
    params : MovesNowParams

    Returns
    -------
    moves : int8 (num_objects,)
        `MOVES`, `RESTS`, or `UNSEEN` for an object without a pixel, for the background and without any flow.
    """
    moves = np.full(num_objects, UNSEEN, np.int8)
    given = [(flow, residual) for flow, residual in zip(flows, residual_flows, strict=True) if residual is not None]
    counts = np.bincount(labels.ravel(), minlength=num_objects)
    seen = np.flatnonzero(counts[1:]) + 1
    if not given or not len(seen):
        return moves
    residual = np.minimum.reduce([vector_length(residual) for _, residual in given])
    speed = np.minimum.reduce([vector_length(flow - residual) for flow, residual in given])
    background = residual[labels == 0]
    noise = float(np.median(background)) if len(background) else 0.0
    floor = max(params.floor, params.floor_medians * noise)
    is_beyond = residual > np.maximum(np.float32(floor), np.float32(params.floor_motion) * speed)
    beyond = np.bincount(labels[is_beyond], minlength=num_objects)
    moves[seen] = np.where(beyond[seen] >= params.share * counts[seen], MOVES, RESTS)
    return moves
