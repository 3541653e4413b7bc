"""Samples that stay in the memory of a GPU are those of the files."""

import numpy as np
import pytest
import torch

from moseg.workflows.training.sample_reader import SampleReader
from moseg.workflows.training.shards import plan_shards


@pytest.mark.parametrize("rows", [np.array([1]), np.array([0, 1]), slice(0, 2)])
def test_samples_that_were_kept_are_those_of_the_files(rows, scene_files, monkeypatch):
    (shard,) = plan_shards(scene_files / "scenes", 0, 0, 2, 2)
    read = SampleReader(torch.device("cpu")).read(shard, rows)
    keeping = SampleReader(torch.device("cpu"))
    monkeypatch.setattr(keeping, "_has_room", lambda: True)
    first = keeping.read(shard, rows)
    monkeypatch.setattr("moseg.workflows.training.shards.Shard.read", None)  # the files are not read again
    for each in (first, keeping.read(shard, rows)):
        for kept, of_files in zip(each, read, strict=True):
            torch.testing.assert_close(kept, of_files, rtol=0, atol=0)
    assert read.channels.dtype == torch.float32 and float(read.label.max()) <= 1
