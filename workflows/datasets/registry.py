"""The data sets by name."""

import os

from moseg.schemas.spelling import unknown_name
from moseg.workflows.datasets.dataset import Dataset, DatasetLayout, TrajectoryLayout
from moseg.workflows.datasets.folder import FOLDER
from moseg.workflows.datasets.hopkins import HOPKINS12, HOPKINS155, MTPV62
from moseg.workflows.datasets.kt3dmoseg import KT3DINSMOSEG, KT3DMOSEG
from moseg.workflows.datasets.selection import find_root, select_sequences
from moseg.workflows.datasets.still import STILL
from moseg.workflows.datasets.synthetic import SYNTHETIC
from moseg.workflows.datasets.two_trees import DAVIS16, DAVIS_MOVING, YTVOS_MOVING

_TRACKS = (KT3DMOSEG, HOPKINS155, HOPKINS12, MTPV62)
DATASETS: dict[str, DatasetLayout] = {
    layout.name: layout
    for layout in (SYNTHETIC, DAVIS_MOVING, DAVIS16, YTVOS_MOVING, KT3DINSMOSEG, *_TRACKS, STILL, FOLDER)
}


def list_trajectory_datasets() -> tuple[str, ...]:
    """Return the names of the data sets of labelled trajectories without images."""
    return tuple(name for name, layout in DATASETS.items() if isinstance(layout, TrajectoryLayout))


def open_dataset(
    name: str,
    root: str | None = None,
    sequences: tuple[str, ...] | None = None,
    list_file: str | None = None,
    *,
    max_side: int,
) -> Dataset:
    """Choose sequences of a data set.

    Parameters
    ----------
    name : str
        One of `DATASETS`.
    root : str, optional
        Folder of the data set; ``$MOSEG_DATA/<name>`` by default, which need not exist if the root is optional.
    sequences : tuple of str, optional
        Names to choose; by default those of the official list, or all that are on disk.
    list_file : str, optional
        File of sequence names, one per line, that replaces the official list.
    max_side : int
        Frames whose longer side exceeds it are area-resized to it, px.

    Raises
    ------
    InputError
        An unknown data set or sequence.
    MissingInputError
        The data set, its list, or every sequence chosen is absent.
    """
    if name not in DATASETS:
        raise unknown_name("data set", name, DATASETS)
    layout = DATASETS[name]
    found = find_root(layout, root, os.environ)
    names, absent = select_sequences(layout, found, sequences, list_file)
    return Dataset(layout, found, names, absent, max_side)
