"""Checks of what a task returned, before it is stored."""

from collections.abc import Mapping, Sequence

import numpy as np

from moseg.schemas.arrays import ArrayLayout
from moseg.schemas.digests import canonical_json
from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.recipes import Recipe
from moseg.workflows.stages.registry import axes_of, layouts_of
from moseg.workflows.stages.task import Output

_ROUNDING = 1e-6


def check_outputs(recipes: Sequence[Recipe], outputs: object, is_plugin: bool) -> None:
    """Raise InputError unless a task returned an `Output` of the stage's arrays for each recipe, as one of a plug-in
    may not; of that, the values are checked too."""
    where = f"{recipes[0].task} by {recipes[0].params['method']}"
    if not isinstance(outputs, list | tuple) or len(outputs) != len(recipes):
        got = f"{len(outputs)} values" if isinstance(outputs, list | tuple) else type(outputs).__name__
        what, expected = "a task that did not return a list with an Output for each input", f"{len(recipes)} of them"
        raise InputError(what, where=where, got=got, expected=expected)
    for computed in outputs:
        if not isinstance(computed, Output) or not isinstance(computed.arrays, Mapping):
            got = type(computed.arrays if isinstance(computed, Output) else computed).__name__
            raise InputError("a task that returned no Output", where=where, got=got, expected="Output({name: array})")
        for name, array in computed.arrays.items():
            if not isinstance(array, np.ndarray):
                got = type(array).__name__
                raise InputError(f"{name} that is no array", where=where, got=got, expected="numpy.ndarray")
        try:
            axes_of(recipes[0].task, computed.arrays)
        except StoreError as error:
            what, place, got, expected = error.parts
            raise InputError(f"{what} of {place}", where=where, got=got, expected=expected) from error
        try:
            canonical_json(dict(computed.attributes))
        except (TypeError, ValueError) as error:
            what, expected = "attributes that cannot be stored", "str, bool, int, finite float, None, list and dict"
            raise InputError(what, where=where, got=error, expected=expected) from error
        if is_plugin:
            _check_values(computed.arrays, layouts_of(recipes[0].task), where)


def _check_values(arrays: Mapping[str, np.ndarray], layouts: Mapping[str, ArrayLayout], where: str) -> None:
    """Raise InputError unless axes of one name are equally long and values are in their ranges."""
    lengths: dict[str, tuple[int, str]] = {}
    for name, array in arrays.items():
        for axis, length in zip(layouts[name].dims, array.shape, strict=True):
            known, of = lengths.setdefault(axis, (length, name))
            if known != length:
                what, expected = f"axis {axis} of two lengths", f"{known}, as in {of}"
                raise InputError(what, where=where, got=f"{length} in {name}", expected=expected)
        low, high = layouts[name].low, layouts[name].high
        if low is not None and (wrong := array[(array < low - _ROUNDING) | (array > high + _ROUNDING)]).size:
            got, expected = f"{wrong.flat[0]:.6g}", f"{low:g} to {high:g}, or NaN where unknown"
            raise InputError(f"{name} out of range", where=where, got=got, expected=expected)
