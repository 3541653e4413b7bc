"""Dense inverse search (DIS) optical flow."""

from threading import local
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowParams
from moseg.tasks.check_frame import check_frame
from moseg.tasks.flow.flow_grid import resize_flow
from moseg.tasks.frame_grid import MIN_ENLARGEMENT, grid_shape, reduced_shape, resample

_PRESETS = {
    "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
    "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
    "lighter": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    "light": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    "balanced": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    "fine": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
}
_FINEST = {"ultrafast": 2, "fast": 2, "lighter": 1, "light": 1, "balanced": 1, "medium": 1, "fine": 0}
"""Finest level of each preset's pyramid; each level has half the resolution of the one before."""


class _Effort(NamedTuple):
    """Effort of a search: distance between patches, px, and iterations of their descent and of the refinement."""

    patch_stride: int
    descent_iterations: int
    refinement_iterations: int


_REDUCED = {
    "lighter": {128: _Effort(patch_stride=4, descent_iterations=8, refinement_iterations=0)},
    "light": {128: _Effort(patch_stride=4, descent_iterations=8, refinement_iterations=2)},
    "balanced": {
        128: _Effort(patch_stride=3, descent_iterations=8, refinement_iterations=2),
        512: _Effort(patch_stride=5, descent_iterations=16, refinement_iterations=1),
    },
}
"""Of presets by the longer side of the grid, px, from which on each is theirs; medium's, theirs below, is 3, 25 and 5.

Light takes half the time of medium and lighter two fifths. Small grids have too few patches to leave any out.
"""
_COARSE = _Effort(patch_stride=1, descent_iterations=25, refinement_iterations=2)
"""Of the search on the coarse grid: things that few patches of the pyramid cover have patches of their own here."""
_MIN_COARSER = 3
"""Longer side of the grid at which a search ends, at least, in those of the coarse grid."""
# Of a frame whose levels OpenCV chooses. On a smaller one it raises, returns NaN or crashes.
_MIN_SIDE = 32
# Of the grid at which the search ends; OpenCV refuses smaller images.
_MIN_GRID = 12


def estimate_flow(image0: np.ndarray, image1: np.ndarray, params: FlowParams) -> np.ndarray:
    """Estimate the flow that maps each pixel of `image0` to its position in `image1`.

    It is that of `search_flow`, whose parameters and errors it has, at the frames' size: float32 (y, x, 2), px/frame.
    """
    return resize_flow(search_flow(image0, image1, params), image0.shape[:2])


def search_flow(image0: np.ndarray, image1: np.ndarray, params: FlowParams) -> np.ndarray:
    """Estimate the flow on the grid at which the search ends.

    It is of full, half or a quarter of the frames' size, but its longer side is no shorter than `search_side`, up to a
    tenth, or than the frames', of which small ones are enlarged to `enlarged_side`, and twice their size, at most.
    Between the vectors of a coarser grid OpenCV interpolates, as `resize_flow` does. Where a side of the grid is under
    12 px, frames are extended to 32 px by replicating their border, and the flow is cropped; it is of full size.

    Parameters
    ----------
    image0, image1 : uint8 (y, x, 3)
        RGB frames of one size.
    params : FlowParams
        `preset` is the trade of speed for accuracy, `search_side` the longer side of the grid at least, px,
        `enlarged_side` that of small frames' at most, and `coarse_side` that of the grid whose flow is a candidate of
        each patch at each level of the pyramid.

    Returns
    -------
    flow : float32 (grid y, grid x, 2)
        xy displacement, px/frame of the frames.

    Raises
    ------
    InputError
        The images are not two uint8 RGB frames of one size.

    References
    ----------
    Kroeger, Timofte, Dai, Van Gool, "Fast Optical Flow using Dense Inverse Search", ECCV 2016.
    """
    check_frame(image0, "image0")
    check_frame(image1, "image1")
    if image0.shape != image1.shape:
        raise InputError("frames of a pair differ in size", got=image1.shape[:2], expected=image0.shape[:2])
    height, width = image0.shape[:2]
    grid = _search_grid((height, width), params)
    if min(grid) < _MIN_GRID:
        # OpenCV chooses the levels of such a frame by itself.
        search = _make_search(params.preset, _effort(params.preset, grid))
        flow = search.calc(_searchable_gray(image0), _searchable_gray(image1), None)
        return np.ascontiguousarray(flow[:height, :width])
    searched = [resample(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), grid) for image in (image0, image1)]
    coarse = _coarse_flow(searched, params.coarse_side)
    role = "whole search" if coarse is None else "search with candidates"
    flow = _kept(role, params.preset, grid, _effort(params.preset, grid)).calc(*searched, coarse)
    # Not a power of two where a side is no multiple of one.
    return flow * np.float32([width / grid[1], height / grid[0]])


def _coarse_flow(images: list[np.ndarray], side: int) -> np.ndarray | None:
    """Return the flow between images uint8 (y, x) of a search on a grid of longer side `side`; None if there is none.

    It is interpolated to the images' grid: float32 (y, x, 2), px of that grid.
    """
    height, width = images[0].shape
    if not side or max(height, width) < _MIN_COARSER * side:
        return None
    grid = reduced_shape((height, width), side)
    if min(grid) < _MIN_GRID:
        return None
    flow = _kept("coarse search", "medium", grid, _COARSE).calc(*(resample(image, grid) for image in images), None)
    return resize_flow(flow, (height, width)) * np.float32([width / grid[1], height / grid[0]])


def _search_grid(size: tuple[int, int], params: FlowParams) -> tuple[int, int]:
    """Return (height, width) of the grid at which the search between frames of a size ends."""
    level = _FINEST[params.preset]
    height, width = (side >> level for side in size)
    # Almost as long is long enough: between a grid of a half and one a little finer, patches are blurred for nothing.
    is_long = max(height, width) * MIN_ENLARGEMENT >= params.search_side
    if is_long:
        return height, width
    enlarged = max(*size, params.enlarged_side)
    return grid_shape(size, min(params.search_side, enlarged))


_KEPT = local()
"""Searches of each thread, each for grids of one size: their maps are allocated once."""


def _kept(role: str, preset: str, grid: tuple[int, int], effort: _Effort | None) -> cv2.DISOpticalFlow:
    """Return this thread's search of a role that ends on the grid of the images, made anew for another grid or preset.

    OpenCV goes on using the candidates that a search was once given: a search of one role always has some, or never.
    """
    searches = _KEPT.__dict__
    if role not in searches or searches[role][0] != (preset, grid):
        search = _make_search(preset, effort)
        search.setFinestScale(0)
        searches[role] = (preset, grid), search
    return searches[role][1]


def _effort(preset: str, grid: tuple[int, int]) -> _Effort | None:
    """Return the effort of a preset on a grid (height, width); None: that of OpenCV's."""
    efforts = _REDUCED.get(preset, {})
    return efforts[max(sides)] if (sides := [side for side in efforts if max(grid) >= side]) else None


def _make_search(preset: str, effort: _Effort | None) -> cv2.DISOpticalFlow:
    """Return a search with OpenCV's preset and an effort of ours, if any."""
    search = cv2.DISOpticalFlow_create(_PRESETS[preset])
    if effort is not None:
        search.setPatchStride(effort.patch_stride)
        search.setGradientDescentIterations(effort.descent_iterations)
        search.setVariationalRefinementIterations(effort.refinement_iterations)
    return search


def _searchable_gray(image: np.ndarray) -> np.ndarray:
    """Convert to grey levels, extended below and to the right to the smallest side that DIS can search."""
    height, width = image.shape[:2]
    gray = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    below, right = max(_MIN_SIDE - height, 0), max(_MIN_SIDE - width, 0)
    return cv2.copyMakeBorder(gray, 0, below, 0, right, cv2.BORDER_REPLICATE) if below or right else gray
