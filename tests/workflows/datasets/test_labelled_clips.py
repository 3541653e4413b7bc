"""KT3DInsMoSeg's clips with labelled trajectories in place of masks."""

import pickle

import numpy as np
import pytest
from scipy.io import savemat

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets import describe_dataset, find_ground_truth, open_dataset
from moseg.workflows.datasets.kt3dmoseg import find_tracks

CLIP = "Seq028_clip03"
NAME = f"{CLIP}_Tracks.mat"


def write_tracks(path, num_frames=3):
    path.parent.mkdir(parents=True, exist_ok=True)
    points = np.ones((3, 4, num_frames))
    savemat(path, {"Data": {"ySparse": points, "visibleSparse": points[0], "GtLabel": np.array([1, 2, 1, 3])}})


@pytest.fixture
def clip(tmp_path, write_sequence):
    """Return the folder of a clip with three frames whose numbers do not begin at 0."""
    write_sequence(tmp_path / CLIP / "images", tmp_path / CLIP / "masks", {}, suffix=".png")
    for number in (2, 1, 0):
        image = tmp_path / CLIP / "images" / f"{number:05d}.png"
        image.rename(image.with_name(f"{number + 105:010d}.png"))
    return tmp_path / CLIP


def open_clip(root, max_side=100):
    return open_dataset("kt3dinsmoseg", str(root), (CLIP,), max_side=max_side).sequence(CLIP)


@pytest.mark.parametrize(
    "place", [f"{CLIP}/{NAME}", f"{CLIP}/any_tracks.MAT", NAME, NAME.upper(), f"{CLIP}/{NAME.lower()}"]
)
def test_trajectories_are_found_in_the_clip_or_beside_it_in_any_letter_case(clip, place):
    write_tracks(clip.parent / place)
    source = open_clip(clip.parent)
    assert source.annotations is None
    assert source.labelled_points.read().labels.tolist() == [0, 2, 0, 3]
    assert find_ground_truth([source]) == "points"
    assert pickle.loads(pickle.dumps(source)) == source


def test_a_point_without_a_label_is_not_scored(clip):
    fields = {"ySparse": np.ones((3, 4, 3)), "GtLabel": np.array([1, 0, 2, 0])}
    savemat(clip / NAME, {"Data": fields})
    found = open_clip(clip.parent).labelled_points.read()
    assert found.visible.any(axis=1).tolist() == [True, False, True, False]
    assert found.labels.tolist() == [0, 0, 2, 0]


def test_points_keep_the_frames_own_size(clip):
    write_tracks(clip / NAME)
    assert open_clip(clip.parent, max_side=3).labelled_points.size == (4, 6)


def test_masks_are_used_rather_than_trajectories(clip, write_png):
    write_tracks(clip / NAME)
    write_png(clip / "masks" / f"{105:010d}.png", 4)
    source = open_clip(clip.parent)
    assert source.labelled_points is None
    assert [(index, int(labels.max())) for index, labels in source.annotations.read()] == [(0, 4)]


def test_the_file_of_the_clips_name_is_used_and_others_are_ambiguous(clip):
    write_tracks(clip / "a_Tracks.mat")
    write_tracks(clip / "b_Tracks.mat")
    with pytest.raises(InputError, match=rf"no trajectories of this clip .*got a_Tracks.mat, b_Tracks.mat.*{NAME}"):
        open_clip(clip.parent)
    write_tracks(clip / NAME)
    assert find_tracks(str(clip.parent), CLIP) == str(clip / NAME)


def test_another_clips_trajectories_beside_it_are_not_its_own(clip):
    write_tracks(clip.parent / "Seq009_Clip01_Tracks.mat")
    (clip / "masks").mkdir()
    with pytest.raises(MissingInputError, match=rf"{CLIP} has no annotations; expected masks in .* or .*{NAME}"):
        open_clip(clip.parent)


def test_a_clip_with_more_images_than_its_trajectories_have_frames_is_refused(clip):
    write_tracks(clip / NAME, num_frames=2)
    with pytest.raises(InputError, match=rf"{NAME}; got 2 frames; expected 3, as many as the clip has images"):
        open_clip(clip.parent).labelled_points.read()


def test_masks_and_points_have_no_common_mean(clip, write_sequence):
    write_tracks(clip / NAME)
    other = clip.parent / "Seq009_Clip01"
    write_sequence(other / "images", other / "masks", {0: 3}, suffix=".png")
    dataset = open_dataset("kt3dinsmoseg", str(clip.parent), max_side=100)
    sources = [dataset.sequence(name) for name in dataset.names]
    with pytest.raises(InputError, match=rf"two kinds.*masks for Seq009_Clip01 and only labelled points for {CLIP}"):
        find_ground_truth(sources)
    assert [find_ground_truth([source]) for source in sources] == ["pixels", "points"]
    with pytest.raises(InputError, match=f"no ground truth .* sequence {CLIP}"):
        find_ground_truth([sources[0], sources[1]._replace(labelled_points=None)])


def test_both_layouts_are_described(clip):
    row = describe_dataset("kt3dinsmoseg", str(clip.parent), {})
    assert row.names == (CLIP,)
    assert "masks/*.png" in row.tree
    assert "<clip>_Tracks.mat" in row.tree
    assert {"masks", "points"} <= set(row.ground_truth.replace(",", "").split())
