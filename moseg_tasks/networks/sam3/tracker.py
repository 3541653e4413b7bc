"""The tracker of SAM 3, run as by its authors."""

import json

import torch
from torch.nn import functional
from transformers import Sam3TrackerVideoConfig, Sam3TrackerVideoInferenceSession, Sam3TrackerVideoModel

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.frame_tensor import SYMMETRIC
from moseg.tasks.networks.sam2 import to_joinable
from moseg.tasks.networks.transformers_model import CONFIG, build_transformers, read_json

_NAMES = {
    "tracker_model.": "",
    "tracker_neck.": "vision_encoder.neck.",
    "detector_model.vision_encoder.backbone.": "vision_encoder.backbone.",
}
_CERTAIN = 10.0
"""Logit of what is given."""


class Sam3Tracker(Sam3TrackerVideoModel):
    """The video network. transformers 5.23 resizes given masks and memorised masks otherwise than the authors.

    The authors' masks have sixteen times the side of the deepest features, 1152 px, which is not the side of the image,
    1008 px. A given mask is resized to it without a threshold, and its pointer is taken from the single mask. A mask is
    memorised as probabilities that are resized, not as resized logits.
    """

    session_class = Sam3TrackerVideoInferenceSession
    normalisation = SYMMETRIC

    def given_mask(self, mask: torch.Tensor) -> torch.Tensor:
        """Return a mask in 0..1, float (1, 1, y, x) at the frame's size, as a session takes it: as it is."""
        return mask

    def _use_mask_as_output(self, backbone_features, high_res_features, mask_inputs):
        embeddings = [*high_res_features, backbone_features]
        seen = _smooth(mask_inputs, self._mask_side)
        found = self._single_frame_forward(
            input_masks=self.mask_downsample(seen), image_embeddings=embeddings, multimask_output=False
        )
        found.pred_masks = _smooth(mask_inputs * 2 - 1, self._mask_side // 4) * _CERTAIN
        side = (self.image_size, self.image_size)
        found.high_res_masks = functional.interpolate(found.pred_masks, size=side, mode="bilinear")
        found.object_score_logits = torch.full_like(found.object_score_logits, _CERTAIN)
        return found

    def _encode_new_memory(self, current_vision_feats, pred_masks_high_res, object_score_logits, is_mask_from_pts):
        masks = (pred_masks_high_res > 0).float() if is_mask_from_pts else pred_masks_high_res.sigmoid()
        masks = masks * self.config.sigmoid_scale_for_mem_enc + self.config.sigmoid_bias_for_mem_enc
        height, width = self.backbone_feature_sizes[-1]
        features = current_vision_feats.permute(1, 2, 0).unflatten(2, (height, width))
        memory, places = self.memory_encoder(features, _smooth(masks, self._mask_side))
        is_hidden = (object_score_logits <= 0).float()[..., None]
        memory = memory + is_hidden * self.occlusion_spatial_embedding_parameter[..., None, None]
        # In half the size, as by the authors.
        memory = to_joinable(memory.to(torch.bfloat16))
        return tuple(part.flatten(2).permute(2, 0, 1) for part in (memory, places))

    @property
    def _mask_side(self) -> int:
        return 16 * self.backbone_feature_sizes[-1][0]


def build_sam3_tracker(checkpoint: Checkpoint) -> Sam3Tracker:
    """Build the video network of ``facebook/sam3``; the detector's own tensors are ignored.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Carion et al., "SAM 3: Segment Anything with Concepts", arXiv 2511.16719, 2025.
    """
    return build_transformers(Sam3Tracker, Sam3TrackerVideoConfig, _without_detector(checkpoint))


def _without_detector(checkpoint: Checkpoint) -> Checkpoint:
    """Return the tracker's part, with the image encoder that it shares, named as `Sam3Tracker` names its tensors."""
    tensors = {}
    for name, tensor in checkpoint.tensors.items():
        for published, ours in _NAMES.items():
            name = ours + name.removeprefix(published) if name.startswith(published) else name
        if not name.startswith("detector_model."):
            tensors[name] = tensor
    content = read_json(checkpoint, CONFIG).get("tracker_config")
    if not isinstance(content, dict):
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError("no configuration of a tracker", where=where, got=content, expected="tracker_config")
    return checkpoint._replace(tensors=tensors, documents={CONFIG: json.dumps(content)})


def _smooth(masks: torch.Tensor, side: int) -> torch.Tensor:
    """Resize masks (n, 1, y, x) to a square, smooth where they are reduced."""
    return functional.interpolate(masks.float(), size=(side, side), mode="bilinear", antialias=True)
