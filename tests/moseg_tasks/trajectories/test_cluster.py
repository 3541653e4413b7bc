"""Laws of motion groups of trajectories."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import (
    EnergyParams,
    HypothesisParams,
    KernelParams,
    PieceParams,
    TrajectoryClusteringParams,
)
from moseg.tasks.metrics import clustering_error
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import (
    HypothesisResiduals,
    View,
    cluster_trajectories,
    draw_hypotheses,
    trajectory_kernels,
)
from moseg.tasks.trajectories.grouping_search import GroupingSearch

MODELS = ("affine", "homography", "fundamental")
DRAWN = HypothesisParams(num_hypotheses=100, num_draws=2, gaps=(1,))
PARAMS = TrajectoryClusteringParams(pieces=PieceParams(counts=(5, 7)), energy=EnergyParams(spacing=0.3))


def _draws(points, visible, models=MODELS, seed=0):
    rng, by_model = np.random.default_rng(seed), []
    for name in models:
        found = draw_hypotheses(points, visible, POINT_MODELS[name], DRAWN, rng)
        residuals = HypothesisResiduals(found, points, visible, POINT_MODELS[name])
        kernels = trajectory_kernels(residuals, DRAWN.num_draws, KernelParams())
        by_model.append(list(map(View, kernels, residuals.draws(DRAWN.num_draws))))
    return list(zip(*by_model, strict=True))


_DRAWS = {}


def _cluster(clip, count, params=PARAMS, models=MODELS):
    key = (clip.points.tobytes(), clip.visible.tobytes(), models)
    if key not in _DRAWS:
        _DRAWS[key] = _draws(clip.points, clip.visible, models)
    draws = _DRAWS[key]
    return cluster_trajectories(draws, clip.points, clip.visible, count, params, np.random.default_rng(0))


@pytest.mark.parametrize("sizes", [(80, 30), (80, 30, 25), (80, 25, 25, 25)])
def test_rigid_motions_are_separated(sizes, rigid_clip):
    clip = rigid_clip(sizes)
    found = _cluster(clip, len(sizes))
    assert clustering_error(found.motion, clip.labels) <= 2
    assert found.num_motions == len(sizes) and found.motion.dtype == np.uint16


@pytest.mark.parametrize("method", ["sum", "product", "coregularised"])
def test_published_methods_separate_them_as_well(method, rigid_clip):
    clip = rigid_clip((80, 30, 25))
    found = _cluster(clip, 3, PARAMS.model_copy(update={"method": method}))
    assert clustering_error(found.motion, clip.labels) <= 5


def test_the_objective_of_coregularisation_never_falls(rigid_clip):
    params = PARAMS.model_copy(update={"method": "coregularised", "co_regularisation": 0.1})
    objective = _cluster(rigid_clip((80, 30)), 2, params).objective
    assert len(objective) > 1 and (np.diff(objective) > -1e-9).all()


def test_the_order_of_trajectories_does_not_matter(rigid_clip):
    clip = rigid_clip((80, 30, 25))
    order = np.random.default_rng(4).permutation(len(clip.labels))
    shuffled = clip._replace(points=clip.points[order], visible=clip.visible[order], labels=clip.labels[order])
    assert clustering_error(_cluster(shuffled, 3).motion, shuffled.labels) <= 2


def test_the_same_generator_gives_the_same_groups(rigid_clip):
    clip = rigid_clip((80, 30))
    first = _cluster(clip, 2).motion
    _DRAWS.clear()
    assert np.array_equal(_cluster(clip, 2).motion, first)


def test_no_more_motions_are_found_than_asked_for(rigid_clip):
    clip = rigid_clip((30, 10))
    for count in (1, 5, 60):
        assert _cluster(clip, count, models=("affine",)).num_motions <= min(count, 40)


def test_costs_of_each_number_of_motions_are_returned(rigid_clip):
    clip = rigid_clip((80, 30, 25))
    found = _cluster(clip, None)
    assert len(found.costs) == PARAMS.most_motions and found.cuts[0] == pytest.approx(0, abs=1e-6)
    assert found.costs[2] < found.costs[1] < found.costs[0]


def test_bad_input_is_named(rigid_clip):
    clip = rigid_clip((30, 10))
    with pytest.raises(InputError, match="no view"):
        cluster_trajectories([], clip.points, clip.visible, 2, PARAMS, np.random.default_rng(0))
    with pytest.raises(InputError, match="too few motions"):
        _cluster(clip, 0)


@pytest.mark.parametrize("auto", ["energy", "description_length", "geometric"])
@pytest.mark.parametrize("sizes", [(80,), (80, 30), (80, 30, 25)])
def test_the_number_of_motions_is_found(rigid_clip, sizes, auto):
    clip = rigid_clip(sizes)
    # These bodies are transparent: the background's points between theirs would part them.
    found = _cluster(clip, None, PARAMS.model_copy(update={"auto": auto, "separate": False}))
    assert found.num_motions == len(sizes)
    assert clustering_error(found.motion, clip.labels) <= 2


def test_a_number_is_not_found_if_one_of_its_motions_has_too_few_trajectories(rigid_clip):
    clip = rigid_clip((80, 30, 25))
    free, costly = (PARAMS.energy.model_copy(update={"free_motions": free}) for free in (3, 2))
    for energy, min_tracks, count in ((costly, 25, 3), (costly, 27, 2), (free, 27, 3)):
        params = PARAMS.model_copy(update={"separate": False, "energy": energy, "min_tracks": min_tracks})
        assert _cluster(clip, None, params).num_motions == count


def test_groupings_with_a_motion_too_small_are_ruled_out_before_numbers_are_compared(rigid_clip, monkeypatch):
    clip = rigid_clip((80, 30, 25))
    small = np.where(np.arange(135) < 8, 2, np.minimum(clip.labels, 1))
    best, penalties = GroupingSearch.best, []

    def best_under(self, counts, penalty, *others, **named):
        penalties.append([penalty(small), penalty(clip.labels), penalty(small % 2)])
        return best(self, counts, penalty, *others, **named)

    monkeypatch.setattr(GroupingSearch, "best", best_under)
    _cluster(clip, None, PARAMS.model_copy(update={"separate": False, "min_tracks": 20}))
    assert penalties == [[np.inf, 0, 0]]


@pytest.mark.parametrize("count", [4, 9])
def test_as_many_motions_are_found_as_are_asked_for(rigid_clip, count):
    assert _cluster(rigid_clip((80, 30)), count).num_motions == count


def test_a_large_gap_of_the_spectrum_is_looked_for_among_the_motions_allowed(rigid_clip):
    found = _cluster(rigid_clip((150, 80)), None, PARAMS.model_copy(update={"auto": "eigengap", "method": "sum"}))
    assert 1 <= found.num_motions <= PARAMS.most_motions


def test_stability_needs_two_draws(rigid_clip):
    with pytest.raises(InputError, match="two draws"):
        _cluster(rigid_clip((40, 20)), None, PARAMS.model_copy(update={"auto": "stability", "method": "sum"}))


@pytest.mark.parametrize("auto", ["confidences", "stability"])
def test_other_methods_find_two_clear_motions(rigid_clip, auto):
    clip = rigid_clip((80, 50))
    assert _cluster(clip, None, PARAMS.model_copy(update={"auto": auto})).num_motions == 2
