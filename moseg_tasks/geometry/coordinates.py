"""Image coordinates: the conventions of this project, and the change to normalised coordinates.

Points are (x, y) in pixels, pixel centres lie at integers: the centre of the top-left pixel is (0, 0) and that of an
image of shape (height, width) is ((width - 1) / 2, (height - 1) / 2). Arrays are indexed [y, x]. The two images of a
pair end in 0 and 1; a fundamental matrix obeys x1' F x0 = 0 and a homography x1 ~ H x0.

Normalised coordinates are relative to the image's centre and divided by half the longer side, so they lie in -1..1.
"""

import numpy as np


def normalise_points(points: np.ndarray, image_shape: tuple[int, int]) -> np.ndarray:
    """Convert pixel coordinates to normalised coordinates.

    Parameters
    ----------
    points : float (..., 2)
        xy, px.
    image_shape : (int, int)
        Height and width, px.

    Returns
    -------
    points : float64 (..., 2)
    """
    height, width = image_shape
    centre = np.array([(width - 1) / 2, (height - 1) / 2])
    return (np.asarray(points, dtype=np.float64) - centre) / pixel_scale(image_shape)


def pixel_scale(image_shape: tuple[int, int]) -> float:
    """Return the pixels per unit of normalised coordinates: half the longer side."""
    return max(image_shape) / 2


def normalising_transform(image_shape: tuple[int, int]) -> np.ndarray:
    """Return the 3 x 3 matrix T with normalised = T pixel, in homogeneous coordinates."""
    height, width = image_shape
    scale = 1 / pixel_scale(image_shape)
    return np.array([[scale, 0, -(width - 1) / 2 * scale], [0, scale, -(height - 1) / 2 * scale], [0, 0, 1]])


def hartley_transform(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normalise each point set after Hartley: centroid at 0, root mean square radius sqrt(2).

    Parameters
    ----------
    points : float64 (..., N, 2)

    Returns
    -------
    normalised : float64 (..., N, 2)
    transform : float64 (..., 3, 3)
        normalised = transform points, homogeneous. The scale of coincident points is 1.

    References
    ----------
    R. Hartley, In defense of the eight-point algorithm, PAMI 1997.
    """
    centroid = points.mean(axis=-2, keepdims=True)
    centred = points - centroid
    # `np.sum` over an axis of two takes ten times as long.
    x, y = centred[..., 0], centred[..., 1]
    radius = np.sqrt(np.mean(x * x + y * y, axis=-1))
    scale = np.sqrt(2) / np.where(radius > 0, radius, np.sqrt(2))
    transform = np.zeros((*points.shape[:-2], 3, 3))
    transform[..., 0, 0] = transform[..., 1, 1] = scale
    transform[..., :2, 2] = -scale[..., None] * centroid[..., 0, :]
    transform[..., 2, 2] = 1
    return centred * scale[..., None, None], transform


def homogeneous(points: np.ndarray) -> np.ndarray:
    """Append a third coordinate 1 to points (..., 2)."""
    return np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1)
