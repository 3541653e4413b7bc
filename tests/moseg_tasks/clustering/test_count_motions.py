"""The number of motions from what tracks and affinities say of clusterings into 1, 2, ... motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import ClusteringParams
from moseg.schemas.parameters.clustering import COUNT_READS, TRACK_METHODS, MotionCountParams
from moseg.tasks.clustering import CountEvidence, MotionTracks, cluster_motions, count_motions
from moseg.tasks.clustering.confidences import confidences
from moseg.tasks.clustering.count_motions import count_by_eigengap
from moseg.tasks.clustering.stability import resampled_affinities
from moseg.tasks.synthetic.rigid_tracks import rigid_tracks

PARAMS = MotionCountParams()
SCENES = [[6], [5, 1], [5, 1, 1], [3, 2, 2]]


def scene(num_objects, noise=0.05, seed=0, tracks_per_object=25) -> tuple[MotionTracks, np.ndarray]:
    found = rigid_tracks(num_objects, 8, tracks_per_object, noise, np.random.default_rng(seed))
    return MotionTracks(found.points, found.visible, found.owner), found.motion


def labelings(motion: np.ndarray, most: int = 6) -> list[np.ndarray]:
    """Into 1, 2, ... motions: the last motions merged, all true ones, then objects split off one after the other."""
    num = motion.max() + 1
    found = [np.minimum(motion, count - 1) for count in range(1, num + 1)]
    while len(found) < min(most, len(motion)):
        labels = found[-1].copy()
        largest = np.bincount(labels).argmax()
        labels[np.flatnonzero(labels == largest)[0]] = len(found)
        found.append(labels)
    return found


def affinity_of(motion: np.ndarray, seed: int = 0, alike: float = 0.9) -> np.ndarray:
    noise = np.random.default_rng(seed).uniform(0, 0.1, (len(motion),) * 2)
    matrix = np.where(motion[:, None] == motion[None, :], alike, 0.0) + (noise + noise.T) / 2
    np.fill_diagonal(matrix, 1.0)
    return matrix


def evidence(tracks: MotionTracks, motion: np.ndarray) -> CountEvidence:
    return CountEvidence(labelings(motion), affinity_of(motion), np.ones((1, len(motion))), (tracks,))


def count(tracks, motion, method, params=PARAMS) -> int:
    return count_motions(evidence(tracks, motion), method, params, np.random.default_rng(0)).num_motions


@pytest.mark.parametrize("method", TRACK_METHODS)
@pytest.mark.parametrize("num_objects", SCENES)
@pytest.mark.parametrize("seed", range(3))
def test_the_number_of_motions_is_found_from_tracks(method, num_objects, seed):
    assert count(*scene(num_objects, seed=seed), method) == len(num_objects)


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.5, 1.0])
def test_nothing_moves_in_a_static_scene_however_noisy(noise):
    for seed in range(4):
        assert count(*scene([6], noise, seed), "description_length") == 1


def test_a_fixed_penalty_counts_noise_as_motion_and_the_description_length_does_not():
    params = MotionCountParams(motion_price=0.005)
    noisy = [scene([6], 0.5, seed) for seed in range(4)]
    assert max(count(*static, "geometric", params) for static in noisy) > 1


def test_a_mover_of_few_tracks_is_found_by_its_affine_geometry():
    tracks, motion = scene([5, 1], noise=0.02)
    mover = np.flatnonzero(motion[tracks.owner] == 1)
    kept = np.setdiff1d(np.arange(len(tracks.owner)), mover[7:])
    few = MotionTracks(*(array[kept] for array in tracks))
    assert count(few, motion, "description_length") == 2


@pytest.mark.parametrize("method", TRACK_METHODS)
@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_objects_and_tracks_does_not_matter(method, seed):
    tracks, motion = scene([4, 1, 1])
    rng = np.random.default_rng(seed)
    place, shuffled = rng.permutation(len(motion)), rng.permutation(len(tracks.owner))
    moved = np.empty_like(motion)
    moved[place] = motion
    other = MotionTracks(tracks.points[shuffled], tracks.visible[shuffled], place[tracks.owner][shuffled])
    assert count(other, moved, method) == count(tracks, motion, method) == 3


def test_sections_count_as_one_video():
    tracks, motion = scene([4, 1])
    halves = [
        MotionTracks(tracks.points[:, part], tracks.visible[:, part], tracks.owner)
        for part in (slice(0, 5), slice(3, 8))
    ]
    both = evidence(tracks, motion)._replace(tracks=halves)
    assert count_motions(both, "description_length", PARAMS, np.random.default_rng(0)).num_motions == 2


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**16), price=st.floats(0.5, 50))
def test_a_dearer_parameter_never_buys_more_motions(seed, price):
    tracks, motion = scene([4, 1], seed=seed % 5)
    cheap = count(tracks, motion, "description_length", MotionCountParams(parameter_price=0.0))
    dear = count(tracks, motion, "description_length", MotionCountParams(parameter_price=price))
    assert dear <= cheap


def test_scores_are_the_same_for_the_same_seed():
    case = evidence(*scene([4, 1]))
    first, second = (count_motions(case, "description_length", PARAMS, np.random.default_rng(3)) for _ in range(2))
    assert np.array_equal(first.scores, second.scores)
    assert first.scores.argmax() + 1 == first.num_motions


@pytest.mark.parametrize("sizes", [(4, 3), (4, 3, 3), (3, 3, 3, 3)])
def test_clear_clusters_are_counted_by_their_confidences(sizes):
    motion = np.repeat(np.arange(len(sizes)), sizes)
    kernel = affinity_of(motion)
    spectrum = np.sort(np.linalg.eigvalsh(kernel))[None, ::-1] / 3
    case = CountEvidence(labelings(motion), kernel, spectrum)
    assert count_motions(case, "confidences", PARAMS).num_motions == len(sizes)


def test_without_a_clear_cluster_there_is_one_motion():
    motion = np.repeat([0, 1], 4)
    case = CountEvidence(labelings(motion), affinity_of(motion), np.ones((1, 8)))
    assert count_motions(case, "confidences", MotionCountParams(least_silhouette=1.0)).num_motions == 1
    assert np.isfinite(count_motions(case, "confidences", PARAMS).scores).all()
    lone = CountEvidence([np.zeros(1, int)], np.ones((1, 1)), np.ones((1, 1)))
    assert count_motions(lone, "confidences", PARAMS).num_motions == 1


def test_what_comes_back_in_every_resample_is_counted():
    motion = np.repeat([0, 1, 2], 3)
    rng = np.random.default_rng(0)
    resampled = []
    for _ in range(4):
        found = labelings(motion)
        resampled.append([*found[:1], rng.permutation(found[1]), found[2], *map(rng.permutation, found[3:])])
    case = CountEvidence(labelings(motion), affinity_of(motion), np.ones((1, 9)), (), resampled)
    assert count_motions(case, "stability", PARAMS).num_motions == 3
    nothing = case._replace(resampled=[[rng.permutation(labels) for labels in found] for found in resampled])
    assert count_motions(nothing, "stability", PARAMS).num_motions == 1


def test_resamples_see_the_motions_of_their_half_of_the_frames():
    tracks, motion = scene([4, 1, 1])
    params = MotionCountParams(num_resamples=3)
    found = resampled_affinities([tracks], len(motion), params, np.random.default_rng(0))
    same = motion[:, None] == motion[None, :]
    assert len(found) == 3 and not np.array_equal(found[0], found[1])
    for affinity in found:
        assert affinity.shape == same.shape and np.isfinite(affinity).all()
        assert affinity[~same].max() < 0.1


def test_a_section_of_one_frame_has_no_pair_to_resample():
    tracks, motion = scene([4, 1, 1])
    one = tracks._replace(points=tracks.points[:, :1], visible=tracks.visible[:, :1])
    params = MotionCountParams(num_resamples=2)
    found = resampled_affinities([tracks, one], len(motion), params, np.random.default_rng(0))
    assert len(found) == 2 and all(np.isfinite(affinity).all() for affinity in found)


@pytest.mark.parametrize("grouping", ["linkage", "spectral"])
@pytest.mark.parametrize("auto", TRACK_METHODS)
def test_objects_are_grouped_into_as_many_motions_as_their_tracks_show(auto, grouping):
    tracks, motion = scene([5, 1, 1])
    # Object 0 has to be of the background.
    place = np.argsort(np.argsort(motion, kind="stable"))
    motion, tracks = np.sort(motion), tracks._replace(owner=place[tracks.owner])
    params = ClusteringParams(auto=auto, grouping=grouping)
    result = cluster_motions([affinity_of(motion)], None, params, None, (tracks,), np.random.default_rng(0))
    assert result.motion.tolist() == motion.tolist()
    assert len(result.scores) == 6 and result.scores.argmax() == 2


def test_objects_are_grouped_into_motions_that_come_back():
    tracks, motion = scene([4, 4])
    place = np.argsort(np.argsort(motion, kind="stable"))
    motion, tracks = np.sort(motion), tracks._replace(owner=place[tracks.owner])
    params = ClusteringParams(auto="stability")
    result = cluster_motions([affinity_of(motion)], None, params, None, (tracks,), np.random.default_rng(0))
    assert result.motion.tolist() == motion.tolist()


def test_known_static_objects_are_one_motion():
    tracks, motion = scene([5, 1, 1])
    place = np.argsort(np.argsort(motion, kind="stable"))
    motion, tracks = np.sort(motion), tracks._replace(owner=place[tracks.owner])
    params = ClusteringParams(auto="description_length")
    result = cluster_motions([affinity_of(motion)], None, params, motion == 0, (tracks,), np.random.default_rng(0))
    assert result.motion.tolist() == motion.tolist()


def test_without_tracks_they_raise_an_error():
    motion = np.repeat([0, 1], 3)
    case = CountEvidence(labelings(motion), affinity_of(motion), np.ones((1, 6)))
    for method in (*TRACK_METHODS, "stability", "guess"):
        with pytest.raises(InputError):
            count_motions(case, method, PARAMS, np.random.default_rng(0))
    with pytest.raises(InputError, match="no clustering"):
        count_motions(case._replace(labelings=[]), "confidences", PARAMS)
    for auto in (*TRACK_METHODS, "stability"):
        with pytest.raises(InputError, match="no tracks"):
            cluster_motions([affinity_of(motion)], None, ClusteringParams(auto=auto))


def test_tracks_of_no_object_and_of_wrong_shape_are_refused():
    tracks, motion = scene([4, 1])
    case = evidence(tracks, motion)
    for bad in (tracks._replace(owner=tracks.owner + 9), tracks._replace(visible=tracks.visible[:, 1:])):
        with pytest.raises(InputError, match="tracks"):
            count_motions(case._replace(tracks=(bad,)), "geometric", PARAMS, np.random.default_rng(0))


def test_every_parameter_of_a_count_is_read_by_some_method():
    assert frozenset().union(*COUNT_READS.values()) == set(MotionCountParams.model_fields)


def test_the_gap_after_the_largest_number_counts_too():
    assert count_by_eigengap(np.array([[1.0, 0.9, 0.8, 0.1, 0.0]]), 3) == 3


def test_every_index_is_largest_for_the_true_number_of_clusters():
    motion = np.repeat([0, 1, 2], [4, 3, 3])
    kernel = affinity_of(motion)
    found = [motion * 0, np.minimum(motion, 1), motion, np.where(np.arange(10) == 0, 3, motion)]
    spectrum = np.sort(np.linalg.eigvalsh(kernel))[None, ::-1] / 3
    assert (confidences(found, kernel, spectrum).argmax(axis=0) + 2).tolist() == [3, 3, 3, 3]


def test_resampled_pairs_keep_their_gap(monkeypatch):
    pairs = []

    def affinity(points, visible, owner, num_owners, params, rng):
        frames = points[0, :, 0]
        pairs.extend(zip(frames[: -params.gap], frames[params.gap :], strict=True))
        return np.eye(num_owners)

    monkeypatch.setattr("moseg.tasks.clustering.stability.hypothesis_affinity", affinity)
    points = np.repeat(np.arange(9.0)[None, :, None], 2, axis=2)
    tracks = MotionTracks(points, np.ones((1, 9), bool), np.zeros(1, np.uint16))
    resampled_affinities([tracks], 1, MotionCountParams(gap=3, num_resamples=4), np.random.default_rng(0))
    assert len(pairs) == 4 * 3 and all(second - first == 3 for first, second in pairs)
