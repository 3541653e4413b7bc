"""Depth Anything V2: affine inverse depth of a single image."""

from transformers import DepthAnythingConfig, DepthAnythingForDepthEstimation

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.depth.positions import resample_as_trained
from moseg.tasks.networks.transformers_model import build_transformers


def build_depth_anything(checkpoint: Checkpoint) -> DepthAnythingForDepthEstimation:
    """Build the network of ``depth-anything/Depth-Anything-V2-{Small,Base,Large}-hf``.

    Of the checkpoint's documents only ``config.json`` is read; the sizes that ``preprocessor_config.json`` gives, the
    same for all three, are `DepthAnythingParams`.

    Raises
    ------
    InputError
        The checkpoint is not one of this network, or of its metric kind, which gives depth and not inverse depth.

    References
    ----------
    Yang et al., "Depth Anything V2", NeurIPS 2024.
    """
    model = build_transformers(DepthAnythingForDepthEstimation, DepthAnythingConfig, checkpoint)
    kind = model.config.depth_estimation_type
    if kind != "relative":
        raise InputError("depth of another kind", where=f"weights {checkpoint.name}", got=kind, expected="relative")
    return resample_as_trained(model)
