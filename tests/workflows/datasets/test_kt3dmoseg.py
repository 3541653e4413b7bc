"""Labelled trajectories as a data set: found and missing clips, and their content."""

import os
import pickle
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets import open_dataset
from moseg.workflows.sources import TrajectoryFile, TrajectoryLabels

REPOSITORY = Path(__file__).parents[3]
DATA = Path(os.environ.get("MOSEG_TEST_DATA", REPOSITORY.parent / "shared" / "data")) / "kt3dmoseg"


def write(path, labels=(1, 2, 2)):
    points = np.ones((3, len(labels), 4))
    fields = {"ySparse": points, "visibleSparse": np.ones(points.shape[1:]), "GtLabel": np.array(labels)[:, None]}
    path.parent.mkdir(parents=True, exist_ok=True)
    savemat(path, {"Data": fields})
    return path


def open_clips(root, *names):
    return open_dataset("kt3dmoseg", str(root), names or None, max_side=1280)


def test_a_file_is_a_clip_and_what_is_absent_is_named(tmp_path):
    for name in ("Seq028_clip03", "Seq005_Clip01"):
        write(tmp_path / f"{name}_Tracks.mat")
    (tmp_path / "SeqList.mat").write_bytes(b"")
    dataset = open_clips(tmp_path)
    assert dataset.names == ("Seq005_Clip01", "Seq028_clip03")
    assert len(dataset.absent) == 20 and "Seq005_Clip02" in dataset.absent
    assert not dataset.has_frames


def test_clips_outside_the_release_can_be_named(tmp_path):
    write(tmp_path / "mine_Tracks.mat")
    source = open_clips(tmp_path, "Mine").trajectories("mine")
    points, visible = source.trajectories.read()
    assert (points.shape, points.dtype, visible.all()) == ((3, 4, 2), np.float64, True)
    assert source.labels.read().tolist() == [1, 2, 2]
    assert pickle.loads(pickle.dumps(source)) == source


def test_a_root_without_clips_names_the_download(tmp_path):
    with pytest.raises(MissingInputError, match=r"_Tracks\.mat.*github\.com/alex-xun-xu/MultiViewMoSeg"):
        open_clips(tmp_path)


def test_a_data_set_has_either_frames_or_trajectories(tmp_path):
    write(tmp_path / "Seq005_Clip01_Tracks.mat")
    with pytest.raises(InputError, match="no frames in data set kt3dmoseg"):
        open_clips(tmp_path).sequence("Seq005_Clip01")
    with pytest.raises(InputError, match="no labelled trajectories in data set synthetic"):
        open_dataset("synthetic", max_side=1280).trajectories("pan")


def test_points_and_labels_of_one_file_are_two_sources_and_follow_its_bytes(tmp_path):
    path = str(write(tmp_path / "a_Tracks.mat"))
    sources = TrajectoryFile(path), TrajectoryLabels(path)
    before = [source.fingerprint() for source in sources]
    assert len(set(before)) == 2
    write(Path(path), labels=(1, 1, 2))
    assert not set(before) & {source.fingerprint() for source in sources}


@pytest.mark.skipif(not DATA.is_dir(), reason="no real clips of KT3DMoSeg: set MOSEG_TEST_DATA to their folder")
def test_real_clips_have_two_to_five_motions_and_at_most_twenty_frames():
    dataset = open_clips(DATA)
    assert len(dataset.names) + len(dataset.absent) == 22
    for name in dataset.names:
        source = dataset.trajectories(name)
        points, visible = source.trajectories.read()
        labels = source.labels.read()
        assert 10 <= points.shape[1] <= 20 and points.shape[:2] == visible.shape
        assert np.unique(labels).tolist() == list(range(1, labels.max() + 1)) and 2 <= labels.max() <= 5
        inside = points[visible]
        assert (inside >= -0.5).all() and (inside < (1242.5, 375.5)).all()
