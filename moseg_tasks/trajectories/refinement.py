"""Refinement of a grouping by moving pieces and single trajectories between its groups."""

from collections.abc import Sequence

import numpy as np

from moseg.tasks.trajectories.energy import Energy, Grouping
from moseg.tasks.trajectories.groups import labels_in_use
from moseg.tasks.trajectories.joint_searches import Search, run_together

_SHARES = (1.0, 0.3, 0.1, 0.03)
"""Shares of the trajectories with a better group that are moved together, until the energy decreases."""


def refine_groupings(
    groupings: Sequence[Grouping], energy: Energy, pieces: Sequence[np.ndarray], num_rounds: int, num_tried: int
) -> list[Grouping]:
    """Move pieces of each grouping, then single trajectories, to other groups as long as the energy decreases.

    Pieces are nearly pure, but groupings made of them inherit their few errors, and a grouping that cuts through one
    motion is several moves away from the right one, each of which is better than the last.

    Parameters
    ----------
    groupings : sequence of Grouping
        Labels are 0 .. K - 1, each in use.
    energy : Energy
    pieces : sequence of int (N,)
        Over-segmentations. The part of a piece in one group moves together.
    num_rounds : int
        Largest number of moves of pieces, and of rounds in which single trajectories move.
    num_tried : int
        Moves of pieces tried in each round, in the order of their energy to first order.

    Returns
    -------
    list of Grouping
        Of the same numbers of groups.
    """
    searches = [_refine(grouping, energy, pieces, num_rounds, num_tried) for grouping in groupings]
    return run_together(searches, energy.prepare)


def _refine(
    grouping: Grouping, energy: Energy, pieces: Sequence[np.ndarray], num_rounds: int, num_tried: int
) -> Search[Grouping]:
    """Refine one grouping."""
    for _ in range(num_rounds):
        moved = yield from _move_piece(grouping, energy, pieces, num_tried)
        if moved is None:
            break
        grouping = moved
    for _ in range(num_rounds):
        moved = yield from _move_trajectories(grouping, energy)
        if moved is None:
            break
        grouping = moved
    return grouping


def _move_piece(
    grouping: Grouping, energy: Energy, pieces: Sequence[np.ndarray], num_tried: int
) -> Search[Grouping | None]:
    """Return the best grouping with a part of a piece moved to another group; None if none has a lower energy."""
    labels, slope = grouping.labels, energy.gradient(grouping.labels)
    num_groups, sizes = slope.shape[1], np.bincount(grouping.labels)
    slope = slope - slope[np.arange(len(labels)), labels][:, None]
    moves: dict[bytes, tuple[float, np.ndarray]] = {}
    for pieces_of in pieces:
        parts = pieces_of * num_groups + labels
        for part in np.unique(parts):
            own = parts == part
            current = int(part) % num_groups
            if np.count_nonzero(own) == sizes[current]:
                continue
            for group, change in enumerate(slope[own].sum(axis=0)):
                if group != current:
                    moved = np.where(own, group, labels)
                    moves[moved.tobytes()] = (float(change), moved)
    tried = sorted(moves.values(), key=lambda move: move[0])[:num_tried]
    return (yield from energy.search_below(grouping.energy, [moved for _, moved in tried]))


def _move_trajectories(grouping: Grouping, energy: Energy) -> Search[Grouping | None]:
    """Return a grouping with trajectories moved to the group of their lowest energy; None if none is better."""
    labels, slope = grouping.labels, energy.gradient(grouping.labels)
    gain = slope[np.arange(len(labels)), labels] - slope.min(axis=1)
    order = np.argsort(-gain, kind="stable")[: np.count_nonzero(gain > 0)]
    for share in _SHARES if len(order) else ():
        chosen = order[: int(np.ceil(share * len(order)))]
        moved = labels.copy()
        moved[chosen] = slope[chosen].argmin(axis=1)
        if len(labels_in_use(moved)) == slope.shape[1]:
            better = yield from energy.search_below(grouping.energy, [moved])
            if better:
                return better
    return None
