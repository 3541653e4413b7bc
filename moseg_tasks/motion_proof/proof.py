"""Log ratio of the colour errors under the background's motion and under the observed flow."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters import MotionProofParams
from moseg.tasks.saliency.photometric import blur_error, colour_error


def prove_motion(
    frame: np.ndarray,
    neighbours: Sequence[np.ndarray | None],
    flows: np.ndarray,
    residual_flows: np.ndarray,
    params: MotionProofParams,
) -> np.ndarray:
    """Return how much better the observed flow explains each pixel's colour than the background's motion does.

    A pixel without texture has no proof, whatever its flow, because both motions explain it.

    Parameters
    ----------
    frame : float32 (y, x, 3)
        Grey levels 0..255.
    neighbours : (previous, next), float32 (y, x, 3) or None
        The frames before and after; None at the ends of the sequence.
    flows, residual_flows : float32 (2, y, x, 2)
        Flow from `frame` to both, and its difference from the background's motion, px/frame.
    params : MotionProofParams

    Returns
    -------
    proof : float32 (y, x)
        ``log((E_background + floor) / (E_observed + floor))`` of the blurred errors, the smaller one of both
        directions, nats; 0 without neighbours.
    """
    floor = np.float32(params.error_floor)
    proofs = []
    for other, flow, residual in zip(neighbours, flows, residual_flows, strict=True):
        if other is None:
            continue
        background, observed = (
            blur_error(colour_error(frame, other, motion), params.blur) + floor for motion in (flow - residual, flow)
        )
        proofs.append(np.log(background / observed))
    return np.minimum.reduce(proofs) if proofs else np.zeros(frame.shape[:2], np.float32)
