"""Layouts of the arrays that an artifact holds: dtype, axes and unit of each."""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from moseg.schemas.errors import StoreError
from moseg.schemas.frozen import Frozen

_BLOCK = 1 << 17
"""Values that are looked up at a time: their indices stay in a processor's cache."""


class ArrayLayout(Frozen):
    """Layout of one array.

    Attributes
    ----------
    dtype : str
        Numpy dtype.
    dims : tuple of str
        Axis names, outermost first.
    unit : str
    step : float or None
        Power of two in `unit` to whose multiples a stage's values are rounded, so that they take fewer bytes.
    low, high : float or None
        Range of values that are not NaN, both or none.
    """

    dtype: str
    dims: tuple[str, ...]
    unit: str = ""
    step: float | None = None
    low: float | None = None
    high: float | None = None


def layout(
    dtype: str, dims: str, unit: str = "", step: float | None = None, within: tuple[float, float] | None = None
) -> ArrayLayout:
    """Return the layout of an array; `dims` are the names of its axes, separated by blanks."""
    low, high = within or (None, None)
    return ArrayLayout(dtype=dtype, dims=tuple(dims.split()), unit=unit, step=step, low=low, high=high)


def round_arrays(arrays: Mapping[str, np.ndarray], layouts: Mapping[str, ArrayLayout]) -> dict[str, np.ndarray]:
    """Return the arrays, those whose layout has a step rounded to its multiples; other arrays are not copied."""
    steps = {name: layouts[name].step for name in arrays if name in layouts}
    return {name: _round(array, steps.get(name)) for name, array in arrays.items()}


def _round(array: np.ndarray, step: float | None) -> np.ndarray:
    if step is None:
        return array
    if array.dtype == np.float16 and array.ndim and array.flags.c_contiguous:
        return _look_up(_rounded_halves(step), array.view(np.uint16)).view(np.float16)
    return _multiples(array, step)


@lru_cache(maxsize=16)
def _rounded_halves(step: float) -> np.ndarray:
    """Return the bits uint16 (65536,) of each float16 after rounding: looked up six times as fast as computed."""
    with np.errstate(invalid="ignore"):
        return _multiples(np.arange(1 << 16, dtype=np.uint16).view(np.float16), step).view(np.uint16)


def _look_up(table: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the entries of a table uint16 (65536,) at `places`, uint16 of any shape."""
    found = np.empty_like(places)
    source, target = places.reshape(-1), found.reshape(-1)
    # Block by block: NumPy makes indices of 8 bytes, four times the memory of the maps of a section.
    for start in range(0, source.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        np.take(table, source[block], out=target[block], mode="clip")
    return found


def _multiples(array: np.ndarray, step: float) -> np.ndarray:
    # in float32, where neither the quotients of float16 nor their rounded values overflow
    rounded = np.multiply(array, np.float32(1 / step), dtype=np.float32)
    np.rint(rounded, out=rounded)
    rounded *= np.float32(step)
    return rounded.astype(array.dtype, copy=False)


LEAF_LAYOUTS: Mapping[str, Mapping[str, ArrayLayout]] = {
    "frame": {"image": layout("uint8", "y x rgb")},
    "annotation": {"masks": layout("uint16", "frame y x")},
    "labelled_points": {
        "points": layout("float64", "track frame xy", "px of the original frames"),
        "visible": layout("bool", "track frame"),
        "labels": layout("uint16", "track", "0 = static, else the label of what moves"),
    },
    "given_masks": {"masks": layout("uint16", "frame y x")},
    "given_depth": {"inverse_depth": layout("float32", "y x", "relative")},
    "given_flow": {"flow": layout("float32", "y x uv", "px/frame")},
    "given_tracks": {
        "points": layout("float32", "track frame xy", "px"),
        "visible": layout("bool", "track frame"),
    },
    "motion_weights": {"onnx": layout("uint8", "byte", "ONNX file")},
    "trajectories": {
        "points": layout("float64", "track frame xy", "px"),
        "visible": layout("bool", "track frame"),
    },
    "trajectory_labels": {"labels": layout("uint16", "track", "motion")},
}
"""Layouts of the leaves that ingest decodes; each stage declares the layouts of its own arrays."""


def check_arrays(
    task: str, arrays: Mapping[str, np.ndarray], layouts: Mapping[str, ArrayLayout]
) -> dict[str, tuple[str, ...]]:
    """Return the axis names of each array.

    Raises
    ------
    StoreError
        The names, a dtype or a rank differ from the layouts of `task`.
    """
    if set(arrays) != set(layouts):
        raise StoreError("wrong set of arrays", where=task, got=sorted(arrays), expected=sorted(layouts))
    for name, array in arrays.items():
        expected = layouts[name]
        if array.dtype != np.dtype(expected.dtype) or array.ndim != len(expected.dims):
            raise StoreError(
                "wrong array layout",
                where=f"{task}.{name}",
                got=f"{array.dtype} with {array.ndim} axes",
                expected=f"{expected.dtype} {expected.dims}",
            )
    return {name: layouts[name].dims for name in arrays}
