"""Labelled trajectories from the bytes of a MATLAB file, in the two layouts in which benchmarks publish them.

KT3DMoSeg (Xu et al. 2018) has one struct ``Data``. Three of its fields are read: ``ySparse`` (3, N, F), homogeneous xy
in px; ``visibleSparse`` (N, F), without which everything is visible; and ``GtLabel`` (N), the motion of each
trajectory, counted from 1, or 0 for an outlier, which has no label. MTPV62 (Li et al. 2013) and Hopkins12 are
distributed in this layout too.

Hopkins155 (Tron and Vidal 2007) has variables instead, of which three are read: ``y`` (3, N, F), homogeneous xy in px;
``s`` (N), the labels; and ``m`` (N, F), the visibility, which only the additional sequences with missing data have.
``x`` is ``y`` multiplied by the inverse of the calibration matrix ``K``.

In KT3DMoSeg's release pixels are counted from 0 with their centres at integers, as everywhere here: visible coordinates
of 1242x375 px frames span -0.5 to 1241.2 and -0.5 to 374.4, and points start at multiples of 4. Hopkins155 counts
pixels from 1, as MATLAB does. Its points are not shifted, because there are no frames to which they would have to fit.
"""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.sources.mat_file import iterate_variables

STRUCT = "Data"
POINTS, VISIBLE, LABELS = "ySparse", "visibleSparse", "GtLabel"
HOPKINS_POINTS, HOPKINS_VISIBLE, HOPKINS_LABELS = "y", "m", "s"
MAX_COORDINATE = 1e6
"""Largest coordinate of a point of an image, px."""
MAX_LABEL = np.iinfo(np.uint16).max

_LAYOUT = "a struct Data with ySparse (3, N, F), visibleSparse (N, F) and GtLabel (N), or y (3, N, F) and s (N)"


class MatTracks(NamedTuple):
    """Trajectories of one clip.

    Attributes
    ----------
    points : float64 (N, F, 2)
        xy, px of the original frames, pixel centres at integers; 0 where not visible.
    visible : bool (N, F)
    labels : int64 (N,)
        Motion of each trajectory, 1 or more; 0 where it has no label.
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
        that are not finite, a visibility that is neither 0 nor 1, or labels that are not whole numbers of 0 to 65535 or
        are all 0.

    References
    ----------
    Xu, Cheong, Li, "Motion Segmentation by Exploiting Complementary Geometric Models", CVPR 2018.
    Tron, Vidal, "A benchmark for the comparison of 3-D motion segmentation algorithms", CVPR 2007.
    """
    names, homogeneous, seen, labels = _read_arrays(content, path)
    labels = labels.reshape(-1)
    shape = homogeneous.shape[1:]
    if homogeneous.ndim != 3 or len(homogeneous) != 3 or seen.shape != shape or labels.shape != shape[:1]:
        shapes = (homogeneous.shape, seen.shape, labels.shape)
        got = ", ".join(f"{name} {size}" for name, size in zip(names, shapes, strict=True) if name is not None)
        raise InputError("not labelled trajectories", where=path, got=got, expected=_LAYOUT)
    if not seen.size:
        raise InputError("no labelled trajectories", where=path, got=f"{names[0]} {homogeneous.shape}")
    if not np.isin(seen, (0, 1)).all():
        raise InputError("visibility that is neither 0 nor 1", where=f"{names[1]} of {path}")
    if not (np.isfinite(labels) & (labels == np.floor(labels)) & (labels >= 0) & (labels <= MAX_LABEL)).all():
        expected = f"whole numbers of 0 (no label) to {MAX_LABEL}"
        raise InputError("unusable labels", where=f"{names[2]} of {path}", got=np.unique(labels)[:8], expected=expected)
    if not labels.any():
        raise InputError("no labelled trajectories", where=f"{names[2]} of {path}", got="0 for all")
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


def _read_arrays(content: bytes, path: str) -> tuple[tuple[str, str | None, str], np.ndarray, np.ndarray, np.ndarray]:
    """Return the names of points, visibility (None where it is absent) and labels in the file, and their values."""
    names = (HOPKINS_POINTS, HOPKINS_VISIBLE, HOPKINS_LABELS)
    data: dict = {}
    for name, value in iterate_variables(content, (STRUCT, *names), path):
        if name != STRUCT:
            data.setdefault(name, value)
        elif isinstance(value, dict):
            names, data = (POINTS, VISIBLE, LABELS), value
            break
    points_name, visible_name, labels_name = names
    missing = [name for name in (points_name, labels_name) if name not in data]
    if missing:
        got = f"no {', '.join(missing)}" if data else f"no struct {STRUCT}"
        raise InputError("not labelled trajectories", where=path, got=got, expected=_LAYOUT)
    for name in names:
        if name in data and not isinstance(data[name], np.ndarray):
            raise InputError("not real numbers", where=f"{name} of {path}", expected=_LAYOUT)
    points, labels = data[points_name].astype(np.float64), data[labels_name].astype(np.float64)
    if visible_name not in data:
        return (points_name, None, labels_name), points, np.ones(points.shape[1:]), labels
    return names, points, data[visible_name].astype(np.float64), labels
