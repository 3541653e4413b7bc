"""Search for the grouping of lowest energy into a given number of motions."""

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property

import numpy as np

from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.tasks.trajectories.candidates import Candidates, in_order
from moseg.tasks.trajectories.energy import Energy, Grouping
from moseg.tasks.trajectories.merging import merge_by_energy, merge_pairs
from moseg.tasks.trajectories.refinement import refine_groupings
from moseg.tasks.trajectories.splitting import split_grouping


class GroupingSearch:
    """Groupings of low energy for any number of motions, from the candidates of all draws of hypotheses.

    The draws are independent. If the candidate of lowest energy is the same in all of them, as in most clips, and needs
    fewer bits than a single motion, only that one is refined (`params.trust_agreement`). Otherwise the best candidates
    and merged pieces are. From some of them the right grouping cannot be reached by moves that each lower the energy:
    if a large motion is in two groups and a small one in none, both have to change at once. The best grouping into one
    motion less often lacks only the small motion, so small pieces are split off it as well. And a grouping into more
    motions often lacks only a merge.

    Parameters
    ----------
    candidates : sequence of Candidates
        One for each draw.
    make_small_pieces : callable, optional
        Returns a finer over-segmentation int (N,), whose pieces are split off. None: nothing is.
    energy : Energy
    params : TrajectoryClusteringParams
    """

    def __init__(
        self,
        candidates: Sequence[Candidates],
        make_small_pieces: Callable[[], np.ndarray] | None,
        energy: Energy,
        params: TrajectoryClusteringParams,
    ):
        self._candidates = candidates
        self._pieces = [each for candidate in candidates for each in candidate.finest_pieces]
        self._make_small_pieces = make_small_pieces
        self._energy = energy
        self._params = params
        self._of: dict[int, list[list[np.ndarray]]] = {}
        self._of_energy: dict[int, list[Grouping]] = {}
        self._refined: dict[bytes, Grouping] = {}

    def candidates(self, count: int) -> list[list[np.ndarray]]:
        """Return the candidates of each draw, labels int (N,) of at most `count` groups."""
        if count not in self._of:
            self._of[count] = [each.of(count) for each in self._candidates]
        return self._of[count]

    def best(
        self,
        counts: Iterable[int],
        penalty: Callable[[np.ndarray], float] | None = None,
        margin: float | None = None,
        num_more: int = 0,
    ) -> dict[int, Grouping]:
        """Return the grouping of lowest energy into each number of groups, from refined candidates and from splits.

        The energies of different numbers can be compared.

        Parameters
        ----------
        counts : iterable of int
        penalty : callable, optional
            Returns 0 or more for labels int (N,), which is added to the energies before groupings of one number are
            compared; with infinity, they are chosen only if there are no others.
        margin : float, optional
            The best grouping into each number, with two of its groups merged, is then a further start for one group
            less. That number is added if it is not among `counts` and this energy is at most `margin` above the lowest.
        num_more : int
            Unless the draws agree on the largest of `counts`, or its best grouping needs more bits than one motion, so
            many numbers beyond it are searched too, only for their best groupings with two groups merged.
        """
        found = self._searched(list(counts), penalty)
        if num_more:
            found = self._and_merged_from_more(found, num_more, penalty)
        if margin is not None:
            self._add_merged(found, margin)
        different = {grouping.labels.tobytes() for groupings in found.values() for grouping in groupings}
        if self._params.num_refined and len(different) > 1:
            # The search compares thousands of groups, by fits that sometimes fail; the last few deserve better ones.
            compared = iter(
                self._energy.thorough([each for groupings in found.values() for each in groupings], self._pieces)
            )
            found = {count: [next(compared) for _ in groupings] for count, groupings in found.items()}
        return {count: _lowest(groupings, penalty) for count, groupings in found.items()}

    def _searched(
        self, counts: Sequence[int], penalty: Callable[[np.ndarray], float] | None
    ) -> dict[int, list[Grouping]]:
        """Return the best groupings into each number of groups: one and its refinement if the draws are trusted.

        The fits to the groups of the right one may fail, so that its refinement leaves it.
        """
        trusted = self._trusted(counts, penalty)
        self._refine(list(trusted.values()))
        found = {count: [each, self._refined[each.labels.tobytes()]] for count, each in trusted.items()}
        return found | self._refined_into([count for count in counts if count not in trusted])

    def _trusted(self, counts: Sequence[int], penalty: Callable[[np.ndarray], float] | None) -> dict[int, Grouping]:
        """Return the groupings on which the draws agree, and which are not penalised, by the number of their groups."""
        if not (self._params.num_refined and self._params.trust_agreement):
            return {}
        agreed = {count: self._agreed(count) for count in counts}
        return {count: each for count, each in agreed.items() if each and not (penalty and penalty(each.labels))}

    def _agreed(self, count: int) -> Grouping | None:
        """Return the candidate of lowest energy if it is the same in all draws and shorter to describe than one motion.

        Where it is not shorter, all draws may have cut through a motion. None of a single draw.
        """
        best = [self._energy.minimum(drawn) for drawn in self.candidates(count)]
        is_same = all(np.array_equal(each.labels, best[0].labels) for each in best)
        is_shorter = count == 1 or best[0].code < 1
        return best[0] if is_same and is_shorter and len(best) > 1 else None

    def _add_merged(self, found: dict[int, list[Grouping]], margin: float | None) -> None:
        """Add merges of two groups of the best groupings and their refinements, from the largest number on.

        A number that is not there is added if the energy of the merge is at most `margin` above the lowest; None: none
        is. The fits to the groups of a right merge may fail, so that its refinement leaves it. Better fits are compared
        at the end.
        """
        for count in range(max(found), 1, -1):
            if count not in found or (count - 1 not in found and margin is None):
                continue
            best = min(found[count], key=lambda grouping: grouping.energy)
            merged = self._energy.minimum([in_order(labels) for labels in merge_pairs(best.labels)])
            lowest = min(grouping.energy for groupings in found.values() for grouping in groupings)
            if count - 1 in found or merged.energy <= lowest + margin:
                self._refine([merged])
                found.setdefault(count - 1, []).extend([merged, self._refined[merged.labels.tobytes()]])

    def _and_merged_from_more(
        self, found: dict[int, list[Grouping]], num_more: int, penalty: Callable[[np.ndarray], float] | None
    ) -> dict[int, list[Grouping]]:
        """Return the groupings with merges of groups of those into up to `num_more` motions more than the largest."""
        largest = max(found)
        # More motions would need still more bits.
        is_longer = min(found[largest], key=lambda grouping: grouping.energy).code >= 1
        if is_longer or self._trusted([largest], penalty):
            return found
        every = found | self._searched(range(largest + 1, largest + num_more + 1), penalty)
        self._add_merged(every, None)
        return {count: every[count] for count in found}

    def _refined_into(self, counts: Sequence[int]) -> dict[int, list[Grouping]]:
        """Return the best groupings into each number of groups, from several starts and from splits."""
        num_refined = self._params.num_refined
        split = [count for count in counts if count > 1 and self._make_small_pieces]
        starts = [start for count in counts for start in self._ranked(count)[:num_refined]]
        self._refine([*starts, *(self._ranked(count - 1)[0] for count in split)])
        found = {count: self._without_splits(count, num_refined) for count in counts}
        splits: dict[int, list[Grouping]] = {}
        for count in split:
            fewer = min(self._without_splits(count - 1, 1), key=lambda grouping: grouping.energy)
            ranked = split_grouping(fewer, self._energy, self._small_pieces, self._params.pieces.num_tried)
            splits[count] = ranked[: self._params.num_split]
        self._refine([start for starts in splits.values() for start in starts])
        for count, starts in splits.items():
            found[count] += [self._refined[start.labels.tobytes()] for start in starts]
        return found

    @cached_property
    def _small_pieces(self) -> np.ndarray:
        """Return the pieces int (N,) that are split off."""
        return self._make_small_pieces()

    def _without_splits(self, count: int, num_refined: int) -> list[Grouping]:
        """Return the best candidate or merged pieces, and refinements of the best."""
        ranked = self._ranked(count)
        return [ranked[0], *(self._refined[start.labels.tobytes()] for start in ranked[:num_refined])]

    def _ranked(self, count: int) -> list[Grouping]:
        """Return the candidates and the merged pieces in the order of their energy."""
        if count not in self._of_energy:
            labelings = [labels for drawn in self.candidates(count) for labels in drawn]
            labelings += [in_order(merged[count]) for merged in self._merged if count in merged]
            self._of_energy[count] = self._energy.rank(
                list({labels.tobytes(): labels for labels in labelings}.values())
            )
        return self._of_energy[count]

    @cached_property
    def _merged(self) -> list[dict[int, np.ndarray]]:
        """Return the pieces of each draw merged into every number of groups."""
        pieces = [each.merged_pieces for each in self._candidates]
        return merge_by_energy(pieces, self._energy, self._params.pieces.num_tried)

    def _refine(self, starts: Sequence[Grouping]) -> None:
        """Refine groupings, each once, and keep them."""
        new = {start.labels.tobytes(): start for start in starts if start.labels.tobytes() not in self._refined}
        num_rounds, num_tried = self._params.num_refinements, self._params.pieces.num_tried
        refined = refine_groupings(list(new.values()), self._energy, self._pieces, num_rounds, num_tried)
        self._refined |= dict(zip(new, refined, strict=True))


def _lowest(groupings: Sequence[Grouping], penalty: Callable[[np.ndarray], float] | None) -> Grouping:
    """Return the grouping of lowest energy and penalty, which is computed for as few as possible."""
    best, lowest = None, np.inf
    for grouping in sorted(groupings, key=lambda grouping: grouping.energy):
        if grouping.energy >= lowest:
            break
        total = grouping.energy + (penalty(grouping.labels) if penalty else 0.0)
        if best is None or total < lowest:
            best, lowest = grouping, total
    return best
