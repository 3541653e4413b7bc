"""The content of a checkpoint's files, and its tensors loaded into a network."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import torch
from pydantic import BaseModel, ValidationError

from moseg.schemas.errors import InputError

WRAPPERS = ("state_dict", "model", "model_state_dict")
"""Keys under which published checkpoints keep their tensors, beside optimizers and step counts."""
PARALLEL_PREFIX = "module."
MAX_SHOWN = 3
"""Tensors that an error names."""

Sizes = TypeVar("Sizes", bound=BaseModel)


class Checkpoint(NamedTuple):
    """Tensors and small files of a checkpoint.

    Attributes
    ----------
    name : str
        Name of the checkpoint in errors.
    tensors : dict of str to torch.Tensor
        The state dict, unwrapped.
    documents : dict of str to str
        Text of the small files by name: ``config.json``, ``vocab.txt``, a list of tags.
    config : dict of JSON values
        Sizes of our own modules where they differ from the published ones.
    """

    name: str
    tensors: Mapping[str, torch.Tensor]
    documents: Mapping[str, str] = {}
    config: Mapping[str, Any] = {}

    def document(self, name: str) -> str:
        """Return the text of a small file; raise InputError if the checkpoint lacks it."""
        if name not in self.documents:
            raise InputError(f"no {name}", where=f"weights {self.name}", got=sorted(self.documents))
        return self.documents[name]

    def sizes(self, published: Sizes) -> Sizes:
        """Return the `published` sizes of a network, updated by those in `config`.

        Raises
        ------
        InputError
            `config` has a field or value that the network cannot have.
        """
        try:
            return type(published).model_validate(published.model_dump() | dict(self.config))
        except ValidationError as error:
            problem = error.errors()[0]
            got = f"{'.'.join(map(str, problem['loc']))}: {problem['msg']}"
            raise InputError("invalid sizes", where=f"config of weights {self.name}", got=got) from error


def unwrap_state(content: Any, name: str) -> dict[str, torch.Tensor]:
    """Return the state dict in a ``.pth`` file's content: bare or under a wrapper's key, with or without ``module.``.

    Raises
    ------
    InputError
        The content holds no state dict.
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


def load_strictly(module: torch.nn.Module, tensors: Mapping[str, torch.Tensor], name: str) -> torch.nn.Module:
    """Load tensors into a module and return it in evaluation mode and without gradients.

    Raises
    ------
    InputError
        A tensor is missing, left over or of another shape; the first of them are named.
    """
    expected = {key: tuple(value.shape) for key, value in module.state_dict().items()}
    got = {key: tuple(value.shape) for key, value in tensors.items()}
    wrong = [(key, got[key], expected[key]) for key in expected if key in got and got[key] != expected[key]]
    refuse_tensors("tensors are missing", [key for key in expected if key not in got], name)
    refuse_tensors("tensors are not the network's", [key for key in got if key not in expected], name)
    refuse_tensors("tensors of another shape", [describe_shapes(*found) for found in wrong], name)
    module.load_state_dict(tensors)
    return module.eval().requires_grad_(False)


def refuse_tensors(what: str, tensors: Sequence[str], name: str) -> None:
    """Raise InputError that names the first of the tensors of weights `name`, if there are any."""
    if tensors:
        more = f" and {len(tensors) - MAX_SHOWN} more" if len(tensors) > MAX_SHOWN else ""
        raise InputError(what, where=f"weights {name}", got=", ".join(tensors[:MAX_SHOWN]) + more)


def describe_shapes(key: str, got: Sequence[int], expected: Sequence[int]) -> str:
    """Return the text of an error about a tensor of another shape."""
    return f"{key} {tuple(got)} instead of {tuple(expected)}"
