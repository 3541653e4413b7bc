"""Labelled trajectories of a clip, without images or as ground truth at points of the images."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.mat_tracks import decode_mat_tracks

BACKGROUND_LABEL = 1
"""The label of KT3DMoSeg that does not move on its own.

The release does not say so; its data do. In each of eleven clips the points of label 1, and of no other, spread over
the frame (their hull covers 63 to 97 % of it, that of any other label at most 36 %), and the epipole of the fundamental
matrices fitted to them lies within 60 px of KITTI's principal point, as for static points and a camera that drives
ahead. It is not always the largest group: in Seq095_Clip01 a single moving object has 716 of 1018 trajectories.
"""
DECODING_VERSION = 1
"""Raised when a `read` of this file starts to yield other values for the same bytes."""

_MIN_INSIDE = 0.5  # share of the visible points; fewer come from frames of another size


@dataclass(frozen=True)
class TrajectoryFile:
    """Points of all trajectories, also of those that are visible in no frame: they are scored like the others.

    Attributes
    ----------
    path : str
        ``<clip>_Tracks.mat`` of KT3DMoSeg, or ``<sequence>_truth.mat`` of Hopkins155; see `decode_mat_tracks`.
    """

    path: str

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes."""
        return digest_json("source", ["trajectories", DECODING_VERSION, digest_file(self.path)])

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Return `points` float64 (track, frame, xy), px, 0 where not visible, and `visible` bool (track, frame).

        Raises InputError if the file does not hold labelled trajectories.
        """
        tracks = decode_mat_tracks(read_bytes(self.path), self.path)
        return tracks.points, tracks.visible


@dataclass(frozen=True)
class TrajectoryLabels:
    """Labels of all trajectories: every value that occurs is one motion, except 0, which is no label."""

    path: str

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes."""
        return digest_json("source", ["trajectory_labels", DECODING_VERSION, digest_file(self.path)])

    def read(self) -> np.ndarray:
        """Return uint16 (track); raise InputError if the file does not hold labelled trajectories."""
        return decode_mat_tracks(read_bytes(self.path), self.path).labels.astype(np.uint16)


class LabelledPoints(NamedTuple):
    """Points of N trajectories in F frames, and which of them move.

    Attributes
    ----------
    points : float64 (N, F, 2)
        xy, px of frames of `size`, pixel centres at integers; 0 where not visible.
    visible : bool (N, F)
        Visible, labelled, and inside the frame.
    labels : uint16 (N,)
        0 = static, else the file's label of what moves on its own.
    size : (int, int)
        Original height and width of the frames, px.
    """

    points: np.ndarray
    visible: np.ndarray
    labels: np.ndarray
    size: tuple[int, int]


@dataclass(frozen=True)
class LabelledPointFile:
    """Labelled trajectories through all frames of a clip.

    Attributes
    ----------
    path : str
        ``<clip>_Tracks.mat`` of KT3DMoSeg; see `decode_mat_tracks`.
    num_frames : int
        F: frames of the clip. Frame m of the file is the clip's m-th image, whatever the image's number.
    size : (int, int)
        Original (height, width) of the frames, px: scores are computed at this size, as for masks.
    """

    path: str
    num_frames: int
    size: tuple[int, int]

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes and the decode parameters."""
        params = [self.num_frames, self.size]
        return digest_json("source", ["labelled_points", DECODING_VERSION, *params, digest_file(self.path)])

    def read(self) -> LabelledPoints:
        """Return the points at the original size.

        A point outside its frame is not visible, whatever the file says.

        Raises
        ------
        InputError
            Not such a file, another number of frames than the clip has images, or most visible points outside the
            frame, as for frames of another size.
        """
        points, visible, labels = decode_mat_tracks(read_bytes(self.path), self.path)
        if points.shape[1] != self.num_frames:
            got, expected = f"{points.shape[1]} frames", f"{self.num_frames}, as many as the clip has images"
            raise InputError("trajectories of other frames", where=self.path, got=got, expected=expected)
        height, width = self.size
        visible = visible & (labels > 0)[:, None]
        inside = visible & ((points >= -0.5) & (points < (width - 0.5, height - 0.5))).all(axis=-1)
        if np.count_nonzero(inside) <= _MIN_INSIDE * np.count_nonzero(visible):
            raise InputError(
                "most points outside the frame",
                where=self.path,
                got=f"{np.count_nonzero(inside)} of {np.count_nonzero(visible)} visible points inside",
                expected=f"xy in px of the clip's images, {width}x{height} px",
            )
        moving = np.where(labels == BACKGROUND_LABEL, 0, labels).astype(np.uint16)
        return LabelledPoints(np.where(inside[..., None], points, 0), inside, moving, self.size)
