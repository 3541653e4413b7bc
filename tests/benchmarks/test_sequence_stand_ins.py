"""Stand-ins for sequences of Hopkins155 that are not on disk."""

import importlib
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from moseg.workflows.datasets import open_dataset

TRAJECTORIES = Path(__file__).resolve().parents[2] / "benchmarks" / "trajectories"
LABELS = {"arm": [1] * 12 + [2] * 8, "cars1": [1] * 6 + [2] * 14}
NUM_SEQUENCES = 156


@pytest.fixture
def stand_ins(monkeypatch):
    """Return the module."""
    monkeypatch.syspath_prepend(str(TRAJECTORIES))
    return importlib.import_module("sequence_stand_ins")


@pytest.fixture
def root(tmp_path):
    """Return a folder with two of the sequences, of 20 trajectories each."""
    rng = np.random.default_rng(0)
    for name, labels in LABELS.items():
        y = np.ones((3, len(labels), 7))
        y[:2] = rng.uniform(0, 100, (2, len(labels), 7))
        savemat(tmp_path / f"{name}_truth.mat", {"y": y, "s": np.array(labels, np.uint8)[:, None]})
    return tmp_path


def _read(root):
    dataset = open_dataset("hopkins155", str(root), max_side=None)
    sources = [dataset.trajectories(name) for name in dataset.names]
    return {source.name: (source.trajectories.read()[0], source.labels.read()) for source in sources}


def test_all_sequences_are_there_with_the_wanted_number_of_trajectories(stand_ins, root):
    stand_ins.write_stand_ins("hopkins155", str(root), root, 40 + 154 * 10)
    clips = _read(root)
    assert len(clips) == NUM_SEQUENCES
    assert sum(len(labels) for _, labels in clips.values()) == 40 + 154 * 10


def test_a_stand_in_has_the_same_share_of_each_motion(stand_ins, root):
    stand_ins.write_stand_ins("hopkins155", str(root), root, 40 + 154 * 10)
    for name, (_, labels) in _read(root).items():
        if name not in LABELS:
            shares = Counter(int(label) for label in labels)
            assert dict(shares) in ({1: 6, 2: 4}, {1: 3, 2: 7})


def test_no_stand_in_has_the_points_of_another_sequence(stand_ins, root):
    stand_ins.write_stand_ins("hopkins155", str(root), root, 40 + 154 * 10)
    assert len({points.tobytes() for points, _ in _read(root).values()}) == NUM_SEQUENCES


@pytest.mark.parametrize("number", [40, 40 + 154 * 20 + 1])
def test_a_number_that_stand_ins_cannot_have_is_refused(stand_ins, root, number):
    with pytest.raises(SystemExit, match=f"{number} trajectories in all; expected more than 40 and at most 3120"):
        stand_ins.write_stand_ins("hopkins155", str(root), root, number)
    assert len(list(root.iterdir())) == 2
