"""Tiny random RAM and RAM++ in the format of the official checkpoints."""

import io

import numpy as np
import torch

from moseg.tasks.networks.ram import Ram, RamConfig, RamPlus
from moseg.tasks.networks.swin import SwinConfig
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

TAGS = ("person", "car", "dog", "ball", "bicycle", "horse", "boat", "bird", "train", "cat", "bus", "chair")
# The logits lie within 0.98 of zero (see `_random_state`), the probabilities so within 0.27..0.73.
THRESHOLDS = (0.2, 0.2, 0.2, 0.2, *(0.5,) * 4, *(0.8,) * 4)
"""Four tags that always come out, four that depend on the frame, four that never do."""
_LOGIT_NORM = 0.2
# Tags that attend to all tokens alike would answer alike for every frame.
_ATTENTION, _SHARPNESS = ("query.weight", "key.weight"), 4
_CONFIG = RamConfig(
    image=SwinConfig(image_size=48, embed_dim=8, depths=(2, 2), num_heads=(2, 4), window_size=3, mlp_ratio=2),
    num_tags=len(TAGS),
    num_descriptions=3,
    embedding_width=16,
    width=24,
    num_heads=2,
    hidden=48,
)


def make_ram(seed: int) -> TinyCheckpoint:
    """Return RAM with 12 tags; as in the official file, the head has its old name and there is a captioner."""
    state = {
        name.replace("tagging_head.", "vision_multi."): value
        for name, value in _random_state(Ram(_CONFIG), seed).items()
    }
    captioner = {
        "tag_encoder.embeddings.LayerNorm.bias": torch.zeros(4),
        "text_decoder.cls.predictions.bias": torch.zeros(4),
    }
    return _pack(state | captioner)


def make_ram_plus(seed: int) -> TinyCheckpoint:
    """Return RAM++ with 12 tags of three descriptions each; as in the official file, without a similarity scale."""
    state = _random_state(RamPlus(_CONFIG), seed)
    del state["reweight_scale"]
    return _pack(state | {"logit_scale": torch.zeros(())})


def _random_state(network: Ram, seed: int) -> dict[str, torch.Tensor]:
    """Return seeded weights without biases, and the buffers that official checkpoints hold."""
    rng = np.random.default_rng(seed)
    state = {}
    for name, tensor in sorted(network.state_dict().items()):
        values = rng.standard_normal(tuple(tensor.shape))
        if name.endswith("bias"):
            values = np.zeros_like(values)
        elif "norm" in name.lower():
            values = np.ones_like(values)
        elif name == "fc.weight":
            # Bounds the logits: what it weighs comes from a layer norm without gain, so has the norm sqrt(width).
            values *= _LOGIT_NORM / np.linalg.norm(values)
        elif values.ndim > 1 and name != "label_embed":
            values *= (_SHARPNESS if name.endswith(_ATTENTION) else 1) / np.sqrt(values[0].size)
        state[name] = torch.from_numpy(np.asarray(values, np.float32))
    for name, buffer in network.named_buffers():
        official = name.replace("attn.positions", "attn.relative_position_index").replace("sight", "attn_mask")
        state[official] = buffer if buffer.dtype == torch.int64 else torch.where(buffer.squeeze(1), 0.0, -100.0)
    return state


def _pack(state: dict[str, torch.Tensor]) -> TinyCheckpoint:
    content = io.BytesIO()
    torch.save({"model": state, "epoch": 0}, content)
    files = {
        "model.pth": content.getvalue(),
        "tags.txt": "\n".join(TAGS).encode(),
        "thresholds.txt": "".join(f"{threshold}\n" for threshold in THRESHOLDS).encode(),
    }
    return TinyCheckpoint(files, _CONFIG.model_dump(mode="json"))
