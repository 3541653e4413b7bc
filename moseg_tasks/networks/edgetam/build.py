"""The image network and the video network of EdgeTAM."""

import json

from transformers import (
    EdgeTamConfig,
    EdgeTamModel,
    EdgeTamVideoConfig,
    EdgeTamVideoInferenceSession,
    EdgeTamVideoModel,
)

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.edgetam.repvit import RepVitConfig
from moseg.tasks.networks.sam2.first_mask import FirstMaskAsByAuthors
from moseg.tasks.networks.transformers_model import CONFIG, build_transformers, read_json

BACKBONE = "repvit_m1"


def build_edgetam_image(checkpoint: Checkpoint) -> EdgeTamModel:
    """Build image encoder, prompt encoder and mask decoder of ``yonigozlan/EdgeTAM-hf``; the memory is ignored.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Zhou et al., "EdgeTAM: On-Device Track Anything Model", CVPR 2025.
    """
    return build_transformers(EdgeTamModel, EdgeTamConfig, _with_own_backbone(checkpoint))


class EdgeTamVideo(FirstMaskAsByAuthors, EdgeTamVideoModel):
    """The video network, run as by its authors where the first mask of an object is given."""

    session_class = EdgeTamVideoInferenceSession


def build_edgetam_video(checkpoint: Checkpoint) -> EdgeTamVideo:
    """Build the complete network of ``yonigozlan/EdgeTAM-hf``; no tensor is ignored.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Zhou et al., "EdgeTAM: On-Device Track Anything Model", CVPR 2025.
    """
    return build_transformers(EdgeTamVideo, EdgeTamVideoConfig, _with_own_backbone(checkpoint))


def _with_own_backbone(checkpoint: Checkpoint) -> Checkpoint:
    """Return the checkpoint with a configuration that names our RepViT in place of timm's."""
    content = read_json(checkpoint, CONFIG)
    vision = content.get("vision_config")
    backbone = vision.get("backbone_config") if isinstance(vision, dict) else None
    name = str(backbone.get("architecture")) if isinstance(backbone, dict) else None
    if name is None or name.partition(".")[0] != BACKBONE:
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError("another image encoder", where=where, got=name, expected=f"timm's {BACKBONE}")
    given = backbone.get("model_args") or {}
    sizes = {ours: given[theirs] for ours, theirs in (("widths", "embed_dim"), ("depths", "depth")) if theirs in given}
    vision["backbone_config"] = {"model_type": RepVitConfig.model_type, **sizes}
    return checkpoint._replace(documents={**checkpoint.documents, CONFIG: json.dumps(content)})
