"""Clustering of trajectories into motion groups, from the kernels of several models."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.tasks.clustering.count_motions import CountEvidence, count_by_eigengap, count_motions
from moseg.tasks.clustering.kmeans import cluster_many_points
from moseg.tasks.clustering.motion_tracks import MotionTracks
from moseg.tasks.clustering.spectral import embed_views
from moseg.tasks.trajectories.candidates import Candidates, View, in_order
from moseg.tasks.trajectories.energy import Energy, Grouping, motion_price
from moseg.tasks.trajectories.grouping_search import GroupingSearch
from moseg.tasks.trajectories.joint_searches import Needed
from moseg.tasks.trajectories.separation import nearest_trajectories, separate_objects


class TrajectoryClustering(NamedTuple):
    """Motion groups of N trajectories.

    Attributes
    ----------
    motion : uint16 (N,)
        Group of each trajectory, in the order of their first trajectories.
    embedding : float64 (N, D)
        Spectral coordinates, rows of unit length, or of zero length for trajectories without affinities.
    eigenvalues : float64 (V, E)
        Leading eigenvalues of each clustered kernel's normalised affinity, descending.
    objective : float64 (iterations,)
        Objective of co-regularisation after each round; for a single kernel the sum of its leading eigenvalues.
    costs, cuts, codes : float64 (K,)
        Geometric cost, normalised cut and coding length of the best grouping into 1 .. K motions (`Grouping`), NaN if
        there is none.
    num_motions : int
        Number of groups.
    """

    motion: np.ndarray
    embedding: np.ndarray
    eigenvalues: np.ndarray
    objective: np.ndarray
    costs: np.ndarray
    cuts: np.ndarray
    codes: np.ndarray
    num_motions: int


def cluster_trajectories(
    draws: Sequence[Sequence[View]],
    points: np.ndarray,
    visible: np.ndarray,
    num_motions: int | None,
    params: TrajectoryClusteringParams,
    rng: np.random.Generator,
) -> TrajectoryClustering:
    """Group trajectories by motion.

    ``energy`` makes groupings from every draw of hypotheses, by spectral clustering and by merging of pieces
    (`Candidates`, `merge_by_energy`), and searches for the one of minimal `Energy` from there (`GroupingSearch`). If
    the number of motions is not given, it is the number whose grouping has the lowest energy, among the numbers whose
    candidates, or two merged groups of a larger number's grouping, are near the lowest of all; without a search
    (`params.num_refined` 0), the number whose `Candidates` have the smallest mean energy over the draws. Groupings into
    more than `params.energy.free_motions` with a motion of fewer than `params.min_tracks` trajectories are ignored.
    ``sum``, ``product`` and ``coregularised`` are spectral clustering of the views' mean kernel, of their geometric
    mean and of all views, as published. `params.auto` names the other ways to find the number.

    Parameters
    ----------
    draws : sequence of sequences of View
        [draw of hypotheses][model].
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    num_motions : int, optional
        Reduced to N if larger. None: it is found, at most `params.most_motions`; with `params.separate`, unconnected
        parts of a group then become separate motions. If it is given, they count against a grouping by ``energy``.
    params : TrajectoryClusteringParams
    rng : numpy.random.Generator
        Draws the starts of k-means.

    Raises
    ------
    InputError
        If there is no view, or `num_motions` is below 1.

    References
    ----------
    A. Kumar, P. Rai and H. Daume III, "Co-regularized multi-view spectral clustering", NIPS 2011; X. Xu, L.-F. Cheong
    and Z. Li, "Motion segmentation by exploiting complementary geometric models", CVPR 2018.
    """
    if not draws or not draws[0]:
        raise InputError("no view to cluster", where="cluster_trajectories", got="0 kernels", expected="one or more")
    if num_motions is not None and num_motions < 1:
        raise InputError("too few motions", where="cluster_trajectories", got=num_motions, expected="1 or more")
    by_view = [np.mean([views[index].kernel for views in draws], axis=0) for index in range(len(draws[0]))]
    mean = np.mean(by_view, axis=0)
    views = _clustered_kernels(by_view, params.method)
    max_motions = min(params.most_motions if num_motions is None else num_motions, len(points))
    weights = params.energy
    if num_motions is not None:
        weights = weights.model_copy(update={"motion_weight": 0.0, "chance_weight": 0.0})
    energy = Energy(points, visible, mean, weights)
    seed = int(rng.integers(2**31))

    def embed(count: int):
        if params.method != "coregularised":
            return embed_views(views, count)
        return embed_views(views, count, params.co_regularisation, params.num_iterations, params.tolerance)

    def cluster(count: int) -> np.ndarray:
        return cluster_many_points(embed(count).coordinates, count, params.num_starts, seed)

    counts = [max_motions] if num_motions is not None else range(1, max_motions + 1)
    search = None
    num_more = 0
    if params.method == "energy":
        if num_motions is not None and params.num_refined:
            num_more = min(params.num_more, len(points) - max_motions)
        candidates = [Candidates(drawn, max_motions + num_more, params, seed) for drawn in draws]
        num_small = min(params.small_pieces, len(points)) if params.num_refined and params.num_split else 0
        search = GroupingSearch(candidates, partial(cluster, num_small) if num_small else None, energy, params)
        groupings = {count: search.candidates(count) for count in counts}
        # Groups take less time together than one after another.
        everything = [labels for by_draw in groupings.values() for drawn in by_draw for labels in drawn]
        energy.prepare(Needed(everything, everything))
    else:
        # The published methods give one grouping.
        groupings = {count: [[in_order(cluster(count))]] for count in counts}
    found = {count: [energy.minimum(drawn) for drawn in by_draw] for count, by_draw in groupings.items()}
    best = {count: min(drawn, key=lambda grouping: grouping.energy) for count, drawn in found.items()}
    searched: dict[int, Grouping] = {}
    if search and num_motions is None and params.auto == "energy" and params.num_refined:
        counts = _near_lowest(best, params.count_margin)
        searched = search.best(counts, partial(_small_motion_penalty, params=params), params.count_margin)
        found = {count: [grouping] for count, grouping in searched.items()}
    chosen = max_motions
    if num_motions is None:
        tracks = MotionTracks(points, visible, np.arange(len(points)))
        chosen = _count(found, mean, lambda: embed(1).eigenvalues, tracks, params, rng)
    if search and chosen not in searched:
        is_penalised = num_motions is not None and params.separate and params.num_refined
        penalty = excess_price(points, visible, params) if is_penalised else None
        searched = search.best([chosen], penalty, num_more=num_more)
    best |= searched
    motion, embedding = in_order(best[chosen].labels), embed(chosen)
    each = [best.get(count) for count in range(1, max_motions + 1)]
    terms = np.array([(found.cost, found.cut, found.code) if found else (np.nan,) * 3 for found in each]).T
    if num_motions is None and params.separate:
        motion = in_order(separate_objects(points, visible, motion, params.separation))
    return TrajectoryClustering(
        motion=motion.astype(np.uint16),
        embedding=embedding.coordinates,
        eigenvalues=embedding.eigenvalues,
        objective=embedding.objective,
        costs=terms[0],
        cuts=terms[1],
        codes=terms[2],
        num_motions=int(motion.max()) + 1,
    )


def excess_price(
    points: np.ndarray, visible: np.ndarray, params: TrajectoryClusteringParams
) -> Callable[[np.ndarray], float]:
    """Return a function that penalises labels whose groups consist of more objects than there are groups.

    Two cars on parallel lanes in one group, and a background in two, may fit as well as the true groups. But a number
    that is given counts the cars as two.
    """
    price = motion_price(params.energy, len(points))
    neighbours = nearest_trajectories(points, visible, params.separation.num_neighbours)

    def penalty(labels: np.ndarray) -> float:
        labels = in_order(labels)
        separated = separate_objects(points, visible, labels, params.separation, neighbours)
        return price * float(separated.max() - labels.max())

    return penalty


def _near_lowest(best: dict[int, Grouping], margin: float) -> list[int]:
    """Return the numbers of motions whose best candidate has an energy within `margin` of the lowest.

    The candidates of one number may all cut through a motion. Their energies tell little about the number then, and
    the search is repeated for each of these numbers.
    """
    bound = min(grouping.energy for grouping in best.values()) + margin
    return [count for count, grouping in best.items() if grouping.energy <= bound]


def _small_motion_penalty(labels: np.ndarray, params: TrajectoryClusteringParams) -> float:
    """Return infinity for labels of a number that is not found because one of the motions is too small, else 0."""
    sizes = np.unique(labels, return_counts=True)[1]
    is_free = len(sizes) <= max(params.energy.free_motions, 1)
    return 0.0 if is_free or sizes.min() >= params.min_tracks else np.inf


def _clustered_kernels(by_view: Sequence[np.ndarray], method: str) -> np.ndarray:
    """Return the kernels whose eigenvectors are clustered, float64 (V, N, N)."""
    views = np.stack(by_view).astype(np.float64)
    if method == "coregularised":
        return views
    if method == "product":
        return views.prod(axis=0, keepdims=True) ** (1 / len(views))
    return views.mean(axis=0, keepdims=True)


def _count(
    found: dict[int, list[Grouping]],
    kernel: np.ndarray,
    spectrum: Callable[[], np.ndarray],
    tracks: MotionTracks,
    params: TrajectoryClusteringParams,
    rng: np.random.Generator,
) -> int:
    """Return the number of motions from the groupings of each draw into 1, 2, ... motions."""
    if params.auto == "energy":
        # One grouping for each number after a search; else the mean over the draws, which is robust to lucky fits.
        means = {count: np.mean([grouping.energy for grouping in drawn]) for count, drawn in found.items()}
        lowest = {count: min(drawn, key=lambda grouping: grouping.energy) for count, drawn in found.items()}
        large = [count for count in means if not _small_motion_penalty(lowest[count].labels, params)]
        return min(large or [min(means)], key=means.get)
    if params.auto == "eigengap":
        return count_by_eigengap(spectrum(), len(found))
    resampled = [[grouping.labels for grouping in draw] for draw in zip(*found.values(), strict=True)]
    if params.auto == "stability" and len(resampled) < 2:
        raise InputError(
            "nothing to compare", where="trajectory_clustering.auto", got="stability", expected="groupings of two draws"
        )
    evidence = CountEvidence(
        labelings=[min(groupings, key=lambda grouping: grouping.energy).labels for groupings in found.values()],
        kernel=kernel,
        eigenvalues=spectrum(),
        tracks=[tracks],
        resampled=resampled,
    )
    return count_motions(evidence, params.auto, params.count, rng).num_motions
