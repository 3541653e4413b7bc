"""The objects with which a section starts: those tracked so far, and newcomers."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.instances import SeedParams
from moseg.tasks.proposals.linking import count_overlaps, match_objects


class Seeds(NamedTuple):
    """Objects in a section's first frame.

    Attributes
    ----------
    labels : uint16 (y, x)
        Objects 1 to n in order of identity, 0 = background. Each has at least one pixel.
    identities : uint16 (n,)
        Identity in the sequence, from 1.
    scores : float64 (n,)
        Detection score in this frame; 0 for a tracked object that was not found again.
    found : uint16 (n,)
        Which of the objects found in this frame each one is, from 1; 0 for a tracked object that was not found again.
    num_identities : int
        Identities assigned so far: the next newcomer gets the next number.
    """

    labels: np.ndarray
    identities: np.ndarray
    scores: np.ndarray
    found: np.ndarray
    num_identities: int


def merge_seeds(
    tracked: np.ndarray | None,
    tracked_identities: np.ndarray,
    num_identities: int,
    found: np.ndarray,
    found_scores: np.ndarray,
    params: SeedParams,
) -> Seeds:
    """Link the objects found in a section's first frame to those tracked into it.

    Found and tracked objects are matched one to one, maximising the summed IoU of their masks. A match keeps the
    tracked identity, and the tracked mask or, with `params.refresh`, the found one. A tracked object without a match
    is kept unchanged while it is visible: a missed detection does not mean that it left. A found object without a match
    is a newcomer with a new identity if enough of it does not overlap those objects; only that part is labelled.
    Tracked masks of an implausible size (`params.min_area`, `max_area`) are dropped first.

    An object without a pixel in this frame has ended: when it reappears it is a newcomer.

    The paper proposes objects anew in every section and does not say how they are linked. SAM-Track, on which it
    builds, keeps the tracked masks and adds new objects in the background, as here without `params.refresh`.

    Parameters
    ----------
    tracked : uint16 (y, x), optional
        Objects 1 to k as tracked into this frame; None in the first section.
    tracked_identities : uint16 (k,)
        Their identities.
    num_identities : int
        Identities given so far.
    found : uint16 (y, x)
        Objects 1 to m found in this frame.
    found_scores : floating (m,)
    params : SeedParams

    Raises
    ------
    InputError
        The label maps differ in size, hold labels without an identity or score, or the identities run out.

    References
    ----------
    Cheng et al., "Segment and Track Anything", arXiv 2305.06558, 2023.
    """
    if tracked is None:
        tracked, tracked_identities = np.zeros_like(found), np.zeros(0, np.uint16)
    _check(tracked, tracked_identities, num_identities, found, found_scores)
    num_tracked = len(tracked_identities)
    tracked = _plausible(tracked, num_tracked, params)
    overlaps = count_overlaps(tracked[None], found[None], num_tracked, len(found_scores))
    matched = dict(match_objects(overlaps, params.min_iou))

    # Labels below are tracked ones, then one more for each newcomer.
    labels = tracked.copy()
    if params.refresh:
        labels[np.isin(labels, list(matched))] = 0
        for label, match in matched.items():
            labels[(found == match) & (labels == 0)] = label
    newcomers = _newcomers(labels, found, found_scores, set(matched.values()), params)
    max_identity = np.iinfo(np.uint16).max
    if num_identities + len(newcomers) > max_identity:
        raise InputError(
            "more objects than identities", got=num_identities + len(newcomers), expected=f"at most {max_identity}"
        )
    for label, newcomer in enumerate(newcomers, start=num_tracked + 1):
        labels[(found == newcomer) & (labels == 0)] = label
    identities = np.concatenate([tracked_identities, num_identities + 1 + np.arange(len(newcomers))])
    sources = [*(matched.get(label, 0) for label in range(1, num_tracked + 1)), *newcomers]
    return _by_identity(labels, identities, np.array(sources, np.uint16), found_scores, num_identities + len(newcomers))


def _plausible(tracked: np.ndarray, num_tracked: int, params: SeedParams) -> np.ndarray:
    """Return the tracked labels without those of an implausible size."""
    share = np.bincount(tracked.ravel(), minlength=num_tracked + 1) / tracked.size
    kept = (share >= params.min_area) & (share <= params.max_area)
    return np.where(kept[tracked], tracked, 0).astype(np.uint16)


def _newcomers(labels: np.ndarray, found: np.ndarray, scores, matched: set[int], params: SeedParams) -> list[int]:
    """Return the unmatched labels that are mostly free, best score first, at most as many as there is room for."""
    room = params.max_objects - np.count_nonzero(np.bincount(labels.ravel())[1:])
    areas = np.bincount(found.ravel(), minlength=len(scores) + 1)
    free = np.bincount(found[labels == 0], minlength=len(scores) + 1)
    ranked = (np.argsort(-np.asarray(scores), kind="stable") + 1).tolist()
    newcomers = [
        label
        for label in ranked
        if label not in matched and free[label] > 0 and free[label] >= params.newcomer_share * areas[label]
    ]
    return newcomers[: max(room, 0)]


def _by_identity(labels, identities: np.ndarray, sources: np.ndarray, found_scores, num_identities: int) -> Seeds:
    """Return the visible objects, renumbered in order of identity."""
    is_seen = np.bincount(labels.ravel(), minlength=len(identities) + 1)[1:] > 0
    order = np.argsort(identities, kind="stable")
    order = order[is_seen[order]]
    renumbered = np.zeros(len(identities) + 1, np.uint16)
    renumbered[order + 1] = 1 + np.arange(len(order))
    sources = sources[order]
    scores = np.concatenate([[0.0], found_scores])[sources]
    return Seeds(renumbered[labels], identities[order].astype(np.uint16), scores, sources, num_identities)


def _check(tracked, tracked_identities, num_identities, found, found_scores) -> None:
    for name, labels, count in (
        ("tracked", tracked, len(tracked_identities)),
        ("found", found, len(found_scores)),
    ):
        if labels.max(initial=0) > count:
            raise InputError("label without an object", where=name, got=labels.max(), expected=f"at most {count}")
    if tracked.shape != found.shape:
        raise InputError("maps of labels differ in size", got=found.shape, expected=tracked.shape)
    if len(tracked_identities) and np.max(tracked_identities) > num_identities:
        got = np.max(tracked_identities)
        raise InputError("identity that was not given", where="tracked", got=got, expected=f"at most {num_identities}")
