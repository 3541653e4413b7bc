"""What a network is built from: the content of its checkpoint's files."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import torch

from moseg.schemas.errors import InputError

WRAPPERS = ("state_dict", "model", "model_state_dict")
"""Keys under which published checkpoints keep their tensors, beside optimizers and step counts."""
PARALLEL_PREFIX = "module."


class Checkpoint(NamedTuple):
    """Tensors and small files of one checkpoint.

    Attributes
    ----------
    name : str
        Names the checkpoint in errors.
    tensors : dict of str to torch.Tensor
        The state dict, unwrapped.
    documents : dict of str to str
        Text of the small files by name: ``config.json``, ``vocab.txt``, a list of tags.
    config : dict of JSON values
        Sizes of an own module that differ from the published network's; empty for the published ones.
    """

    name: str
    tensors: Mapping[str, torch.Tensor]
    documents: Mapping[str, str] = {}
    config: Mapping[str, Any] = {}


def unwrap_state(content: Any, name: str) -> dict[str, torch.Tensor]:
    """The state dict in what a ``.pth`` file holds: bare or under a wrapper's key, with or without ``module.``.

    Raises
    ------
    InputError
        There is no state dict in it.
    """
    for key in WRAPPERS:
        if isinstance(content, Mapping) and isinstance(content.get(key), Mapping):
            content = content[key]
    tensors = {}
    if isinstance(content, Mapping):
        tensors = {key: value for key, value in content.items() if isinstance(value, torch.Tensor)}
    if not tensors or len(tensors) != len(content):
        raise InputError("no state dict", where=f"weights {name}", expected="tensors by name")
    if all(key.startswith(PARALLEL_PREFIX) for key in tensors):
        tensors = {key.removeprefix(PARALLEL_PREFIX): value for key, value in tensors.items()}
    return tensors


SHOWN = 3


def load_strictly(module: torch.nn.Module, tensors: Mapping[str, torch.Tensor], name: str) -> torch.nn.Module:
    """The module with its parameters and buffers set, in evaluation mode and without gradients.

    Raises
    ------
    InputError
        A tensor is missing, left over or of another shape; the first of them are named.
    """
    expected = {key: tuple(value.shape) for key, value in module.state_dict().items()}
    got = {key: tuple(value.shape) for key, value in tensors.items()}
    wrong = [
        f"{key} {got[key]} instead of {expected[key]}" for key in expected if key in got and got[key] != expected[key]
    ]
    for what, keys in (
        ("tensors are missing", [key for key in expected if key not in got]),
        ("tensors are not the network's", [key for key in got if key not in expected]),
        ("tensors of another shape", wrong),
    ):
        if keys:
            more = f" and {len(keys) - SHOWN} more" if len(keys) > SHOWN else ""
            raise InputError(what, where=f"weights {name}", got=", ".join(keys[:SHOWN]) + more)
    module.load_state_dict(tensors)
    return module.eval().requires_grad_(False)
