import hashlib

import pytest
import torch
from transformers import SamHQConfig, SamHQModel

from moseg.schemas.errors import InputError
from moseg.tasks.networks.sam_hq import build_sam_hq, decode_boxes, encode_image

BOXES = torch.tensor([[10.0, 20, 60, 90], [40, 5, 120, 100]])
# Every 21st logit of both masks, and the quality, by the authors' code with the same weights; by the high-quality token
# alone and by both.
GOLDEN = {
    False: """
        0.78125 -1.34763 -0.57506 0.96292 0.64953 1.03355 -0.74796 -0.39291
        0.82402 1.4777 1.2523 0.38163 1.09937 2.37016 0.3004 1.6434
        0.97327 -1.62478 -0.64581 0.89442 0.48538 1.22398 -1.10008 -0.21514
        0.69942 1.60392 0.78297 0.4582 1.42131 2.43388 0.44636 1.40063""",
    True: """
        0.92675 -1.35809 -0.72145 0.49064 0.77411 0.74067 -0.69653 -0.30222
        0.52575 1.3468 0.97309 0.2998 0.95059 1.78356 0.46107 0.86818
        1.18255 -1.59682 -0.775 0.50103 0.59022 0.97542 -0.79923 -0.11738
        0.71199 1.60278 0.63335 0.41169 1.13343 2.20155 0.3978 1.09431""",
}
QUALITY = [-0.21069, -0.25197]
# syscv-community/sam-hq-vit-base.
DIGEST = "4a395e54fe8d7811"


def test_names_and_shapes_are_the_published_ones():
    with torch.device("meta"):
        model = SamHQModel(SamHQConfig())
    state = model.state_dict()
    listed = "\n".join(sorted(f"{name} {tuple(value.shape)}" for name, value in state.items()))
    assert len(state) == 340
    # In single precision they fill the 379 MB of the published file.
    assert sum(value.numel() for value in model.parameters()) == 94_806_832
    assert hashlib.sha256(listed.encode()).hexdigest()[:16] == DIGEST


def test_a_left_over_tensor_is_named(sam_hq_checkpoint):
    tensors = {**sam_hq_checkpoint.tensors, "mask_decoder.extra": torch.zeros(1)}
    with pytest.raises(InputError, match=r"not the network's in weights tiny; got mask_decoder\.extra"):
        build_sam_hq(sam_hq_checkpoint._replace(tensors=tensors))


@pytest.mark.parametrize("hq_token_only", [False, True])
@torch.inference_mode()
def test_masks_are_those_of_the_authors_code(sam_hq_checkpoint, with_unit_gain, hq_token_only):
    model = build_sam_hq(with_unit_gain(sam_hq_checkpoint))
    pixels = torch.randn(1, 3, 128, 128, generator=torch.Generator().manual_seed(0))
    logits, quality = decode_boxes(model, encode_image(model, pixels), BOXES, hq_token_only)
    wanted = torch.tensor([float(word) for word in GOLDEN[hq_token_only].split()]).view(2, 4, 4)
    # Layer norms add 1e-6 to a variance here and 1e-5 there.
    torch.testing.assert_close(logits[:, ::21, ::21], wanted, atol=5e-4, rtol=0)
    torch.testing.assert_close(quality, torch.tensor(QUALITY), atol=1e-4, rtol=0)


@torch.inference_mode()
def test_a_box_has_the_same_mask_alone_and_among_others(sam_hq):
    features = encode_image(sam_hq, torch.randn(1, 3, 128, 128, generator=torch.Generator().manual_seed(0)))
    together, _ = decode_boxes(sam_hq, features, BOXES, False)
    alone, _ = decode_boxes(sam_hq, features, BOXES[1:], False)
    torch.testing.assert_close(together[1:], alone)
