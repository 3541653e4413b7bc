"""Clustering of objects into motion groups, from the affinities of several views."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import ClusteringParams
from moseg.tasks.clustering.agreement import set_apart
from moseg.tasks.clustering.count_motions import CountEvidence, MotionCount, count_by_eigengap, count_motions
from moseg.tasks.clustering.fusion import fill_unknown, fuse_kernels, unit_diagonal
from moseg.tasks.clustering.kmeans import cluster_points
from moseg.tasks.clustering.linkage import link_objects
from moseg.tasks.clustering.motion_tracks import MotionTracks
from moseg.tasks.clustering.spectral import Embedding, embed_views
from moseg.tasks.clustering.stability import resampled_affinities


class Clustering(NamedTuple):
    """Motion groups of K objects.

    Attributes
    ----------
    motion : uint16 (K,)
        Group of each object: 0 is the background's and static; 1, 2, ... in the order of their first objects.
    embedding : float64 (K, D)
        Spectral coordinates, rows of unit length.
    eigenvalues : float64 (V, K)
        Eigenvalues of each clustered kernel's normalised affinity, descending; one row if the views were fused.
    num_motions : int
        Number of groups, including the background's.
    objective : float64 (iterations,)
        The co-regularised objective after each round.
    scores : float64 (C,)
        Scores of 1, 2, ... C groups if the number of motions was found by comparing them, the largest is best; else
        empty.
    """

    motion: np.ndarray
    embedding: np.ndarray
    eigenvalues: np.ndarray
    num_motions: int
    objective: np.ndarray
    scores: np.ndarray


def cluster_motions(
    affinities: Sequence[np.ndarray],
    num_motions: int | None,
    params: ClusteringParams,
    is_static: np.ndarray | None = None,
    tracks: Sequence[MotionTracks] = (),
    rng: np.random.Generator | None = None,
) -> Clustering:
    """Group objects by motion.

    Only fits to tracks, where these determine the number of motions, are random. The result does not depend on the
    order of the objects other than the background: they are sorted by their affinities, so that even the order of a
    nearly diagonal affinity has no effect. Objects of equal affinities may be swapped.

    Parameters
    ----------
    affinities : sequence of float64 (K, K)
        One for each view, symmetric and non-negative; object 0 is the background; NaN if unknown (see
        ``fill_unknown``).
    num_motions : int, optional
        Number of motions including the background's, reduced to that of the objects, or with `is_static` to that of
        the moving ones and the background, if larger. 1: nothing moves. None: it is found by `params.auto`.
        ``threshold`` merges groups of the fused kernel while they are alike, and can return 1; it needs affinities with
        a scale, which those of ORK do not have. ``eigengap`` needs no scale, but rarely returns 1. The other methods
        are those of ``count_motions``.
    params : ClusteringParams
    is_static : bool (K,), optional
        Static objects, including the background, if they are known beforehand (``agreed_static``): they are one group,
        and the affinities only group the other objects. None: the clustering decides, by the background's group.
    tracks : sequence of MotionTracks
        Tracks of each section, owned by objects. They and `rng` are read by the methods ``description_length``,
        ``geometric`` and ``stability``.
    rng : numpy.random.Generator, optional

    Returns
    -------
    Clustering

    Raises
    ------
    InputError
        If there is no view, the views disagree in shape, `num_motions` is below 1, or the number is found by tracks and
        there are none.
    """
    _check(affinities, num_motions, is_static)
    views = fill_unknown([unit_diagonal(affinity) for affinity in affinities])
    if is_static is not None:
        views = set_apart(views, is_static)
    # For one view the parameters of fusion are not read, and the recipe does not contain them.
    is_coregularised = len(views) > 1 and params.fusion == "coregularised"
    kernel = fuse_kernels(views, params.fusion) if len(views) > 1 else views[0]
    order = _content_order(kernel)
    views, kernel = views[:, order][:, :, order], kernel[np.ix_(order, order)]
    spectral_views = views if is_coregularised else kernel[None]

    objects = _Objects(kernel, spectral_views, None if is_static is None else is_static[order], params)
    if num_motions is not None:
        most = len(kernel) if is_static is None else int(np.count_nonzero(~is_static)) + 1
        count, scores = min(num_motions, most), np.empty(0)
    else:
        rank = np.argsort(order)
        count, scores = _count(objects, [section._replace(owner=rank[section.owner]) for section in tracks], rng)
    ordered, embedding = objects.group(count)
    if num_motions == 1:
        # The only motion is the background's, though some objects are known to move.
        ordered = np.zeros_like(ordered)
    labels, coordinates = np.empty(len(order), np.int64), np.empty_like(embedding.coordinates)
    labels[order], coordinates[order] = ordered, embedding.coordinates
    motion = _background_first(labels)
    return Clustering(motion, coordinates, embedding.eigenvalues, int(motion.max()) + 1, embedding.objective, scores)


def _check(affinities, num_motions, is_static) -> None:
    """Raise InputError for inconsistent arguments of `cluster_motions`."""
    if len(affinities) == 0:
        raise InputError("no view to cluster", where="cluster_motions", got="0 affinities", expected="one or more")
    shapes = {np.shape(affinity) for affinity in affinities}
    side = len(affinities[0])
    if shapes != {(side, side)} or side == 0:
        raise InputError(
            "wrong shape of affinities", where="cluster_motions", got=sorted(shapes), expected="one (K, K)"
        )
    if num_motions is not None and num_motions < 1:
        raise InputError("too few motions", where="cluster_motions", got=num_motions, expected="1 or more, or None")
    if is_static is not None and (np.shape(is_static) != (side,) or not is_static[0]):
        raise InputError(
            "not the static objects", where="cluster_motions", got=is_static, expected=f"{side} truths, the first true"
        )


def _content_order(kernel: np.ndarray) -> np.ndarray:
    """Order the background first, then the objects by their affinity to it and, if equal, by all affinities."""
    # Rounded, because the same affinities summed in another order may differ in their last bits.
    profile = np.round(np.column_stack([kernel[:, 0], np.sort(kernel, axis=1)]), 9)
    others = 1 + np.lexsort(profile[1:].T[::-1])
    return np.concatenate([[0], others]).astype(np.int64)


class _Objects(NamedTuple):
    """Objects in the order of their affinities, and the parameters of their grouping."""

    kernel: np.ndarray
    views: np.ndarray
    is_static: np.ndarray | None
    params: ClusteringParams

    def group(self, count: int) -> tuple[np.ndarray, Embedding]:
        """Return the labels of `count` groups, and the embedding."""
        embedding = _embed(self.views, count, self.params)
        if self.params.grouping == "spectral":
            labels = cluster_points(embedding.coordinates, count)
        else:
            labels = link_objects(self.kernel, num_clusters=count)
        if self.is_static is not None:
            # Linkage never joins static and other objects; k-means on too few coordinates can.
            labels = np.where(self.is_static, labels.max() + 1, labels)
        return labels, embedding

    def groupings(self) -> list[np.ndarray]:
        """Return the labels of 1, 2, ... groups."""
        max_motions = min(self.params.count.most_motions, len(self.kernel))
        return [self.group(count)[0] for count in range(1, max_motions + 1)]

    def with_affinity(self, affinity: np.ndarray) -> "_Objects":
        """Return the same objects with another affinity."""
        view = affinity[None] if self.is_static is None else set_apart(affinity[None], self.is_static)
        return self._replace(kernel=view[0], views=view)


def _count(objects: _Objects, tracks: Sequence[MotionTracks], rng: np.random.Generator | None) -> MotionCount:
    """Find the number of groups if the number of motions is not given."""
    params = objects.params
    if params.auto == "threshold":
        return MotionCount(int(link_objects(objects.kernel, threshold=params.threshold).max()) + 1, np.empty(0))
    eigenvalues = _embed(objects.views, 1, params).eigenvalues
    if params.auto == "eigengap":
        return MotionCount(count_by_eigengap(eigenvalues), np.empty(0))
    resampled = []
    if params.auto == "stability":
        if rng is None or len(tracks) == 0:
            raise InputError("no tracks to resample", where="cluster_motions: stability", expected="tracks, rng")
        affinities = resampled_affinities(tracks, len(objects.kernel), params.count, rng)
        resampled = [objects.with_affinity(affinity).groupings() for affinity in affinities]
    evidence = CountEvidence(objects.groupings(), objects.kernel, eigenvalues, tracks, resampled)
    return count_motions(evidence, params.auto, params.count, rng)


def _embed(views: np.ndarray, dimension: int, params: ClusteringParams) -> Embedding:
    """Return the embedding of one view, or the co-regularised one of several."""
    if len(views) == 1:
        return embed_views(views, dimension)
    return embed_views(views, dimension, params.co_regularisation, params.num_iterations, params.tolerance)


def _background_first(labels: np.ndarray) -> np.ndarray:
    """Renumber labels in the order of their first objects, uint16; that of object 0 is 0."""
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse].astype(np.uint16)
