"""Loading tensors into a module, all of them or none."""

from collections.abc import Mapping

import torch

from moseg.schemas.errors import InputError

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
