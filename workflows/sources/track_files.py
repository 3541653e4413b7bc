"""Point tracks of a whole sequence from a file."""

from dataclasses import dataclass

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.numpy_file import decode_arrays
from moseg.workflows.sources.resize import working_size

TRACK_SUFFIXES = (".npz",)
DECODING_VERSION = 2
"""Raised when `TrackFile.read` starts to yield other values for the same bytes, or to refuse them."""

_MIN_INSIDE = 0.5  # share of the visible points; fewer come from frames of another size
_MIN_SIDE = 8  # px; in a smaller frame all points may lie in the corner pixel, else they are shares of its sides
_LAYOUT = "points float (N, F, 2) and visible bool (N, F)"


@dataclass(frozen=True)
class TrackFile:
    """Tracks of points through all frames of a sequence.

    Attributes
    ----------
    path : str
        ``.npz`` with ``points`` float (N, F, 2), xy in px of the original frames, pixel centres at integers, and
        ``visible`` bool (N, F).
    num_frames : int
        F: frames of the sequence.
    size : (int, int)
        Original (height, width) of the frames, px.
    max_side : int
        As the frames': points are scaled with them.
    """

    path: str
    num_frames: int
    size: tuple[int, int]
    max_side: int

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes and the decode parameters."""
        params = [self.num_frames, self.size, self.max_side]
        return digest_json("source", ["tracks", DECODING_VERSION, *params, digest_file(self.path)])

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Return points and their visibility, at the frames' working size.

        A point outside its frame is not visible, whatever the file says: trackers follow points over the border.

        Returns
        -------
        points : float32 (track, frame, xy)
            px; 0 where not visible.
        visible : bool (track, frame)

        Raises
        ------
        InputError
            Not such a file, another number of frames, no visible point or one that is not finite, coordinates that are
            shares of the frame's sides, or most visible points outside the frame, as for frames of another size.
        """
        points, visible = decode_tracks(read_bytes(self.path), self.path)
        if points.shape[1] != self.num_frames:
            got = f"{points.shape[1]} frames"
            raise InputError("tracks of another sequence", where=self.path, got=got, expected=f"{self.num_frames}")
        if not visible.any():
            raise InputError("no visible point", where=self.path, got=f"{len(visible)} tracks")
        height, width = self.size
        expected = f"xy in px of the original frames, {width}x{height} px"
        if (farthest := np.abs(points[visible]).max()) <= 1 and min(self.size) >= _MIN_SIDE:
            got = f"visible points no farther than {farthest:.3g} from 0"
            raise InputError("coordinates that are not in px", where=self.path, got=got, expected=expected)
        inside = visible & ((points >= -0.5) & (points < (width - 0.5, height - 0.5))).all(axis=-1)
        if np.count_nonzero(inside) < _MIN_INSIDE * np.count_nonzero(visible):
            raise InputError(
                "most points outside the frame",
                where=self.path,
                got=f"{np.count_nonzero(inside)} of {np.count_nonzero(visible)} visible points inside",
                expected=expected,
            )
        reduced = working_size(self.size, self.max_side)
        scaled = (points + 0.5) * (reduced[1] / width, reduced[0] / height) - 0.5
        return np.where(inside[..., None], scaled, 0).astype(np.float32), inside


def decode_tracks(content: bytes, path: str) -> tuple[np.ndarray, np.ndarray]:
    """Return points float64 (N, F, 2), 0 if not visible, and visible bool (N, F); raise InputError for other arrays."""
    points, visible = decode_arrays(content, ("points", "visible"), path, "tracks")
    is_pair = points.ndim == 3 and points.shape[2:] == (2,) and visible.shape == points.shape[:2]
    if not is_pair or points.dtype.kind != "f" or visible.dtype != bool:
        got = f"{points.dtype} of shape {points.shape} and {visible.dtype} of shape {visible.shape}"
        raise InputError("not tracks", where=path, got=got, expected=_LAYOUT)
    if num_bad := int(np.count_nonzero(visible & ~np.isfinite(points).all(axis=-1))):
        raise InputError("tracks are not finite", where=path, got=f"{num_bad} visible points with NaN or infinity")
    # Values beyond float64 become infinite here, and so lie outside every frame.
    with np.errstate(over="ignore"):
        return np.where(visible[..., None], points, 0).astype(np.float64), visible
