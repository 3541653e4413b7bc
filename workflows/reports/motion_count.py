"""Sentences that explain how a number of motions was chosen."""

from collections.abc import Sequence
from typing import NamedTuple

from moseg.schemas.parameters import ClusteringParams, EnergyParams, TrajectoryClusteringParams
from moseg.schemas.parameters.clustering import MotionCountParams


class FoundGroups(NamedTuple):
    """Number of groups that a clustering was asked for, and the number that it made.

    Attributes
    ----------
    motions : 'gt', 'auto' or int
        ``clustering.motions`` of the configuration.
    num_asked : int or None
        Groups that the clustering was to make; None where it was to find their number.
    num_motions : int
        Groups that it made, the background's included.
    num_items : int
        Objects, the background among them, or trajectories.
    num_views : int
        Kernels whose eigenvalues are stored.
    """

    motions: str | int
    num_asked: int | None
    num_motions: int
    num_items: int
    num_views: int = 1


def explain_objects(
    found: FoundGroups, params: ClusteringParams, scores: Sequence[float] = (), *, has_rigid: bool = False
) -> str:
    """Explain how the number of motions of a sequence's objects was chosen.

    Parameters
    ----------
    found : FoundGroups
    params : ClusteringParams
        As the clustering's recipe has them.
    scores : sequence of float
        Scores of 1, 2, ... groups, by which they were compared.
    has_rigid : bool
        Whether objects were compared with a rigid scene.
    """
    if found.num_asked is not None:
        return _explain_given(found, "objects, the background among them,")
    if params.auto == "threshold":
        how = (
            "Found: the most alike groups of the kernel merge while their mean affinity is at least"
            f" {params.threshold:g} (clustering.threshold)."
        )
    elif params.auto == "eigengap":
        how = f"Found: as many groups as there are eigenvalues before {_drop(found)} (eigengap)."
    else:
        how = _explain_scores(params.auto, params.count, scores)
    if params.static == "agreement":
        by = f"by {params.threshold:g} or more"
        explained = "that a rigid scene explains, and of those that it leaves open the ones " if has_rigid else ""
        how = how[:-1] + f"; objects {explained}that every view takes for static, {by}, are a group of their own"
        how += ", whatever number of groups is asked for." if scores else "."
    return how


def explain_tracks(found: FoundGroups, params: TrajectoryClusteringParams) -> str:
    """Explain how the number of motions of trajectories was chosen, which has other methods."""
    if found.num_asked is not None:
        return _explain_given(found, "trajectories")
    most = min(params.most_motions, found.num_items)
    if params.auto == "energy":
        energy = params.energy
        how = (
            f"Found: of 1 to {most} motions those of least energy{_over_draws(params)}: what the tracks cost under one"
            " fundamental matrix a motion and pair of frames, as a share of their cost under a single motion (of"
            f" {energy.least_unit:g} where that is less), plus {energy.cut_weight:g} times the normalised cut, plus"
            f" {energy.coding_weight:g} times the coding length as a share of a single motion's, plus"
            f" {_penalty(energy)} for each motion beyond {energy.free_motions}."
        )
    elif params.auto == "eigengap":
        how = f"Found: as many motions, at most {most}, as there are eigenvalues before {_drop(found)} (eigengap)."
    else:
        how = _explain_scores(params.auto, params.count, ())
    if params.separate:
        how = how[:-1] + "; parts of a motion that lie apart in the image count as motions of their own."
    return how


def _penalty(energy: EnergyParams) -> str:
    """Return what each further motion costs, in words."""
    by_chance = f"{energy.chance_weight:g} divided by the square root of the number of tracks"
    if not energy.chance_weight:
        return f"{energy.motion_weight:g}"
    return f"{energy.motion_weight:g} and {by_chance}" if energy.motion_weight else by_chance


def _explain_given(found: FoundGroups, items: str) -> str:
    """Explain a given number; a clustering of few items makes fewer groups than it is asked for."""
    given = f"Given: {found.num_asked} (clustering.motions), the background's included"
    if found.motions == "gt":
        given = f"Given: {found.num_asked}, as many as the ground truth has, the background's included"
    if found.num_motions == found.num_asked:
        return f"{given}."
    if found.num_items < found.num_asked:
        return f"{given}; there are only {found.num_items} {items} to group."
    return f"{given}; the clustering made only {found.num_motions}."


def _drop(found: FoundGroups) -> str:
    return "their largest drop" if found.num_views == 1 else "the largest drop of the views' mean"


def _over_draws(params: TrajectoryClusteringParams) -> str:
    # Spectral clustering, as published, groups once, and a search has one result.
    return ", the mean over the draws" if params.method == "energy" and not params.num_refined else ""


def _explain_scores(method: str, params: MotionCountParams, scores: Sequence[float]) -> str:
    """Explain a method that compares groupings into 1, 2, ... motions; costs are stored as negative scores."""
    costs = _listed([-score for score in scores])
    listed = _listed(scores)
    return {
        "description_length": f"Found: what describes the tracks in the fewest nats{costs} (description_length).",
        "geometric": (
            f"Found: what explains the tracks at the least cost, with {params.motion_price:g} for each motion{costs}"
            " (geometric)."
        ),
        "confidences": (
            "Found: the clearest clusters by eigengap, silhouette, Davies-Bouldin and Calinski-Harabasz index, and a"
            f" single motion where no silhouette reaches {params.least_silhouette:g}{listed} (confidences)."
        ),
        "stability": (
            "Found: the groups that come back most surely in other samples, by their mean adjusted Rand index, and a"
            f" single motion where none exceeds {params.least_agreement:g}{listed} (stability)."
        ),
    }[method]


def _listed(values: Sequence[float]) -> str:
    """Format values with the smallest number of digits, four or more, that keeps different values different."""
    if not values:
        return ""
    # A cost is a negated score, which makes a zero negative.
    values = [value + 0.0 for value in values]
    num_different = len({repr(value) for value in values})
    for digits in range(4, 18):
        written = [f"{value:.{digits}g}" for value in values]
        if len(set(written)) == num_different:
            break
    return f", for 1, 2, … groups asked for {', '.join(written)}"
