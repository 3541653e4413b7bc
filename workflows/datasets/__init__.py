"""Data sets: named sequences with their frames, ground truth and cues."""

from workflows.datasets.dataset import Dataset, SequenceSource, TrajectorySource
from workflows.datasets.ground_truth import find_ground_truth
from workflows.datasets.overview import DatasetRow, describe_dataset, describe_datasets
from workflows.datasets.registry import DATASETS, open_dataset

__all__ = [
    "DATASETS",
    "Dataset",
    "DatasetRow",
    "SequenceSource",
    "TrajectorySource",
    "describe_dataset",
    "describe_datasets",
    "find_ground_truth",
    "open_dataset",
]
