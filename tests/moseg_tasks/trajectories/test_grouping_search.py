"""Laws of the search for the grouping of lowest energy."""

from itertools import combinations

import numpy as np
import pytest

from moseg.schemas.parameters import EnergyParams, TrajectoryClusteringParams
from moseg.tasks.metrics.clustering_error import clustering_error
from moseg.tasks.trajectories import grouping_search
from moseg.tasks.trajectories.energy import Energy, group_affinities
from moseg.tasks.trajectories.grouping_search import GroupingSearch
from moseg.tasks.trajectories.merging import _cuts_of_unions, _merge, merge_pairs
from moseg.tasks.trajectories.splitting import split_grouping


class _Candidates:
    """Candidates of one draw that always have the same groupings."""

    def __init__(self, *labelings):
        self._labelings = labelings
        self.merged_pieces = np.zeros(len(labelings[0]), int)
        self.finest_pieces = [self.merged_pieces]

    def of(self, count):
        return [labels for labels in self._labelings if len(np.unique(labels)) == count]


@pytest.fixture
def case(rigid_clip):
    """A clip of three motions and its energy, with an affinity by motion that is weak."""
    clip = rigid_clip((60, 40, 20), num_frames=12, hidden=0)
    kernel = 0.5 + 0.5 * (clip.labels[:, None] == clip.labels)
    return clip, Energy(
        clip.points, clip.visible, kernel.astype(np.float32), EnergyParams(spacing=0.3, motion_weight=0)
    )


def test_the_best_split_is_along_the_motions(case):
    clip, energy = case
    two = energy.minimum([np.minimum(clip.labels, 1)])
    pieces = np.where(clip.labels == 2, 10, np.arange(120) // 15)
    best = split_grouping(two, energy, pieces, 6)
    assert len(best) == 6 and [found.energy for found in best] == sorted(found.energy for found in best)
    assert clustering_error(best[0].labels, clip.labels) == 0


def test_pieces_too_small_for_a_motion_are_not_split_off(case):
    clip, energy = case
    assert split_grouping(energy.minimum([clip.labels]), energy, np.arange(120) // 5, 6) == []


@pytest.mark.parametrize("splits", [True, False])
def test_a_motion_without_group_is_found_though_another_has_two(case, splits):
    clip, energy = case
    two = np.minimum(clip.labels, 1)
    wrong = np.where(np.arange(120) < 30, 2, two)
    small = np.where(clip.labels == 2, 10, np.arange(120) // 15)
    params = TrajectoryClusteringParams(num_refined=1)
    search = GroupingSearch([_Candidates(two, wrong)], (lambda: small) if splits else None, energy, params)
    error = clustering_error(search.best([3])[3].labels, clip.labels)
    assert error == 0 if splits else error > 10


def test_the_search_never_returns_more_than_the_lowest_candidate(case):
    clip, energy = case
    candidates = [clip.labels, np.arange(120) % 3, np.arange(120) // 40]
    every = _Candidates(np.minimum(clip.labels, 1), *candidates)
    search = GroupingSearch([every], lambda: np.arange(120) // 12, energy, TrajectoryClusteringParams(num_refined=0))
    assert search.best([3])[3].energy <= energy.minimum(candidates).energy
    assert search.candidates(3)[0] is search.candidates(3)[0]


def test_each_number_of_groups_has_its_own_grouping(case):
    clip, energy = case
    every = _Candidates(np.minimum(clip.labels, 1), clip.labels, np.arange(120) % 3)
    search = GroupingSearch([every], None, energy, TrajectoryClusteringParams(num_refined=1))
    found = search.best([2, 3])
    assert {count: len(np.unique(grouping.labels)) for count, grouping in found.items()} == {2: 2, 3: 3}
    assert clustering_error(found[3].labels, clip.labels) == 0


@pytest.mark.parametrize("amount", [9.0, np.inf])
def test_a_penalty_chooses_among_the_refined_groupings(case, amount):
    clip, energy = case
    # From the second candidate the first cannot be reached by moves that each lower the energy.
    stuck = np.where(np.arange(120) < 30, 2, np.minimum(clip.labels, 1))
    search = GroupingSearch([_Candidates(clip.labels, stuck)], None, energy, TrajectoryClusteringParams(num_refined=2))
    free = search.best([3])[3]

    def penalty(labels):
        return amount if np.array_equal(labels, free.labels) else 0.0

    other = search.best([3], penalty)[3]
    assert not np.array_equal(other.labels, free.labels) and other.energy > free.energy
    assert np.array_equal(search.best([3], lambda labels: amount)[3].labels, free.labels)


@pytest.fixture
def large_case(rigid_clip):
    """A clip whose three motions are shorter to describe than a single one, and its energy."""
    clip = rigid_clip((200, 160, 120), num_frames=12, hidden=0)
    kernel = 0.5 + 0.5 * (clip.labels[:, None] == clip.labels)
    return clip, Energy(
        clip.points, clip.visible, kernel.astype(np.float32), EnergyParams(spacing=0.3, motion_weight=0)
    )


@pytest.mark.parametrize("trusts", [True, False])
def test_what_all_draws_find_is_refined_alone(large_case, trusts):
    clip, energy = large_case
    two = np.minimum(clip.labels, 1)
    nearly = np.where(np.arange(480) == 5, 1, clip.labels)
    draws = [_Candidates(two, nearly), _Candidates(two, np.arange(480) % 3, nearly)]
    searches = []

    def small():
        searches.append(1)
        return np.arange(480) // 30

    params = TrajectoryClusteringParams(num_refined=1, trust_agreement=trusts)
    found = GroupingSearch(draws, small, energy, params).best([3])[3]
    assert np.array_equal(found.labels, clip.labels)
    assert bool(searches) != trusts


def test_what_all_draws_find_is_kept_beside_its_refinement(large_case, monkeypatch):
    clip, energy = large_case
    wrong = energy.minimum([np.arange(480) % 3])
    moved = [wrong._replace(energy=-1.0)]
    monkeypatch.setattr(grouping_search, "refine_groupings", lambda starts, *_others: moved * len(starts))
    draw = _Candidates(np.minimum(clip.labels, 1), clip.labels)
    found = GroupingSearch([draw, draw], None, energy, TrajectoryClusteringParams(num_refined=1)).best([3])[3]
    assert np.array_equal(found.labels, clip.labels)


def test_draws_that_agree_on_a_longer_description_are_searched(case):
    clip, energy = case
    # No move that lowers the energy leads from here to the motions, but a split of the best two does.
    two = np.minimum(clip.labels, 1)
    stuck = np.where(np.arange(120) < 30, 2, two)
    assert energy.minimum([stuck]).code > 1
    small = np.where(clip.labels == 2, 10, np.arange(120) // 15)
    draws = [_Candidates(two, stuck), _Candidates(two, stuck)]
    search = GroupingSearch(draws, lambda: small, energy, TrajectoryClusteringParams(num_refined=1))
    assert clustering_error(search.best([3])[3].labels, clip.labels) == 0


def test_draws_that_differ_are_searched(case):
    clip, energy = case
    stuck = np.where(np.arange(120) < 30, 2, np.minimum(clip.labels, 1))
    other = np.where(np.arange(120) < 29, 2, np.minimum(clip.labels, 1))
    small = np.where(clip.labels == 2, 10, np.arange(120) // 15)
    params = TrajectoryClusteringParams(num_refined=1)
    two = np.minimum(clip.labels, 1)
    search = GroupingSearch([_Candidates(two, stuck), _Candidates(two, other)], lambda: small, energy, params)
    assert clustering_error(search.best([3])[3].labels, clip.labels) == 0


def test_what_all_draws_find_is_not_trusted_with_a_penalty(large_case):
    clip, energy = large_case
    draw = _Candidates(np.minimum(clip.labels, 1), clip.labels)
    searches = []

    def small():
        searches.append(1)
        return np.arange(480) // 30

    for penalty in (0.0, 9.0):
        search = GroupingSearch([draw, draw], small, energy, TrajectoryClusteringParams(num_refined=1))
        search.best([3], lambda labels, penalty=penalty: penalty)
        assert bool(searches) == (penalty > 0)


def test_a_smaller_number_is_reached_by_merging_the_best_grouping(case):
    clip, energy = case
    bad = np.arange(120) % 2
    draw = _Candidates(bad, clip.labels, np.zeros(120, int))
    search = GroupingSearch([draw, draw], None, energy, TrajectoryClusteringParams(num_refined=1))
    assert set(search.best([3])) == {3}
    assert set(search.best([3], margin=-9.0)) == {3}
    found = search.best([3], margin=9.0)
    assert set(found) == {1, 2, 3} and len(np.unique(found[2].labels)) == 2
    assert energy.minimum([found[2].labels]).energy < energy.minimum([bad]).energy
    # The number may have been asked for as well.
    assert np.array_equal(search.best([2, 3], margin=-9.0)[2].labels, found[2].labels)


def test_a_merge_is_kept_beside_its_refinement(large_case, monkeypatch):
    clip, energy = large_case
    wrong = energy.minimum([np.arange(480) % 2])

    def refine(starts, *_others):
        return [start if start.labels.max() == 2 else wrong._replace(energy=start.energy - 1) for start in starts]

    monkeypatch.setattr(grouping_search, "refine_groupings", refine)
    draw = _Candidates(wrong.labels, clip.labels)
    search = GroupingSearch([draw, draw], None, energy, TrajectoryClusteringParams(num_refined=1))
    found = search.best([3], margin=9.0)[2]
    assert not np.array_equal(found.labels, wrong.labels)


@pytest.mark.parametrize("num_more", [0, 1])
@pytest.mark.parametrize("is_longer", [False, True])
def test_a_grouping_that_only_lacks_a_merge_is_found(large_case, monkeypatch, num_more, is_longer):
    clip, energy = large_case
    # No move leads away from a grouping.
    monkeypatch.setattr(grouping_search, "refine_groupings", lambda starts, *_others: starts)
    if is_longer:
        bad = [np.arange(480) % 2, np.arange(480) // 7 % 2]
    else:
        bad = [np.where(np.arange(480) < count, 1, clip.labels == 1) for count in (10, 20)]
    assert all((energy.minimum([labels]).code > 1) == is_longer for labels in bad)
    draws = [_Candidates(labels, clip.labels) for labels in bad]
    search = GroupingSearch(draws, None, energy, TrajectoryClusteringParams(num_refined=1))
    found = search.best([2], num_more=num_more)
    assert set(found) == {2}
    merged = energy.minimum(merge_pairs(clip.labels)).labels
    assert (clustering_error(found[2].labels, merged) == 0) == (num_more > 0 and not is_longer)


def test_no_more_motions_are_searched_where_the_draws_agree(large_case):
    clip, energy = large_case
    draw = _Candidates(np.minimum(clip.labels, 1), clip.labels)
    asked = []

    def of(count):
        asked.append(count)
        return _Candidates.of(draw, count)

    draw.of = of
    GroupingSearch([draw, draw], None, energy, TrajectoryClusteringParams(num_refined=1)).best([2], num_more=1)
    assert set(asked) == {2}


def test_the_cost_of_a_union_is_the_growth_of_the_normalised_cut():
    kernel = np.random.default_rng(0).random((20, 20))
    kernel += kernel.T
    labels, pairs = np.arange(20) % 5, list(combinations(range(5), 2))

    def cut(labels):
        affinities = group_affinities(kernel, labels)
        return (1 - np.diag(affinities) / affinities.sum(axis=1)).sum()

    found = _cuts_of_unions(group_affinities(kernel, labels), pairs)
    np.testing.assert_allclose(found, [cut(_merge(labels, *pair)) - cut(labels) + 1 for pair in pairs])
