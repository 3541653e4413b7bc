"""Parts of an object that one section found apart, and its neighbour as one."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from moseg.schemas.parameters.identity import IdentityParams
from moseg.schemas.parameters.linking import LinkingParams
from moseg.tasks.proposals.rejoining import is_in_time, renumber
from moseg.tasks.proposals.returning import BEGIN, END, Sightings


def join_parts(
    identity: np.ndarray,
    overlaps: Sequence[np.ndarray],
    seen: Sequence[Sightings | None],
    linking: LinkingParams,
    params: IdentityParams,
) -> np.ndarray:
    """Give parts of an object that follow each other in a section one identity, if its neighbour saw one object there.

    Where an object passes behind another, a section may have two: one until it is hidden, one from when it appears
    again. The section before or after has more frames of one of its sides, and may have rejoined them. Sections are
    matched one to one, which leaves a part alone; it is joined where it lies in the neighbour's object, and continues
    the part that is matched to that, or is continued by it.

    Parameters
    ----------
    identity : uint16 (section, maximal number of objects + 1)
        Of `link_sections`.
    overlaps : sequence of int64 (objects of a section + 1, objects of the next + 1)
        Of `count_overlaps`.
    seen : sequence of Sightings or None
        Of each section; objects of one without them stay apart.
    linking : LinkingParams
        `part_share` is the share of a part that has to lie in the neighbour's object.
    params : IdentityParams
        `rejoin_gap` is the number of frames between two parts, or in which both are seen, at most.

    Returns
    -------
    identity : as `identity`
        Identities of the same object have the earliest number; numbers stay without gaps.
    """
    if linking.part_share == 0:
        return identity
    renamed = np.arange(int(identity.max(initial=0)) + 1)
    for index, counts in enumerate(overlaps):
        for section, neighbour, shared in ((index, index + 1, counts), (index + 1, index, counts.T)):
            if seen[section] is None:
                continue
            own, others = identity[section, : len(shared)], identity[neighbour, : shared.shape[1]]
            for parts in _find_parts(own, others, shared, linking.part_share):
                for pair in _continuing(parts, seen[section], params):
                    kept, dropped = sorted(renamed[own[list(pair)]])
                    renamed[renamed == dropped] = kept
    return renumber(identity, renamed)


def _find_parts(own: np.ndarray, others: np.ndarray, shared: np.ndarray, share: float) -> Iterator[list[int]]:
    """Yield the objects of a section that are parts of one of its neighbour's: the one matched to it, and others in it.

    `own` and `others` are the identities of their objects, and `shared` (own objects + 1, others + 1) their pixels.
    """
    areas = shared.sum(axis=1)
    is_alone = ~np.isin(own, others) & (areas > 0)
    for whole in range(1, len(others)):
        is_match = own == others[whole]
        if is_match.any():
            yield np.flatnonzero(is_match | (is_alone & (shared[:, whole] >= share * areas))).tolist()


def _continuing(parts: list[int], seen: Sightings, params: IdentityParams) -> list[tuple[int, int]]:
    """Return the pairs of parts of which one continues the other, in order of time."""
    spans = {part: (int(seen.frames[part - 1, BEGIN, 0]), int(seen.frames[part - 1, END, 0])) for part in parts}
    ordered = sorted((part for part in parts if spans[part][0] >= 0), key=spans.get)
    return [pair for pair in pairwise(ordered) if is_in_time(*map(spans.get, pair), params)]
