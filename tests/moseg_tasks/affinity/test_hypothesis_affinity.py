"""Affinity from many hypotheses of motion."""

import numpy as np
import pytest
from scipy.cluster.hierarchy import cut_tree, linkage
from scipy.spatial.distance import squareform

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import AffinityParams, FundamentalParams
from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.tasks.affinity import hypothesis_affinity, ork_affinity
from moseg.tasks.affinity.hypothesis_affinity import draw_object_samples, fused_preferences
from moseg.tasks.affinity.preferences import fading_preference_kernel
from moseg.tasks.clustering.fusion import unit_diagonal
from moseg.tasks.geometry import fit_fundamentals, fundamental_residuals
from moseg.tasks.metrics.clustering_error import clustering_error
from moseg.tasks.synthetic.rigid_tracks import IMAGE_SHAPE, rigid_tracks

PARAMS = HypothesisAffinityParams()
ONE_EACH = (6, 1, 1)  # objects of the static scene and of two movers
SEEDS = range(4)


@pytest.fixture(scope="module")
def scenes():
    return [rigid_tracks(ONE_EACH, 8, 25, 0.1, np.random.default_rng(seed)) for seed in SEEDS]


def affinity_of(tracks, params=PARAMS, seed=0):
    return hypothesis_affinity(
        tracks.points, tracks.visible, tracks.owner, len(tracks.motion), params, np.random.default_rng(seed)
    )


def objects_wrong(affinity, motion) -> float:
    distance = 1.0 - np.minimum(affinity, 1.0)
    np.fill_diagonal(distance, 0.0)
    tree = linkage(squareform(distance, checks=False), "average")
    return clustering_error(cut_tree(tree, n_clusters=motion.max() + 1)[:, 0], motion)


def test_movers_of_one_object_each_are_separated(scenes):
    assert [objects_wrong(affinity_of(scene), scene.motion) for scene in scenes] == [0.0] * len(scenes)


@pytest.mark.parametrize("reading", ["objects", "models"])
def test_the_papers_ork_needs_two_objects_of_each_motion(scenes, reading):
    """Ranks have no scale: a lone mover must rank something second."""
    fundamental = FundamentalParams()
    wrong = []
    for scene in scenes:
        residuals = []
        for frame in range(scene.points.shape[1] - fundamental.gap):
            frames = [frame, frame + fundamental.gap]
            seen = scene.visible[:, frames].all(axis=1)
            tracks = *scene.points[seen][:, frames].swapaxes(0, 1), scene.owner[seen].astype(np.uint16)
            fits = fit_fundamentals(*tracks, 8, fundamental, np.random.default_rng(frame), IMAGE_SHAPE)
            residuals.append(fundamental_residuals(fits, *tracks, fundamental))
        ork = AffinityParams(method="ork", ork_reading=reading, ork_threshold=2)
        wrong.append(objects_wrong(unit_diagonal(ork_affinity(np.stack(residuals), ork)), scene.motion))
    assert np.count_nonzero(wrong) == len(scenes)


def test_the_order_of_objects_has_no_effect(scenes):
    """Movers first, last or anywhere: an affinity near the identity would give away where they stand."""
    scene = scenes[0]
    for order in (np.argsort(scene.motion), np.argsort(-scene.motion)):
        place = np.argsort(order)
        moved = scene._replace(owner=place[scene.owner], motion=scene.motion[order])
        assert objects_wrong(affinity_of(moved), moved.motion) == 0.0


def test_permuted_objects_have_permuted_affinities():
    rng = np.random.default_rng(0)
    residuals, order = rng.random((2, 5, 100, 6)), rng.permutation(6)
    found = fused_preferences(residuals[..., order], PARAMS)
    np.testing.assert_allclose(found, fused_preferences(residuals, PARAMS)[np.ix_(order, order)], atol=1e-12)


def test_objects_without_common_preferences_have_equal_affinities():
    residuals = np.ones((1, 3, 100, 5))
    for index in range(5):
        residuals[:, :, 20 * index : 20 * index + 20, index] = 0.1
    assert np.array_equal(fused_preferences(residuals, PARAMS), np.eye(5))


def test_hypotheses_that_fit_all_objects_equally_separate_none():
    np.testing.assert_allclose(fused_preferences(np.ones((2, 3, 100, 5)), PARAMS), np.ones((5, 5)))


@pytest.mark.parametrize("factor", [0.25, 3.0])
def test_the_scale_of_the_image_does_not_matter(scenes, factor):
    scene = scenes[1]
    larger = affinity_of(scene._replace(points=factor * scene.points + 7.0))
    np.testing.assert_allclose(larger, affinity_of(scene), atol=0.03)


def test_missing_pairs_take_no_part():
    residuals = np.random.default_rng(1).random((6, 100, 4))
    gone = residuals.copy()
    gone[2:, :, 3] = np.nan
    found = fading_preference_kernel(gone, window=0.1, fade=0.0)
    np.testing.assert_allclose(found[3], fading_preference_kernel(residuals[:2], window=0.1, fade=0.0)[3])
    np.testing.assert_allclose(found[:3, :3], fading_preference_kernel(residuals, window=0.1, fade=0.0)[:3, :3])


def test_objects_never_visible_together_have_unknown_affinity(scenes):
    scene = scenes[2]
    visible = scene.visible.copy()
    visible[scene.owner == 0, 4:] = visible[scene.owner == 1, :4] = False
    affinity = affinity_of(scene._replace(visible=visible))
    assert np.isnan(affinity[0, 1])
    assert np.isfinite(affinity[0, 2:]).all()
    assert np.isfinite(affinity[1, 2:]).all()


def test_values_unknown_to_one_model_are_those_of_the_other():
    residuals = np.random.default_rng(2).random((2, 3, 100, 4))
    residuals[0, :, :, 1] = np.nan
    found = fused_preferences(residuals, PARAMS)
    np.testing.assert_allclose(found[1, 2:], fused_preferences(residuals[1:], PARAMS)[1, 2:])


@pytest.mark.parametrize(("fusion", "expected"), [("product", (0.5 * 1.0) ** 0.5), ("sum", 0.75)])
def test_models_are_fused_and_raised_to_the_power_by_hand(fusion, expected):
    # Of ten hypotheses two are preferred: the first model's by half in common, the second's all.
    residuals = np.ones((2, 1, 10, 2))
    residuals[0, 0, [0, 1], 0] = residuals[0, 0, [1, 2], 1] = 0.1
    residuals[1, 0, [3, 4]] = 0.1
    params = HypothesisAffinityParams(window=0.2, fade=0.0, fusion=fusion, power=3.0)
    assert fused_preferences(residuals, params)[0, 1] == pytest.approx(expected**3)


def test_bad_hypotheses_in_common_are_no_likeness():
    """Two movers prefer the same hypotheses, which explain them far worse than others explain the scene."""
    residuals = np.random.default_rng(3).uniform(100.0, 200.0, (1, 1, 100, 5))
    residuals[..., :20, 3:] = 30.0
    residuals[..., 40:60, :3] = 0.01
    with_scale = fused_preferences(residuals, PARAMS.model_copy(update={"power": 1.0}))
    ranks_alone = fused_preferences(residuals, PARAMS.model_copy(update={"power": 1.0, "fade": 0.0}))
    assert ranks_alone[3, 4] == ranks_alone[0, 1] == pytest.approx(1.0)
    assert with_scale[0, 1] > 0.9
    assert with_scale[3, 4] < 0.01


@pytest.mark.parametrize(("excess", "expected"), [(0.0, 1.0), (100.0, 0.5), (300.0, 0.25)])
def test_a_preference_fades_with_what_it_leaves_beyond_the_typical(excess, expected):
    residuals = np.full((1, 100, 3), 1e4)
    residuals[:, :3] = 0.04
    residuals[:, :3, 2] += excess * 0.04
    kernel = fading_preference_kernel(residuals, window=0.01, fade=10.0)
    assert kernel[0, 1] == pytest.approx(1.0)
    assert kernel[0, 2] == pytest.approx(expected)


def test_too_few_tracks_are_unknown_unless_the_object_has_no_more(scenes):
    scene = scenes[3]
    own = np.flatnonzero(scene.owner == 0)
    visible = scene.visible.copy()
    visible[own[3:]] = False
    assert np.isnan(affinity_of(scene._replace(visible=visible))[0]).all()
    kept = np.setdiff1d(np.arange(len(scene.owner)), own[3:])
    small = scene._replace(points=scene.points[kept], visible=scene.visible[kept], owner=scene.owner[kept])
    assert np.isfinite(affinity_of(small)).all()


def test_every_track_may_be_an_object_of_its_own(scenes):
    scene = scenes[0]
    motion = scene.motion[scene.owner]
    alone = scene._replace(owner=np.arange(len(motion)), motion=motion)
    affinity = affinity_of(alone, PARAMS.model_copy(update={"power": 1.0}))
    same = motion[:, None] == motion[None, :]
    assert np.nanmean(affinity[same]) > 3 * np.nanmean(affinity[~same])


def test_the_same_generator_gives_the_same_affinity(scenes):
    np.testing.assert_array_equal(affinity_of(scenes[0], seed=5), affinity_of(scenes[0], seed=5))
    assert not np.array_equal(affinity_of(scenes[0], seed=5), affinity_of(scenes[0], seed=6))


def test_samples_are_of_a_few_objects_without_repetition():
    owner = np.repeat([3, 7, 8, 20], [40, 10, 100, 8])
    samples = draw_object_samples(owner, 8, 200, 2, np.random.default_rng(0))
    assert all(len(set(sample)) == 8 for sample in samples.tolist())
    sampled = [set(owner[sample]) for sample in samples]
    assert max(map(len, sampled)) == 2
    # Objects are drawn, not tracks: two in twelve pairs are of the two small ones.
    assert {3, 7, 8, 20} == set().union(*sampled)
    assert 15 < sum(found <= {7, 20} for found in sampled) < 60


def test_a_sample_that_few_objects_cannot_fill_takes_tracks_of_others():
    owner = np.arange(30)
    samples = draw_object_samples(owner, 8, 50, 3, np.random.default_rng(0))
    assert all(len(set(sample)) == 8 for sample in samples.tolist())


def test_with_too_few_tracks_for_a_sample_all_are_unknown():
    points, visible = np.random.default_rng(0).random((3, 6, 2)), np.ones((3, 6), bool)
    affinity = hypothesis_affinity(points, visible, np.array([0, 0, 1]), 2, PARAMS, np.random.default_rng(0))
    assert np.isnan(affinity).all()


def test_a_clip_shorter_than_the_gap_pairs_its_ends(scenes):
    short = scenes[0]._replace(points=scenes[0].points[:, :3], visible=scenes[0].visible[:, :3])
    assert not np.isnan(affinity_of(short)).any()


def test_with_a_single_frame_all_are_unknown(scenes):
    frame = scenes[0]._replace(points=scenes[0].points[:, :1], visible=scenes[0].visible[:, :1])
    assert np.isnan(affinity_of(frame)).all()


@pytest.mark.parametrize("models", [("trifocal",), ("oc_depth",), ("no such model",)])
def test_a_model_that_two_frames_of_tracks_do_not_determine_is_an_input_error(scenes, models):
    with pytest.raises(InputError, match="model"):
        affinity_of(scenes[0], HypothesisAffinityParams().model_copy(update={"models": models}))


def test_tracks_that_disagree_are_an_input_error(scenes):
    scene = scenes[0]
    with pytest.raises(InputError, match="tracks disagree in shape in affinity"):
        affinity_of(scene._replace(owner=scene.owner[1:]))
    with pytest.raises(InputError, match="object out of range in owner; got 9; expected 0 "):
        affinity_of(scene._replace(owner=np.where(scene.owner == 7, 9, scene.owner)))
