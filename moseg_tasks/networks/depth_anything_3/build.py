"""Depth Anything 3, built from the published checkpoints."""

from collections.abc import Mapping

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.depth_anything_3.config import BASE, SMALL, DepthAnything3Config
from moseg.tasks.networks.depth_anything_3.network import DepthAnything3, DepthAnything3Views
from moseg.tasks.networks.transformers_model import CONFIG, read_json

PUBLISHED: Mapping[str, DepthAnything3Config] = {"da3-small": SMALL, "da3-base": BASE}
"""Networks by the name that their `config.json` gives."""
PREFIX = "model."
GIVEN_CAMERAS, CAMERAS = "cam_enc.", "cam_dec."
"""Prefixes of the tensors of the encoder of given cameras, and of the decoder of cameras."""
RAYS = "_aux."
"""Part of the names of the tensors of the branch of rays."""
UNUSED_RAYS = tuple(f"head.scratch.output_conv{part}_aux.{level}." for part in (1, 2) for level in range(3))
"""Prefixes of the projections of the smaller maps of rays, which the authors train, too, but do not use."""


def build_depth_anything_3(checkpoint: Checkpoint) -> DepthAnything3:
    """Build the network of single images of ``depth-anything/DA3-{SMALL,BASE}``, without cameras and rays.

    Raises
    ------
    InputError
        The checkpoint is of another network, or a tensor is missing, left over or of another shape.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025.
    """
    return _load(DepthAnything3(_sizes(checkpoint)), checkpoint)


def build_depth_anything_3_cameras(checkpoint: Checkpoint) -> DepthAnything3Views:
    """Build the network of several views of a scene, with the decoder of cameras; otherwise as for single images."""
    return _load(DepthAnything3Views(_sizes(checkpoint)), checkpoint)


def build_depth_anything_3_rays(checkpoint: Checkpoint) -> DepthAnything3Views:
    """Build the network of several views of a scene, with the branch of rays; otherwise as for single images."""
    return _load(DepthAnything3Views(_sizes(checkpoint), has_rays=True), checkpoint)


def _sizes(checkpoint: Checkpoint) -> DepthAnything3Config:
    name = read_json(checkpoint, CONFIG).get("model_name", "no model_name")
    if name not in PUBLISHED:
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError("another network", where=where, got=name, expected=" or ".join(PUBLISHED))
    return checkpoint.sizes(PUBLISHED[name])


def _load(network: DepthAnything3, checkpoint: Checkpoint) -> DepthAnything3:
    """Load the tensors of the parts that a network has; every file holds those of all parts."""
    has_cameras = getattr(network, "cam_dec", None) is not None
    unused = (GIVEN_CAMERAS, *UNUSED_RAYS) if has_cameras else (GIVEN_CAMERAS, CAMERAS, *UNUSED_RAYS)
    named = {name.removeprefix(PREFIX): tensor for name, tensor in checkpoint.tensors.items()}
    used = {
        name: tensor
        for name, tensor in named.items()
        if not name.startswith(unused) and (network.head.has_rays or RAYS not in name)
    }
    return load_strictly(network, used, checkpoint.name)
