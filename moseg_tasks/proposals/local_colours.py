"""Colours of objects against those of the background beside them, in one frame."""

from typing import NamedTuple

import numpy as np
from scipy import sparse, spatial

from moseg.schemas.parameters import AppearanceParams, LocalColourParams
from moseg.tasks.appearance.histograms import colour_bins

_SHARPNESS = 2  # power of a pixel's certainty in its weight
_REACH = 3  # colours are unlike beyond so many sigmas
_TINY = np.finfo(np.float32).tiny


def local_colour_ratio(
    image: np.ndarray,
    foreground: np.ndarray,
    is_object: np.ndarray,
    params: LocalColourParams,
    origin: tuple[int, int] = (0, 0),
) -> np.ndarray:
    """Return how much more frequent each pixel's colour is in the objects around it than in the background around it.

    Objects and background of a video may share a colour that still tells them apart at one place of one frame.

    Parameters
    ----------
    image : uint8 (y, x, 3)
        RGB.
    foreground : float32 (y, x)
        Probability to move, 0..1. Pixels of objects above a half count among the colours of objects, and all pixels
        below a half among those of the background, with the weight (2 p - 1)^2.
    is_object : bool (y, x)
    params : LocalColourParams
    origin : (y, x)
        Place of the image in the frame's grid, px. Colours are counted in cells of that grid, so that an object does
        not depend on how much around another one is looked at.

    Returns
    -------
    float32 (y, x)
        log(share in objects / share in the background), each in a Gaussian window around the pixel, limited to
        +-`clip`. It shrinks where the window has little of one side.
    """
    cells = _Cells.over(foreground.shape, origin, max(round(params.radius), 1))
    colours, colour_of = np.unique(colour_bins(image, _bins(params)), return_inverse=True)
    colour_of = colour_of.reshape(foreground.shape)
    alike = _alike(colours, params)
    windows = [_gaussian(number, params.radius / cells.side) for number in cells.shape]
    certainty = 2 * foreground - 1
    shares, weights = [], []
    for weight in (np.where(is_object, certainty, 0), -certainty):
        counts = cells.count(np.maximum(weight, 0) ** _SHARPNESS, colour_of, len(colours))
        total = _in_windows(counts.sum(axis=1).reshape(*cells.shape, 1), windows)
        similar = _in_windows((counts @ alike).toarray().reshape(*cells.shape, -1), windows)
        shares.append(similar / np.maximum(total, _TINY) + np.float32(params.floor))
        weights.append(total)
    fewer = np.minimum(*weights)
    trust = fewer / np.maximum(fewer + np.float32(params.doubt), _TINY)
    ratio = trust * np.log(shares[0] / shares[1]).clip(-params.clip, params.clip)
    return cells.interpolate(ratio, colour_of)


class _Cells(NamedTuple):
    """Square cells over an image and a cell around it, in which colours are counted.

    Attributes
    ----------
    shape : (rows, columns)
    side : int
        px.
    start : (y, x)
        Place of the image's first pixel from the corner of the first cell, px.
    """

    shape: tuple[int, int]
    side: int
    start: tuple[int, int]

    @classmethod
    def over(cls, image_shape: tuple[int, int], origin: tuple[int, int], side: int) -> "_Cells":
        start = side + origin[0] % side, side + origin[1] % side
        rows, columns = (-(-(first + number) // side) + 1 for first, number in zip(start, image_shape, strict=True))
        return cls((rows, columns), side, start)

    def count(self, weight: np.ndarray, colour_of: np.ndarray, num_colours: int) -> sparse.csr_array:
        """Return the weight float32 (cell, colour) of pixels float32 (y, x) by the colour of each, int (y, x)."""
        rows, columns = (
            (first + np.arange(number)) // self.side for first, number in zip(self.start, weight.shape, strict=True)
        )
        cell = rows[:, None] * self.shape[1] + columns
        places = (cell.ravel(), colour_of.ravel())
        return sparse.csr_array((weight.ravel(), places), (self.shape[0] * self.shape[1], num_colours))

    def interpolate(self, values: np.ndarray, colour_of: np.ndarray) -> np.ndarray:
        """Return the value of each pixel's colour, float32 (y, x), from `values` (row, column, colour) at centres."""
        (above, below, down), (left, right, along) = map(self._neighbours, colour_of.shape, self.start)
        above, below, down = above[:, None], below[:, None], down[:, None]
        upper = (1 - along) * values[above, left, colour_of] + along * values[above, right, colour_of]
        lower = (1 - along) * values[below, left, colour_of] + along * values[below, right, colour_of]
        return (1 - down) * upper + down * lower

    def _neighbours(self, num_pixels: int, start: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the cells whose centres are before and after each pixel of a row, and the share of those after it."""
        place = (np.arange(start, start + num_pixels) + 0.5) / self.side - 0.5
        before = np.floor(place).astype(int)
        return before, before + 1, (place - before).astype(np.float32)


def _bins(params: LocalColourParams) -> AppearanceParams:
    return AppearanceParams(levels=params.levels, texture_levels=1)


def _alike(colours: np.ndarray, params: LocalColourParams) -> sparse.csr_array:
    """Return how much alike each colour is to each other one, float32 (colour, colour), at most 1."""
    places = spatial.KDTree(np.stack(np.unravel_index(colours, (params.levels,) * 3), axis=1))
    distances = places.sparse_distance_matrix(places, _REACH * params.smoothing, output_type="coo_matrix")
    likeness = np.exp(-np.square(distances.data.astype(np.float32)) / np.float32(2 * params.smoothing**2))
    return sparse.csr_array((likeness, (distances.row, distances.col)), distances.shape)


def _gaussian(number: int, sigma: float) -> np.ndarray:
    """Return exp(-d^2 / 2 sigma^2), float32, of the distances d of `number` places in a row from each other."""
    places = np.arange(number, dtype=np.float32)
    return np.exp(-np.square(places[:, None] - places) / np.float32(2 * sigma * sigma))


def _in_windows(values: np.ndarray, windows: list[np.ndarray]) -> np.ndarray:
    """Return the weighted sums of `values` (row, column, colour) in the window around each cell, float32."""
    rows, columns = windows
    return columns @ np.tensordot(rows, values.astype(np.float32), axes=1)
