"""Evidence of the tracks of a clip: which of them are static, which move on their own, and which move alike.

Both views of the affinity take part: the background's flow model and its epipolar geometry. A track that fits both is
static. One that fits neither moves if its neighbours move with it. The others are undecided: parallax deviates from a
flow model but not from an epipolar geometry, and a thing that moves along the epipolar lines does the reverse.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from moseg.schemas.parameters import ClipParams, FundamentalParams
from moseg.tasks.geometry import ModelKind, fit_fundamentals
from moseg.tasks.geometry.homography import homography_sampson_squared
from moseg.tasks.geometry.sampson import sampson_squared
from moseg.tasks.network_training.paths import Paths, sample_map
from moseg.tasks.saliency.background import MAD_TO_SIGMA

_MIN_TRACKS = 30
_MIN_RUN = 4  # frames of a track
_BESIDE = 9  # a track and those around it on the grid
_MIN_RATE, _MAX_RATE = 0.05, 0.4  # px/frame: limits of the noise of drift


class TrackEvidence(NamedTuple):
    """Evidence of N tracks.

    Attributes
    ----------
    static, moving : float32 (N,)
        Certainty, 0..1; both 0 where undecided.
    pairs : int32 (P, 2)
        Neighbouring tracks.
    alike, apart : float32 (P,)
        Certainty that the tracks of a pair belong to one motion, and that one moves and the other is static.
    """

    static: np.ndarray
    moving: np.ndarray
    pairs: np.ndarray
    alike: np.ndarray
    apart: np.ndarray


def weigh_tracks(
    paths: Paths, residuals: list[np.ndarray], params: ClipParams, rng: np.random.Generator
) -> TrackEvidence:
    """Weigh the evidence of the tracks of a clip.

    Parameters
    ----------
    paths : Paths
        N tracks through T frames.
    residuals : list of float32 (2, y, x, 2)
        Flow of each frame less that of the background, to the frame before and after; NaN without that neighbour.
    params : ClipParams
    rng : numpy.random.Generator
    """
    shape = residuals[0].shape[1:3]
    rate = _drift(paths, residuals)
    noise = _noise(rate, max(params.noise / np.sqrt(len(residuals)), _MIN_RATE))
    drift = rate / noise
    epipolar = _epipolar(paths, drift < params.moving, shape, params, rng)
    # Without a geometry the flow is all there is.
    epipolar = np.where(np.isfinite(epipolar), epipolar, drift)
    usable = paths.visible.sum(axis=1) >= min(_MIN_RUN, paths.visible.shape[1])
    # Where the flow model leaves parallax to most tracks, its residuals say less of what is static, not more.
    static = usable * _below(rate / min(noise, _MAX_RATE), params.static) * _below(epipolar, params.static)
    deviates = usable * _above(drift, params.moving) * _above(epipolar, params.moving)
    pairs, residual = _compare(paths, usable, max(shape), params)
    affinity = alike = np.exp(-0.5 * (residual / params.alike) ** 2)
    # A group is coherent if those that move alike deviate together.
    together = _sum_of_pairs(pairs, affinity * np.minimum(*deviates[pairs.T]), len(static))
    support = together / np.maximum(_sum_of_pairs(pairs, affinity, len(static)), 1)
    moving = deviates * np.clip(support / params.coherent, 0, 1)
    # The flow of an object reaches a few px beyond its border: tracks there would make it grow.
    inner = 1 - _reaches(paths, deviates, static)
    moving, affinity = moving * inner, affinity * np.minimum(*inner[pairs.T])
    deviates = deviates * inner
    # Static things of different depth differ too, but both fit the epipolar geometry.
    certain = static[pairs[:, 0]] * deviates[pairs[:, 1]] + deviates[pairs[:, 0]] * static[pairs[:, 1]]
    return TrackEvidence(
        *(array.astype(np.float32) for array in (static, moving)),
        pairs.astype(np.int32),
        *(array.astype(np.float32) for array in (affinity, (1 - alike) * certain)),
    )


def _drift(paths: Paths, residuals: list[np.ndarray]) -> np.ndarray:
    """Return the length float64 (N,), px/frame, of the mean residual along each track."""
    num_tracks, num_frames = paths.visible.shape
    vectors = np.full((num_tracks, num_frames, 2, 2), np.nan)
    for frame, residual in enumerate(residuals):
        for direction, sign in ((0, -1), (1, 1)):
            vectors[:, frame, direction] = sign * sample_map(residual[direction], paths.points[:, frame])
    vectors[~paths.visible] = np.nan
    known = np.isfinite(vectors).all(axis=-1)
    mean = np.where(known[..., None], vectors, 0).sum(axis=(1, 2)) / np.maximum(known.sum(axis=(1, 2)), 1)[:, None]
    return np.linalg.norm(mean, axis=1)


def _epipolar(
    paths: Paths, among: np.ndarray, shape: tuple[int, int], params: ClipParams, rng: np.random.Generator
) -> np.ndarray:
    """Return the median distance float64 (N,) from the background's geometry over pairs of frames, relative to its
    noise; NaN where there is none."""
    num_frames = paths.visible.shape[1]
    gap = min(params.gap, num_frames - 1)
    distances = []
    for first in range(0, num_frames - gap, max(1, gap // 2)):
        seen = paths.visible[:, first] & paths.visible[:, first + gap]
        distance = np.full(len(seen), np.nan)
        fitted = among[seen]
        if fitted.sum() >= _MIN_TRACKS:
            points = (paths.points[seen, first].astype(float), paths.points[seen, first + gap].astype(float))
            one = np.zeros(fitted.sum(), np.uint16)
            fit = fit_fundamentals(*(each[fitted] for each in points), one, 1, FundamentalParams(), rng, shape)
            if fit.valid[0]:
                measure = homography_sampson_squared if fit.kind[0] == ModelKind.HOMOGRAPHY else sampson_squared
                distance[seen] = np.sqrt(measure(fit.F, *points)[0])
                distance /= _noise(distance[seen], params.noise)
        distances.append(distance)
    stacked = np.array(distances)
    known = np.isfinite(stacked).any(axis=0)
    result = np.full(stacked.shape[1], np.nan)
    result[known] = np.nanmedian(stacked[:, known], axis=0)
    return result


def _compare(paths: Paths, usable: np.ndarray, side: int, params: ClipParams) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs int (P, 2) of neighbours, and the residuals float64 (P,) under each other's motion over noise.

    The motion of a track is an affine one, fitted to those around it over the longest part of the clip that it is
    seen in; the residual of a pair is the smaller of both, because one of both fits may mix two motions.
    """
    start = int(np.argmax(paths.visible.sum(axis=0)))
    ends = [np.clip(start + step, 0, paths.visible.shape[1] - 1) for step in (-params.gap, params.gap)]
    residuals, found = [], None
    tracks = np.flatnonzero(usable)
    empty = np.zeros((0, 2), np.intp), np.zeros(0)
    if len(tracks) < _MIN_TRACKS:
        return empty
    places = paths.points[tracks, start].astype(float)
    tree = cKDTree(places)
    near = tree.query(places, params.neighbours)[1]
    found = tree.query_pairs(params.pair_reach * side, output_type="ndarray")
    found = found[np.random.default_rng(0).permutation(len(found))[: params.pairs * len(tracks)]]
    for end in ends:
        moved = (paths.points[tracks, end] - paths.points[tracks, start]).astype(float)
        seen = paths.visible[tracks, end].astype(float)
        design = np.concatenate([np.ones((*near.shape, 1)), places[near] - places[:, None]], axis=-1)
        weight = (0.01 + seen[near])[..., None]
        normal = np.einsum("nki,nkj->nij", design * weight, design) + 1e-3 * np.eye(3)
        motion = np.linalg.solve(normal, np.einsum("nki,nkj->nij", design * weight, moved[near]))
        both = []
        for i, j in (found.T, found.T[::-1]):
            offset = np.concatenate([np.ones((len(i), 1)), places[j] - places[i]], axis=-1)
            both.append(np.linalg.norm(moved[j] - np.einsum("pi,pij->pj", offset, motion[i]), axis=1))
        residual = np.minimum(*both)
        residual[~(seen[found[:, 0]] * seen[found[:, 1]]).astype(bool)] = np.nan
        residuals.append(residual / _noise(residual, params.noise))
    stacked = np.array(residuals)
    known = np.isfinite(stacked).any(axis=0)
    return tracks[found[known]], np.nanmax(stacked[:, known], axis=0)


def _reaches(paths: Paths, deviates: np.ndarray, static: np.ndarray) -> np.ndarray:
    """Return how certain it is that a track deviates beside a static one, float64 (N,)."""
    places = paths.points[:, int(np.argmax(paths.visible.sum(axis=0)))]
    near = cKDTree(places).query(places, min(_BESIDE, len(places)))[1]
    return deviates * static[near].reshape(len(places), -1).max(axis=1)


def _sum_of_pairs(pairs: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Return the sum of the values of each track's pairs, float64 (count,)."""
    return np.bincount(pairs.ravel(), np.repeat(values, 2), count)


def _noise(values: np.ndarray, least: float) -> float:
    known = values[np.isfinite(values)]
    return max(float(np.median(known)) * MAD_TO_SIGMA, least) if len(known) else least


def _below(values: np.ndarray, limit: float) -> np.ndarray:
    """Return 1 where values are far below a limit, 0 from it on."""
    return np.clip(2 - 2 * values / limit, 0, 1)


def _above(values: np.ndarray, limit: float) -> np.ndarray:
    """Return 1 from a limit on, 0 below half of it."""
    return np.clip(2 * values / limit - 1, 0, 1)
