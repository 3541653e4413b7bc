"""Depth Anything 3, built from the published checkpoints."""

from collections.abc import Mapping
from typing import Any

from torch import Tensor

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.depth_anything_3.config import BASE, SMALL, DepthAnything3Config
from moseg.tasks.networks.depth_anything_3.network import DepthAnything3
from moseg.tasks.networks.transformers_model import CONFIG, read_json

PUBLISHED: Mapping[str, DepthAnything3Config] = {"da3-small": SMALL, "da3-base": BASE}
"""Networks by the name that their `config.json` gives."""
PREFIX = "model."
OTHER_PARTS = ("cam_enc.", "cam_dec.")
"""Prefixes of the tensors of the encoder of given cameras and of the decoder of cameras."""
RAYS = "_aux."
"""Part of the names of the tensors of the branch of rays."""


def build_depth_anything_3(checkpoint: Checkpoint) -> DepthAnything3:
    """Build the network of ``depth-anything/DA3-{SMALL,BASE}``, without the parts for cameras and rays.

    Raises
    ------
    InputError
        The checkpoint is of another network, or a tensor is missing, left over or of another shape.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025.
    """
    name = read_json(checkpoint, CONFIG).get("model_name", "no model_name")
    if name not in PUBLISHED:
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError("another network", where=where, got=name, expected=" or ".join(PUBLISHED))
    network = DepthAnything3(checkpoint.sizes(PUBLISHED[name]))
    return load_strictly(network, _used(checkpoint.tensors), checkpoint.name)


def _used(tensors: Mapping[str, Tensor]) -> dict[str, Any]:
    """Return the tensors of the branch of depth, without the prefix of all names."""
    named = {name.removeprefix(PREFIX): tensor for name, tensor in tensors.items()}
    return {name: tensor for name, tensor in named.items() if not name.startswith(OTHER_PARTS) and RAYS not in name}
