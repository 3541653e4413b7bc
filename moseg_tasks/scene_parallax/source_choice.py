"""Choice of the source of a stretch's proposals from the evidence of its frame pairs."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import SceneParallaxParams
from moseg.tasks.scene_parallax.pair_evidence import PairEvidence

SALIENCY, TRACKS = "saliency", "tracks"
_UNSEEN = "too few corners to see the camera's motion"


class SourceChoice(NamedTuple):
    """Choice of a stretch, with the figures that it comes from.

    Attributes
    ----------
    proposals : 'saliency' or 'tracks'
    reason : str
        Why, in words.
    moving : float
        Share of the frame pairs over which the camera moves; the other figures are of these pairs.
    gain : float
        Median share of the tracks that a rigid scene explains and a single plane does not.
    inside : float
        Share of the pairs with the epipole inside the frame.
    wander_deg : float
        Median angle of the camera's headings to their middle, degrees.
    shows_depth : bool
        Whether parallax suffices to compare each object with a rigid scene.
    """

    proposals: str
    reason: str
    moving: float = 0.0
    gain: float = 0.0
    inside: float = 0.0
    wander_deg: float = 0.0
    shows_depth: bool = False


def choose_source(
    evidence: Sequence[PairEvidence], num_pairs: int, num_still: int, params: SceneParallaxParams
) -> SourceChoice:
    """Choose tracks for a camera that drives through a scene with depth, and saliency for any other.

    A driving camera sees the point that it moves to, which keeps its place in the frame, and a rigid scene explains
    many tracks that no single plane explains. A camera on a hand or a shoulder sees that point too if its bearer walks
    ahead, but there it wanders. A change of focal length looks like a drive, but a homography explains it. Where the
    camera keeps its heading, few such tracks suffice to show depth.

    Parameters
    ----------
    evidence : sequence of PairEvidence
        Pairs over which the camera moves.
    num_pairs : int
        All pairs of the stretch.
    num_still : int
        Pairs over which the camera stands still; the others without evidence have too few corners, or too few that a
        rigid motion explains.
    params : SceneParallaxParams
    """
    # The camera may move over enough pairs for tracks.
    is_unseen = 1 - num_still / num_pairs >= params.min_moving
    if not evidence:
        return SourceChoice(SALIENCY, _UNSEEN if is_unseen else "the camera stands still")
    moving = len(evidence) / num_pairs
    gain = float(np.median([pair.explained.gain for pair in evidence]))
    inside = float(np.mean([pair.sees_epipole for pair in evidence]))
    wander = _wander(np.array([pair.heading for pair in evidence]))
    is_ahead = inside >= params.min_inside and wander <= params.max_wander_deg
    enough = gain >= (params.min_ahead_gain if is_ahead else params.min_gain)
    if moving < params.min_moving:
        proposals, reason = SALIENCY, _UNSEEN if is_unseen else "the camera stands still most of the time"
    elif gain < params.min_gain:
        proposals, reason = SALIENCY, "one plane explains most of what a rigid scene explains"
    elif inside < params.min_inside:
        proposals, reason = SALIENCY, "the camera does not move ahead"
    elif wander > params.max_wander_deg:
        proposals, reason = SALIENCY, "the camera's heading wanders"
    else:
        proposals, reason = TRACKS, "the camera drives through a scene with depth"
    shows_depth = moving >= params.min_moving and enough
    return SourceChoice(proposals, reason, moving, gain, inside, wander, shows_depth)


def _wander(headings: np.ndarray) -> float:
    """Return the median angle of directions float64 (N, 3) to their middle, degrees."""
    middle = np.median(headings, axis=0)
    size = np.linalg.norm(middle)
    if size == 0:
        return 180.0
    return float(np.degrees(np.median(np.arccos(np.clip(headings @ middle / size, -1, 1)))))
