"""Trifocal tensors from points: the linear equations, and a fit that is a tensor of three cameras."""

import numpy as np

from moseg.tasks.geometry.coordinates import hartley_transform, homogeneous
from moseg.tasks.geometry.null_vector import iterated_null_vector

SAMPLE_SIZE = 7
_ALL_ENTRIES = tuple(np.indices((3, 3)).reshape(2, 9))
_LAST_ROW_AND_COLUMN = (np.array([0, 1, 2, 2, 2]), np.array([2, 2, 0, 1, 2]))


def trifocal_tensor(points: np.ndarray) -> np.ndarray:
    """Return the trifocal tensors of seven or more point triples each.

    The tensor of minimal algebraic error gives the epipoles e' and e'' of the first camera in the other two frames; the
    tensor of minimal algebraic error with these epipoles, T_i = a_i e''^T - e' b_i^T, is the result. In coordinates in
    which both epipoles are the third axis, it only has entries in its last row and column: fifteen unknowns.

    Parameters
    ----------
    points : float64 (..., N, 3, 2)
        N >= 7 points in three frames.

    Returns
    -------
    T : float64 (..., 3, 3, 3)
        sum_i x0^i l1' T[i] l2 = 0 for all lines l1 through x1 and l2 through x2; unit norm. Arbitrary but finite if
        the points do not determine it.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, algorithms 16.1 and 16.2.
    """
    (normalised0, T0), (normalised1, T1), (normalised2, T2) = (
        hartley_transform(points[..., frame, :]) for frame in range(3)
    )
    x0, lines1, lines2 = homogeneous(normalised0), _axis_lines(normalised1), _axis_lines(normalised2)
    tensor = iterated_null_vector(_equations(x0, lines1, lines2, _ALL_ENTRIES)).reshape(*points.shape[:-3], 3, 3, 3)
    tensor = _with_epipoles(x0, lines1, lines2, *epipoles(tensor))
    return transform_tensor(tensor, T0, np.linalg.inv(T1), np.linalg.inv(T2))


def transform_tensor(T: np.ndarray, to_old0: np.ndarray, to_new1: np.ndarray, to_new2: np.ndarray) -> np.ndarray:
    """Transform tensors (..., 3, 3, 3) to other coordinates in each frame and to unit norm.

    `to_old0` (..., 3, 3) maps new points of the first frame to old ones, the others map old points to new ones.
    """
    T = to_new1[..., None, :, :] @ T @ _transposed(to_new2)[..., None, :, :]
    T = (_transposed(to_old0) @ T.reshape(*T.shape[:-3], 3, 9)).reshape(T.shape)
    return T / np.sqrt(np.sum(T**2, axis=(-3, -2, -1), keepdims=True))


def trilinear_equations(points: np.ndarray) -> np.ndarray:
    """Return the rows l1' (sum_i x0^i T[i]) l2 = 0, float64 (..., 4 N, 27), for axis-parallel lines of each point."""
    x0 = homogeneous(points[..., 0, :])
    return _equations(x0, _axis_lines(points[..., 1, :]), _axis_lines(points[..., 2, :]), _ALL_ENTRIES)


def epipoles(T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return unit images e', e'' (..., 3) of the first camera's centre in the second and third frame.

    The left null vectors of the three slices of a tensor are orthogonal to e', the right null vectors to e''.
    """
    U, _, Vh = np.linalg.svd(T)
    return np.linalg.svd(_transposed(U[..., 2])).U[..., 2], np.linalg.svd(Vh[..., 2, :]).Vh[..., 2, :]


def _with_epipoles(
    x0: np.ndarray, lines1: np.ndarray, lines2: np.ndarray, epipole1: np.ndarray, epipole2: np.ndarray
) -> np.ndarray:
    """Return the tensor (..., 3, 3, 3) of smallest algebraic error among those with these epipoles."""
    basis1, basis2 = _basis_ending_in(epipole1), _basis_ending_in(epipole2)
    rotated1, rotated2 = lines1 @ basis1[..., None, :, :], lines2 @ basis2[..., None, :, :]
    entries = iterated_null_vector(_equations(x0, rotated1, rotated2, _LAST_ROW_AND_COLUMN))
    tensor = np.zeros((*entries.shape[:-1], 3, 3, 3))
    tensor[..., _LAST_ROW_AND_COLUMN[0], _LAST_ROW_AND_COLUMN[1]] = entries.reshape(*entries.shape[:-1], 3, 5)
    return basis1[..., None, :, :] @ tensor @ _transposed(basis2)[..., None, :, :]


def _equations(x0: np.ndarray, lines1: np.ndarray, lines2: np.ndarray, entries: tuple) -> np.ndarray:
    """Return the coefficients (..., 4 N, 3 E) of the entries T[i][row, column] in l1' (sum_i x0^i T[i]) l2.

    x0 (..., N, 3), two lines (..., N, 2, 3) through the point in each of the other frames, E rows and columns.
    """
    rows, columns = entries
    products = lines1[..., :, None, rows] * lines2[..., None, :, columns]
    products = products.reshape(*x0.shape[:-1], 4, 1, len(rows)) * x0[..., None, :, None]
    return products.reshape(*x0.shape[:-2], 4 * x0.shape[-2], 3 * len(rows))


def _basis_ending_in(direction: np.ndarray) -> np.ndarray:
    """Return orthogonal matrices (..., 3, 3) whose last column is a unit vector (..., 3): Householder reflections."""
    normal = direction.copy()
    sign = np.where(direction[..., 2] < 0, -1.0, 1.0)
    normal[..., 2] += sign
    length = np.sum(normal**2, axis=-1)[..., None, None]
    reflection = np.eye(3) - 2 * normal[..., :, None] * normal[..., None, :] / length
    return reflection * -sign[..., None, None]


def _axis_lines(points: np.ndarray) -> np.ndarray:
    """Return the lines (..., N, 2, 3) through each point along the axes: (1, 0, -x) and (0, 1, -y)."""
    lines = np.zeros((*points.shape, 3))
    lines[..., 0, 0] = lines[..., 1, 1] = 1
    lines[..., 2] = -points
    return lines


def _transposed(matrices: np.ndarray) -> np.ndarray:
    return np.swapaxes(matrices, -1, -2)
