"""Trajectories of a clip without its images, and the motion that each is labelled with."""

from dataclasses import dataclass

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.mat_tracks import decode_mat_tracks

DECODING_VERSION = 1
"""Raised when `TrajectoryFile.read` or `TrajectoryLabels.read` starts to yield other values for the same bytes."""


@dataclass(frozen=True)
class TrajectoryFile:
    """Points of all trajectories, also of those that no frame shows: they are scored like the others.

    Attributes
    ----------
    path : str
        ``<clip>_Tracks.mat`` of KT3DMoSeg; see `decode_mat_tracks`.
    """

    path: str

    def fingerprint(self) -> str:
        """Digest of the file's bytes."""
        return digest_json("source", ["trajectories", DECODING_VERSION, digest_file(self.path)])

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """`points` float64 (track, frame, xy), px, 0 where not visible, and `visible` bool (track, frame).

        Raises InputError where the file is none of labelled trajectories.
        """
        tracks = decode_mat_tracks(read_bytes(self.path), self.path)
        return tracks.points, tracks.visible


@dataclass(frozen=True)
class TrajectoryLabels:
    """Labels of all trajectories: every value that occurs is one motion."""

    path: str

    def fingerprint(self) -> str:
        """Digest of the file's bytes."""
        return digest_json("source", ["trajectory_labels", DECODING_VERSION, digest_file(self.path)])

    def read(self) -> np.ndarray:
        """uint16 (track); raises InputError where the file is none of labelled trajectories."""
        return decode_mat_tracks(read_bytes(self.path), self.path).labels.astype(np.uint16)
