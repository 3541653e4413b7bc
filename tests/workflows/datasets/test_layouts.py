import pickle

import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets import DATASETS, open_dataset


def open_only(name, root, sequence, **options):
    return open_dataset(name, str(root), (sequence,), max_side=100, **options).sequence(sequence)


def annotated(source):
    return {index: int(labels.max()) for index, labels in source.annotations.read()}


@pytest.fixture
def davis(tmp_path, write_sequence):
    def write(sequence, values, **options):
        trees = [tmp_path / tree / "480p" / sequence for tree in ("JPEGImages", "Annotations")]
        write_sequence(*trees, values, **options)
        return tmp_path

    return write


def test_davis16_is_binary_and_has_no_void(davis):
    source = open_only("davis16", davis("dog", {0: 255, 1: 0, 2: 38}), "dog")
    assert annotated(source) == {0: 1, 1: 0, 2: 1}
    assert (source.void, source.num_motions) == (None, None)
    assert len(list(source.frames.read())) == 3


def test_davis_moving_has_instances_and_void(davis):
    source = open_only("davis-moving", davis("pigs", {0: 3, 1: 255}), "pigs")
    assert annotated(source) == {0: 3, 1: 255}
    assert source.void == 255


def test_binary_masks_are_not_taken_for_void(davis):
    """Check that DAVIS-2016's annotations below DAVIS-Moving's root, which leave nothing to score, are refused."""
    with pytest.raises(InputError, match="without object ids"):
        open_only("davis-moving", davis("dog", {0: 255, 1: 0}), "dog")


def test_youtube_vos_is_annotated_every_fifth_frame(tmp_path, write_sequence):
    trees = tmp_path / "JPEGImages" / "003234408d", tmp_path / "Annotations" / "003234408d"
    write_sequence(*trees, {0: 1, 5: 2, 10: 1}, num_frames=11)
    source = open_only("ytvos-moving", tmp_path, "003234408d")
    assert annotated(source) == {0: 1, 5: 2, 10: 1}
    assert source.void is None


@pytest.mark.parametrize("frames", ["images", "image_02", "image_02/data", "frames"])
def test_kitti_clips_keep_frames_and_masks_together(tmp_path, write_sequence, frames):
    clip = tmp_path / "Seq009_Clip01"
    write_sequence(clip / frames, clip / "masks", {1: 4}, suffix=".png")
    source = open_only("kt3dinsmoseg", tmp_path, "Seq009_Clip01")
    assert annotated(source) == {1: 4}
    assert source.void == 255


@pytest.mark.parametrize(
    ("values", "expected", "void"), [({0: 1, 1: 255}, {0: 1, 1: 255}, 255), ({0: 255, 1: 0}, {0: 1, 1: 0}, None)]
)
def test_a_folder_distinguishes_instances_and_binary_masks(tmp_path, write_sequence, values, expected, void):
    write_sequence(tmp_path / "a" / "frames", tmp_path / "a" / "masks", values)
    source = open_only("folder", tmp_path, "a")
    assert annotated(source) == expected
    assert source.void == void


def test_a_folder_needs_no_masks(tmp_path, write_sequence):
    for name in ("clip10", "clip9", "vidéo 映像"):
        write_sequence(tmp_path / name / "frames", None, {})
    (tmp_path / "notes").mkdir()
    dataset = open_dataset("folder", str(tmp_path), max_side=100)
    assert dataset.names == ("clip9", "clip10", "vidéo 映像")
    assert dataset.sequence("vidéo 映像").annotations is None


@pytest.mark.parametrize("frames", ["frames", "."])
def test_a_folder_may_be_a_single_sequence(tmp_path, write_sequence, frames):
    write_sequence(tmp_path / "car" / frames, tmp_path / "car" / "masks", {2: 1})
    dataset = open_dataset("folder", str(tmp_path / "car"), max_side=100)
    assert dataset.names == ("car",)
    assert annotated(dataset.sequence("car")) == {2: 1}


def test_a_benchmark_needs_annotations(davis):
    with pytest.raises(MissingInputError, match="sequence dog has no annotations"):
        open_only("davis16", davis("dog", {}), "dog")


def test_a_mask_without_a_frame_is_named(davis):
    with pytest.raises(InputError, match=r"without a frame in .*00007\.png"):
        open_only("davis16", davis("dog", {0: 1, 7: 1}), "dog")


def test_ground_truth_of_another_size_is_named(davis, write_png):
    root = davis("dog", {0: 1})
    write_png(root / "Annotations" / "480p" / "dog" / "00001.png", 1, size=(8, 6))
    with pytest.raises(InputError, match=r"00001\.png; got 6x8 px; expected 6x4 px"):
        annotated(open_only("davis16", root, "dog"))


def test_ground_truth_is_not_reduced_with_the_frames(davis):
    source = open_dataset("davis16", str(davis("dog", {0: 1})), ("dog",), max_side=3).sequence("dog")
    assert next(source.frames.read()).shape == (2, 3, 3)
    assert next(source.annotations.read())[1].shape == (4, 6)


def test_scenes_have_every_cue():
    source = open_dataset("synthetic", sequences=("two-motions",), max_side=100).sequence("two-motions")
    cues = (source.objects, source.depth, source.flow_forward, source.flow_backward, source.tracks)
    assert all(cue is not None for cue in cues)
    assert source.flow_forward != source.flow_backward
    assert source.annotations != source.objects
    assert source.num_motions >= 2


def test_sources_and_data_sets_can_be_sent_to_workers(davis):
    dataset = open_dataset("davis16", str(davis("dog", {0: 1})), ("dog",), max_side=100)
    assert pickle.loads(pickle.dumps(dataset)) == dataset
    assert pickle.loads(pickle.dumps(dataset.sequence("dog"))) == dataset.sequence("dog")


def test_official_lists_have_their_published_sizes():
    sizes = {name: len(layout.official) for name, layout in DATASETS.items() if layout.official and layout.needs_root}
    frames = {"davis16": 20, "davis-moving": 22, "kt3dinsmoseg": 22}
    assert sizes == {**frames, "kt3dmoseg": 22, "hopkins155": 156, "hopkins12": 12, "mtpv62": 62}
    assert all(len(set(layout.official)) == len(layout.official) for layout in DATASETS.values() if layout.official)


def test_a_broken_sequence_does_not_affect_the_others(davis, write_png):
    root = davis("dog", {0: 255})
    davis("cows", {0: 255})
    write_png(root / "JPEGImages" / "480p" / "cows" / "00000.png")
    (root / "JPEGImages" / "480p" / "libby").mkdir()
    dataset = open_dataset("davis16", str(root), max_side=100)
    assert dataset.names == ("cows", "dog")
    assert len(list(dataset.sequence("dog").frames.read())) == 3
    with pytest.raises(InputError, match="two files of one stem"):
        dataset.sequence("cows")
