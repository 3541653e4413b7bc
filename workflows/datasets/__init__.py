"""Data sets: named sequences with their frames, ground truth and cues."""

from moseg.workflows.datasets.dataset import Dataset, SequenceSource, TrajectorySource, find_ground_truth
from moseg.workflows.datasets.overview import DatasetRow, describe_dataset, describe_datasets
from moseg.workflows.datasets.registry import DATASETS, list_trajectory_datasets, open_dataset

__all__ = [
    "DATASETS",
    "Dataset",
    "DatasetRow",
    "SequenceSource",
    "TrajectorySource",
    "describe_dataset",
    "describe_datasets",
    "find_ground_truth",
    "list_trajectory_datasets",
    "open_dataset",
]
