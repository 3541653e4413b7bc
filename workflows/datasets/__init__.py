"""Data sets: named sequences with their frames, ground truth and cues."""

from workflows.datasets.dataset import Dataset, SequenceSource
from workflows.datasets.overview import DatasetRow, describe_datasets
from workflows.datasets.registry import DATASETS, open_dataset

__all__ = ["DATASETS", "Dataset", "DatasetRow", "SequenceSource", "describe_datasets", "open_dataset"]
