"""Deviation of the tracks of a window of frames from a rigid scene."""

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.evidence import PairEvidence, pair_evidence
from moseg.tasks.rigidity.focal_length import choose_focal
from moseg.tasks.rigidity.given_focal import correct_focal

TRACK_EVIDENCE = ("error", "median_error", "test", "strict_error", "strict_test")
"""Names of what is measured of each track in each pair."""


class GivenCameras(NamedTuple):
    """Cameras that were not fitted to tracks.

    Attributes
    ----------
    poses : dict of (int, int) to float64 (3, 4)
        [R | t] from the first to the second frame's camera, by first frame and frames to the second.
    focal : float
        Focal length in longer sides of the frame.
    """

    poses: Mapping[tuple[int, int], np.ndarray]
    focal: float


class Rigidity(NamedTuple):
    """Evidence of N tracks in P frame pairs against a rigid scene.

    Attributes
    ----------
    pairs : int32 (P, 2)
        First frame, and frames to the second; only pairs in which the camera's motion was found.
    error, median_error, test, strict_error, strict_test : float16 (P, N)
        See `PairEvidence`; NaN where a track is not seen in both frames.
    focal : float
        Focal length in longer sides of the frame.
    evidence : tuple of PairEvidence
        Of each pair.
    """

    pairs: np.ndarray
    error: np.ndarray
    median_error: np.ndarray
    test: np.ndarray
    strict_error: np.ndarray
    strict_test: np.ndarray
    focal: float
    evidence: tuple[PairEvidence, ...]


def estimate_rigidity(
    frames: Iterable[np.ndarray],
    points: np.ndarray,
    visible: np.ndarray,
    params: RigidityParams,
    depth_of: Callable[[int], np.ndarray] | None = None,
    step: int = 1,
    cameras: GivenCameras | None = None,
) -> Rigidity:
    """Measure how far each track deviates from a rigid scene seen by a moving camera, over pairs of some gaps.

    Parameters
    ----------
    frames : iterable of uint8 (y, x, 3)
        RGB, F frames.
    points : float32 (N, F, 2)
        xy of the tracks, px.
    visible : bool (N, F)
    params : RigidityParams
    depth_of : function, optional
        From a frame's index to its relative inverse depth float32 (y, x), up to scale and shift; not finite where
        unknown. With `cameras`, not relative but in the inverse of their unit.
    step : int, optional
        Frames between the first frames of the pairs that are read.
    cameras : GivenCameras, optional
        Motions of the camera, in the unit of the depth, which must be given too.

    Returns
    -------
    Rigidity
    """
    images = [_smooth_gray(frame, params.test_blur) for frame in frames]
    focal = None
    if cameras is not None:
        focal = correct_focal(cameras.focal, cameras.poses, depth_of, points, visible, params)
    if focal is None:
        focal = choose_focal(points, visible, images[0].shape, params, step)
    pairs, seen_in, evidence = [], [], []
    for gap in params.gaps:
        for start in range(0, len(images) - gap, step):
            seen = np.flatnonzero(visible[:, start] & visible[:, start + gap])
            points0, points1 = (points[seen, frame].astype(np.float64) for frame in (start, start + gap))
            inverse_depth = None if depth_of is None else depth_of(start)
            both = images[start], images[start + gap]
            pose = None if cameras is None else cameras.poses[start, gap]
            found = pair_evidence(both, points0, points1, focal, params, inverse_depth, pose)
            if found is not None:
                pairs.append((start, gap))
                seen_in.append(seen)
                evidence.append(found)
    arrays = np.full((len(TRACK_EVIDENCE), len(pairs), len(points)), np.nan, np.float16)
    for index, (seen, found) in enumerate(zip(seen_in, evidence, strict=True)):
        arrays[:, index, seen] = [getattr(found, name) for name in TRACK_EVIDENCE]
    return Rigidity(np.array(pairs, np.int32).reshape(-1, 2), *arrays, focal, tuple(evidence))


def _smooth_gray(frame: np.ndarray, sigma: float) -> np.ndarray:
    return cv2.GaussianBlur(cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY), (0, 0), sigma)
