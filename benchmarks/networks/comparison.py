"""Outputs of a network's modules, and differences of the results of backends."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import torch
from torch.nn.modules import module as hooks

MAX_KEPT = 2**25
"""Numbers of an output that is kept for a comparison."""


class Outputs:
    """Records what the modules of a network give while its block is run, also those that run several times.

    Of each module the largest magnitude in each precision; and of each that a backend calls itself, the last output.
    """

    def __init__(self, network: Any):
        self._names = {module: name for name, module in _modules(network)}
        self._depth = 0
        self._magnitudes: list[tuple[str, torch.dtype, torch.Tensor]] = []
        self._found: list[tuple[str, torch.dtype, float]] = []
        self._last: dict[str, list[torch.Tensor]] = {}

    def __enter__(self) -> "Outputs":
        self._handles = (
            hooks.register_module_forward_pre_hook(self._begin),
            hooks.register_module_forward_hook(self._end, always_call=True),
        )
        return self

    def __exit__(self, *_) -> None:
        for handle in self._handles:
            handle.remove()
        self._found = [(name, dtype, float(largest)) for name, dtype, largest in self._magnitudes]

    def _begin(self, module: torch.nn.Module, _) -> None:
        self._depth += 1

    def _end(self, module: torch.nn.Module, _, output: Any) -> None:
        self._depth -= 1
        name = self._names.get(module, type(module).__name__)
        tensors = [tensor for tensor in _tensors(output) if tensor.is_floating_point() and tensor.numel()]
        for tensor in tensors:
            lowest, highest = torch.aminmax(tensor)
            # Not a number if the output has one.
            self._magnitudes.append((name, tensor.dtype, torch.maximum(-lowest, highest)))
        if self._depth == 0:
            self._last[name] = [tensor.float().cpu() for tensor in tensors if tensor.numel() <= MAX_KEPT]

    def largest(self, dtype: torch.dtype) -> tuple[str, float] | None:
        """Return the module with the largest output in a precision, and its magnitude; None without any."""
        found = [(name, value) for name, own, value in self._found if own == dtype and np.isfinite(value)]
        return max(found, key=lambda each: each[1], default=None)

    def non_finite(self) -> list[str]:
        """Return the modules with an output that is not finite, in the order in which they first gave it."""
        return list(dict.fromkeys(name for name, _, value in self._found if not np.isfinite(value)))

    def differences(self, other: "Outputs") -> dict[str, float]:
        """Return the largest relative difference (L2) of the outputs of each module that the backend calls."""
        found = {}
        for name in self._last.keys() & other._last.keys():
            pairs = zip(self._last[name], other._last[name], strict=False)
            of_outputs = [_difference(own, its) for own, its in pairs if own.shape == its.shape]
            if of_outputs:
                found[name or "network"] = max(of_outputs)
        return dict(sorted(found.items()))


def compare_results(result: Any, other: Any) -> dict[str, float]:
    """Return by what two results of a backend differ, in the measures of its kind."""
    fields = result._fields if hasattr(result, "_fields") else ()
    if fields == ("names", "scores"):
        return {"tags": len(result.names), "other tags": len(set(result.names) ^ set(other.names))}
    if fields == ("points", "visible", "object"):
        return _compare_tracks(result, other)
    if "pose" in fields:
        return {"pose": float(np.abs(result.pose - other.pose).max())} | _compare_maps(
            result.inverse_depth, other.inverse_depth
        )
    if "tags" in fields:
        masks = getattr(result, "masks", None)
        found = {"objects": len(result.scores), "objects in float32": len(other.scores)}
        return found | (_compare_labels(masks, other.masks) if masks is not None else {})
    if isinstance(result, tuple):
        return _compare_labels(result[0], other[0]) | {"quality": float(np.abs(result[1] - other[1]).max())}
    if result.dtype == np.uint16:
        return _compare_labels(result, other)
    if result.shape[-1] == 2:
        distance = np.linalg.norm(result - other, axis=-1)
        length = np.linalg.norm(other, axis=-1).mean()
        return {"px": float(distance.mean()), "px at most": float(distance.max()), "of px": float(length)}
    return _compare_maps(result, other)


def is_finite(result: Any) -> bool:
    """Return whether all numbers of a result are finite."""
    parts = result if isinstance(result, tuple) else (result,)
    arrays = [part for part in parts if isinstance(part, np.ndarray) and part.dtype.kind == "f"]
    return all(bool(np.isfinite(part).all()) for part in arrays)


def replace_non_finite(network: Any) -> None:
    """Set parameters that are not finite, or were never initialised, to zero."""
    for _, module in _modules(network):
        for tensor in module.parameters(recurse=False):
            tensor.data.nan_to_num_(0, 0, 0)


def _compare_tracks(result: Any, other: Any) -> dict[str, float]:
    found = {"tracks": len(result.points), "tracks in float32": len(other.points)}
    if result.points.shape != other.points.shape:
        return found
    both = result.visible & other.visible
    distance = np.linalg.norm(result.points - other.points, axis=-1)[both]
    found["visible otherwise"] = float((result.visible != other.visible).mean())
    return found | ({"px": float(distance.mean()), "px at most": float(distance.max())} if both.any() else {})


def _compare_labels(labels: np.ndarray, other: np.ndarray) -> dict[str, float]:
    if labels.shape != other.shape or not other.size:
        return {}
    return {"other pixels": float((labels != other).mean()), "shown": float((other > 0).mean())}


def _compare_maps(maps: np.ndarray, other: np.ndarray) -> dict[str, float]:
    spread = max(float(other.std()), 1e-12)
    return {"of spread": float(np.abs(maps - other).mean()) / spread}


def _difference(own: torch.Tensor, its: torch.Tensor) -> float:
    is_finite = own.isfinite() & its.isfinite()
    own, its = own[is_finite].double(), its[is_finite].double()
    return float((own - its).norm() / its.norm().clamp(min=1e-12))


def _modules(network: Any) -> Iterator[tuple[str, torch.nn.Module]]:
    """Yield the modules of a network, or of the networks in a tuple, by name."""
    for part in network if isinstance(network, tuple) else (network,):
        if isinstance(part, torch.nn.Module):
            yield from part.named_modules()


def _tensors(output: Any) -> Iterator[torch.Tensor]:
    if isinstance(output, torch.Tensor):
        yield output
    elif isinstance(output, Mapping):
        yield from (tensor for value in output.values() for tensor in _tensors(value))
    elif isinstance(output, tuple | list):
        yield from (tensor for value in output for tensor in _tensors(value))
