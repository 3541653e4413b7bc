"""Deviation of the tracks of a window of frames from a rigid scene."""

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.camera_motions import PairTracks, fit_motions
from moseg.tasks.rigidity.evidence import PairEvidence, pair_evidence
from moseg.tasks.rigidity.focal_length import choose_focal
from moseg.tasks.rigidity.given_camera import correct_camera
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
    pairs = [(start, gap) for gap in params.gaps for start in range(0, len(images) - gap, step)]
    seen_in = [np.flatnonzero(visible[:, start] & visible[:, start + gap]) for start, gap in pairs]
    tracks = [
        PairTracks(start, *(points[seen, frame].astype(np.float64) for frame in (start, start + gap)))
        for (start, gap), seen in zip(pairs, seen_in, strict=True)
    ]
    # Depth is read from the first frame to the last.
    in_order = sorted(range(len(pairs)), key=pairs.__getitem__)
    given = {}
    for index in in_order if cameras is not None else ():
        pose, depth = cameras.poses[pairs[index]], depth_of(pairs[index][0])
        found = correct_camera(pose, depth, *tracks[index][1:], focal, params)
        if found is not None:
            given[index] = found
    known = {index: camera.motion for index, camera in given.items()}
    motions = fit_motions(tracks, focal, images[0].shape, params, step, known)
    evidence = {}
    for index in in_order:
        if motions[index] is not None:
            start, gap = pairs[index]
            both = images[start], images[start + gap]
            inverse_depth = None if depth_of is None else depth_of(start)
            length = given[index].length if index in given else None
            beyond = [frame for apart in params.test_still_frames for frame in (start - apart, start + gap + apart)]
            others = [images[frame] for frame in beyond if 0 <= frame < len(images)]
            evidence[index] = pair_evidence(
                both, *tracks[index][1:], motions[index], params, inverse_depth, length, others
            )
    kept = sorted(evidence)
    arrays = np.full((len(TRACK_EVIDENCE), len(kept), len(points)), np.nan, np.float16)
    for row, index in enumerate(kept):
        arrays[:, row, seen_in[index]] = [getattr(evidence[index], name) for name in TRACK_EVIDENCE]
    kept_pairs = np.array([pairs[index] for index in kept], np.int32).reshape(-1, 2)
    return Rigidity(kept_pairs, *arrays, focal, tuple(evidence[index] for index in kept))


def _smooth_gray(frame: np.ndarray, sigma: float) -> np.ndarray:
    return cv2.GaussianBlur(cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY), (0, 0), sigma)
