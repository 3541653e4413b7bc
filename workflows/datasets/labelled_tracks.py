"""Data sets of labelled trajectories without images: a MATLAB file for each sequence."""

import os
from dataclasses import dataclass

from moseg.workflows import sources
from moseg.workflows.datasets.dataset import TrajectorySource
from moseg.workflows.sources.files import natural_key, unreadable

TRACKS_SUFFIX = "_Tracks.mat"
"""End of the names of files with a struct ``Data``."""
TRUTH_SUFFIX = "_truth.mat"
"""End of the names of Hopkins155's files."""
STRUCT_LAYOUT = "a struct Data with ySparse (3, N, F) homogeneous xy in px, visibleSparse (N, F) and GtLabel (N)"


@dataclass(frozen=True)
class LabelledTracks:
    """A file ``<sequence><suffix>`` for each sequence, in the root or in a folder of the root.

    Attributes
    ----------
    suffix : str
        End of the files' names.
    name, official, ground_truth, tree, source
        As `DatasetLayout`.
    """

    name: str
    official: tuple[str, ...]
    suffix: str
    tree: str
    source: str
    ground_truth: str = "the motion of every trajectory, the background's among them"
    needs_root: bool = True
    list_name: None = None

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Return the sequences with trajectories."""
        return tuple(sorted(self._find_files(root), key=natural_key))

    def open_trajectories(self, root: str, name: str) -> TrajectorySource:
        """Return the sources of one sequence."""
        path = self._find_files(root)[name]
        return TrajectorySource(name, sources.TrajectoryFile(path), sources.TrajectoryLabels(path))

    def _find_files(self, root: str) -> dict[str, str]:
        """Return the path of each sequence's file by the name of the sequence; those in the root come first."""
        found = {}
        for folder in (root, *_list_folders(root)):
            for name in _list_names(folder):
                if name.endswith(self.suffix) and not name.startswith("."):
                    found.setdefault(name.removesuffix(self.suffix), os.path.join(folder, name))
        return found


def _list_folders(root: str) -> list[str]:
    paths = (os.path.join(root, name) for name in _list_names(root) if not name.startswith("."))
    return [path for path in paths if os.path.isdir(path)]


def _list_names(folder: str) -> list[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError as error:
        raise unreadable(folder, error) from error
