"""Areas of objects in every frame; a correction has those frames counted again that it changes."""

from threading import Lock

import numpy as np

from moseg.workflows.pipelines.live_labels import LiveLabels
from moseg.workflows.stages.inputs import ArtifactView
from moseg.workflows.view.shown_result import ShownResult


class ObjectAreas:
    """Counts of pixels of one video, kept from one state of its result to the next."""

    def __init__(self):
        self._lock = Lock()
        self._live: LiveLabels | None = None
        self._rows: list[np.ndarray] = []
        self._proposed: dict[str, list[np.ndarray]] = {}

    def of_labels(self, shown: ShownResult) -> dict[int, np.ndarray]:
        """Return the area of each identity of the labels in every frame, int64 (frame,), px as analysed."""
        with self._lock:
            changed = shown.live.changed_frames(self._live)
            rows = [*self._rows, *[np.zeros(0, np.int64)] * (shown.num_frames - len(self._rows))]
            for frame in changed:
                section, row = shown.graph.place(frame)
                rows[frame] = shown.live.areas(frame, self._count_masks(shown, section)[row])
            self._live, self._rows = shown.live, rows
        return _by_identity(rows)

    def of_proposals(self, shown: ShownResult) -> dict[int, np.ndarray]:
        """Return the same of all objects before any correction, moving or static."""
        rows = []
        for section, (start, stop, _) in enumerate(shown.graph.sections):
            names = shown.identity_of_masks(section)
            with self._lock:
                counted = self._count_masks(shown, section)
            for counts in counted[: stop - start]:
                rows.append(np.bincount(names[: len(counts)], weights=counts).astype(np.int64))
        return _by_identity(rows)

    def _count_masks(self, shown: ShownResult, section: int) -> list[np.ndarray]:
        """Return the number of pixels of each object in each frame of a section's proposals; the lock is held."""
        ref = shown.graph.objects.proposals(section)
        if ref not in self._proposed:
            masks = ArtifactView(shown.store, ref).cached("masks")
            self._proposed[ref] = [np.bincount(frame.ravel()) for frame in masks]
        return self._proposed[ref]


def _by_identity(rows: list[np.ndarray]) -> dict[int, np.ndarray]:
    """Return columns of rows of different lengths, by their number, without number 0 and without empty ones."""
    table = np.zeros((len(rows), max(map(len, rows), default=0)), np.int64)
    for row, counts in zip(table, rows, strict=True):
        row[: len(counts)] = counts
    return {int(identity): table[:, identity] for identity in np.flatnonzero(table.any(axis=0)) if identity}
