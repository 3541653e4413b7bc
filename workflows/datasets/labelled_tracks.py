"""Data sets of labelled trajectories without images: a MATLAB file for each sequence."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from moseg.schemas.errors import MissingInputError
from moseg.schemas.sequence_groups import SequenceGroup
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import TrajectorySource
from moseg.workflows.sources.files import natural_key, unreadable

TRACKS_SUFFIX = "_Tracks.mat"
"""End of the names of files with a struct ``Data``, as KT3DMoSeg's."""
TRUTH_SUFFIX = "_truth.mat"
"""End of the names of files with variables ``y`` and ``s``, as Hopkins155's."""
STRUCT_LAYOUT = "a struct Data with ySparse (3, N, F) homogeneous xy in px, visibleSparse (N, F) and GtLabel (N)"
VARIABLES_LAYOUT = "y (3, N, F) homogeneous xy in px and s (N)"


class NamedGroup(NamedTuple):
    """A group of sequences over which papers report their figures."""

    name: str
    sequences: tuple[str, ...]


@dataclass(frozen=True)
class LabelledTracks:
    """A file ``<sequence><suffix>`` for each sequence, in the root or in a folder of the sequence's or the file's name.

    Attributes
    ----------
    name, tree, source, ground_truth : str
    official : tuple of str, or None
        As `DatasetLayout`.
    suffixes : tuple of str
        Ends of the files' names.
    groups : tuple of NamedGroup
        Groups that papers report, in the order of the tables; a sequence may be in several.
    """

    name: str
    official: tuple[str, ...] | None
    suffixes: tuple[str, ...]
    tree: str
    source: str
    groups: tuple[NamedGroup, ...] = ()
    ground_truth: str = "the motion of every trajectory, the background's among them"
    needs_root: bool = True
    list_name: None = None

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Return the sequences with trajectories."""
        try:
            entries = os.listdir(root)
        except OSError as error:
            raise unreadable(root, error) from error
        names = {name for entry in entries if not entry.startswith(".") for name in self._names_of(entry)}
        return tuple(sorted((name for name in names if self._find_file(root, name)), key=natural_key))

    def open_trajectories(self, root: str, name: str) -> TrajectorySource:
        """Return the sources of one sequence."""
        path = self._find_file(root, name)
        if path is None:
            raise MissingInputError(f"sequence {name} has no trajectories", where=root, expected=self.tree)
        groups = tuple(
            SequenceGroup(group.name, place, len(group.sequences))
            for place, group in enumerate(self.groups)
            if name in group.sequences
        )
        return TrajectorySource(name, sources.TrajectoryFile(path), sources.TrajectoryLabels(path), groups)

    def _names_of(self, entry: str) -> Iterator[str]:
        """Yield the names of the sequences that an entry of the root may belong to, as a file or as a folder."""
        yield entry
        for suffix in self.suffixes:
            yield from (entry.removesuffix(end) for end in (suffix, os.path.splitext(suffix)[0]) if entry.endswith(end))

    def _find_file(self, root: str, name: str) -> str | None:
        """Return the path of a sequence's file, the one in the root first; None if there is none."""
        for suffix in self.suffixes if name else ():
            file = name + suffix
            for folder in ("", name, os.path.splitext(file)[0]):
                if os.path.isfile(path := os.path.join(root, folder, file)):
                    return path
        return None
