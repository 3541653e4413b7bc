"""Real sequences and videos, if they are on this machine."""

import os
from pathlib import Path

import numpy as np
import pytest

from moseg.workflows.datasets import open_dataset
from moseg.workflows.sources import open_frames

REPOSITORY = Path(__file__).parents[3]
DATA = Path(os.environ.get("MOSEG_TEST_DATA", REPOSITORY.parent / "shared" / "data"))


@pytest.mark.skipif(
    not (DATA / "davis").is_dir(), reason="no real DAVIS sequences: set MOSEG_TEST_DATA to their folder"
)
def test_davis16_reads_frames_with_their_annotations():
    dataset = open_dataset("davis16", str(DATA / "davis"), max_side=854)
    assert len(dataset.names) + len(dataset.absent) == 20
    source = dataset.sequence("car-shadow")
    assert source.frames.describe().size == (480, 854)
    labels = dict(source.annotations.read())
    assert list(labels) == list(range(len(source.frames.paths)))
    assert {label.shape for label in labels.values()} == {(480, 854)}
    assert set(np.unique(labels[0])) == {0, 1}


@pytest.mark.skipif(not (DATA / "video").is_dir(), reason="no real videos: set MOSEG_TEST_DATA to their folder")
@pytest.mark.parametrize(("name", "num_frames"), [("bear", 82), ("paragliding", 70)])
def test_real_videos_decode_to_their_end(name, num_frames):
    video = open_frames(str(DATA / "video" / f"{name}.mp4"), 854)
    assert video.describe() == ((480, 854), 30.0)
    assert sum(frame.shape == (480, 854, 3) for frame in video.read()) == num_frames
