"""Labelled trajectories from the bytes of a MATLAB file, as KT3DMoSeg (Xu et al. 2018) publishes them.

A file ``<clip>_Tracks.mat`` holds one struct ``Data``. Three of its fields are read: ``ySparse`` (3, N, F), homogeneous
xy in px; ``visibleSparse`` (N, F); and ``GtLabel`` (N), the motion of each trajectory, counted from 1. In the release
pixels are counted from 0 with their centres at integers, as everywhere here: visible coordinates of 1242x375 px frames
span -0.5 to 1241.2 and -0.5 to 374.4, and points start at multiples of 4.
"""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.sources.mat_file import read_struct

STRUCT = "Data"
FIELDS = ("ySparse", "visibleSparse", "GtLabel")
MAX_COORDINATE = 1e6
"""Largest coordinate of a point of an image, px."""
MAX_LABEL = np.iinfo(np.uint16).max

_LAYOUT = "a struct Data with ySparse (3, N, F), visibleSparse (N, F) and GtLabel (N)"


class MatTracks(NamedTuple):
    """Trajectories of one clip.

    Attributes
    ----------
    points : float64 (N, F, 2)
        xy, px of the original frames, pixel centres at integers; 0 where not visible.
    visible : bool (N, F)
    labels : int64 (N,)
        Motion of each trajectory, 1 or more.
    """

    points: np.ndarray
    visible: np.ndarray
    labels: np.ndarray


def decode_mat_tracks(content: bytes, path: str) -> MatTracks:
    """Return the labelled trajectories of one file.

    Parameters
    ----------
    content : bytes
        Of the whole file.
    path : str
        The file, for errors.

    Raises
    ------
    InputError
        Not a MATLAB file of version 5 to 7.2 or a damaged one, other variables or shapes, no trajectory, visible points
        that are not finite, a visibility that is neither 0 nor 1, or labels that are not whole numbers of 1 to 65535.

    References
    ----------
    Xu, Cheong, Li, "Motion Segmentation by Exploiting Complementary Geometric Models", CVPR 2018.
    """
    homogeneous, seen, labels = _fields(content, path).values()
    labels = labels.reshape(-1)
    shape = homogeneous.shape[1:]
    if homogeneous.ndim != 3 or len(homogeneous) != 3 or seen.shape != shape or labels.shape != shape[:1]:
        got = f"ySparse {homogeneous.shape}, visibleSparse {seen.shape}, GtLabel {labels.shape}"
        raise InputError("not labelled trajectories", where=path, got=got, expected=_LAYOUT)
    if not seen.size:
        raise InputError("no labelled trajectories", where=path, got=f"ySparse {homogeneous.shape}")
    if not np.isin(seen, (0, 1)).all():
        raise InputError("visibility that is neither 0 nor 1", where=f"visibleSparse of {path}")
    if not (np.isfinite(labels) & (labels == np.floor(labels)) & (labels >= 1) & (labels <= MAX_LABEL)).all():
        expected = f"whole numbers of 1 to {MAX_LABEL}"
        raise InputError("unusable labels", where=f"GtLabel of {path}", got=np.unique(labels)[:8], expected=expected)
    visible = seen.astype(bool)
    points = np.zeros((*shape, 2))
    with np.errstate(all="ignore"):
        points[visible] = (homogeneous[:2, visible] / homogeneous[2, visible]).T
    if num_bad := int(np.count_nonzero(~np.isfinite(points).all(axis=-1))):
        got = f"{num_bad} visible points with NaN, infinity or a third coordinate of 0"
        raise InputError("trajectories are not finite", where=path, got=got)
    if (farthest := np.abs(points).max(initial=0)) > MAX_COORDINATE:
        raise InputError("points far outside any image", where=path, got=f"{farthest:.3g} px", expected="px")
    return MatTracks(points, visible, labels.astype(np.int64))


def _fields(content: bytes, path: str) -> dict[str, np.ndarray]:
    """Return the struct's fields that are read, float64, by name."""
    data = read_struct(content, STRUCT, path)
    missing = FIELDS if data is None else [name for name in FIELDS if name not in data]
    if missing:
        got = f"no struct {STRUCT}" if data is None else f"no {', '.join(missing)}"
        raise InputError("not labelled trajectories", where=path, got=got, expected=_LAYOUT)
    for name in FIELDS:
        if data[name] is None:
            raise InputError("not real numbers", where=f"{name} of {path}", expected=_LAYOUT)
    return {name: data[name].astype(np.float64) for name in FIELDS}
