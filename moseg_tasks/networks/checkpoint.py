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
