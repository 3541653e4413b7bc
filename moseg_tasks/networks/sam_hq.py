"""SAM-HQ: masks of high quality from an image and boxes.

The ``forward`` of transformers' mask decoder (read in 5.23) drops the image features of its two-way transformer and
uses the encoder's features with rows and columns exchanged, so that its masks hardly depend on the boxes. Here its
modules are run as in the paper and the authors' code; ``benchmarks/agreement/sam_hq.py`` compares.
"""

from typing import NamedTuple

import torch
from torch.nn import functional
from transformers import SamHQConfig, SamHQModel

from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.transformers_model import build_transformers


def build_sam_hq(checkpoint: Checkpoint) -> SamHQModel:
    """Build the network of ``syscv-community/sam-hq-vit-base``, ``-large`` and ``-huge``.

    It is run by `encode_image` and `decode_boxes`, not by its own ``forward``.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Ke et al., "Segment Anything in High Quality", NeurIPS 2023.
    """
    return build_transformers(SamHQModel, SamHQConfig, checkpoint)


class ImageFeatures(NamedTuple):
    """Features that are computed once for an image.

    Attributes
    ----------
    embedding : torch.Tensor
        float32 (1, channel, y, x), of the last layer.
    detail : torch.Tensor
        float32 (1, channel, 4 y, 4 x), of the last layer and of an early one, which has sharp edges.
    """

    embedding: torch.Tensor
    detail: torch.Tensor


def encode_image(model: SamHQModel, pixels: torch.Tensor) -> ImageFeatures:
    """Compute the features of an image.

    Under autocast only the vision transformer runs in half precision.

    Parameters
    ----------
    model : SamHQModel
    pixels : torch.Tensor
        float32 (1, 3, side, side), normalised and padded.
    """
    decoder = model.mask_decoder
    embedding, layers = model.get_image_embeddings(pixels)
    with torch.autocast(pixels.device.type, enabled=False):
        embedding = embedding.to(model.dtype)
        # The first of the layers with global attention.
        early = layers[0].to(model.dtype).permute(0, 3, 1, 2)
        late = functional.gelu(decoder.encoder_norm(decoder.encoder_conv1(embedding)))
        early = functional.gelu(decoder.compress_vit_norm(decoder.compress_vit_conv1(early)))
        return ImageFeatures(embedding, decoder.encoder_conv2(late) + decoder.compress_vit_conv2(early))


def decode_boxes(
    model: SamHQModel, features: ImageFeatures, boxes: torch.Tensor, hq_token_only: bool
) -> tuple[torch.Tensor, torch.Tensor]:
    """Decode one mask for each box.

    Parameters
    ----------
    model : SamHQModel
    features : ImageFeatures
    boxes : torch.Tensor
        float32 (n, 4), left, top, right, bottom in the encoded image, px.
    hq_token_only : bool
        The high-quality token's mask alone; else it is added to that of SAM's token for a single mask.

    Returns
    -------
    logits : torch.Tensor
        float32 (n, 4 y, 4 x), over 0 inside.
    quality : torch.Tensor
        float32 (n,), the network's estimate of the IoU of SAM's mask with the true one.
    """
    decoder = model.mask_decoder
    num_boxes = len(boxes)
    # Sines of large angles and sums over thousands of pixels lose too much in half precision.
    with torch.autocast(boxes.device.type, enabled=False):
        corners, dense = model.prompt_encoder(
            input_points=None, input_labels=None, input_boxes=boxes[None], input_masks=None
        )
        asking = torch.cat([decoder.iou_token.weight, decoder.mask_tokens.weight, decoder.hq_token.weight])
        tokens = torch.cat([asking.expand(num_boxes, -1, -1), corners[0]], dim=1)[:, None]
        places = model.get_image_wide_positional_embeddings()
        tokens, pixels = decoder.transformer(
            point_embeddings=tokens,
            image_embeddings=(features.embedding + dense).expand(num_boxes, -1, -1, -1),
            image_positional_embeddings=places.expand(num_boxes, -1, -1, -1),
            attention_similarity=None,
        )
        tokens, pixels = tokens[:, 0], pixels[:, 0].transpose(1, 2).unflatten(2, features.embedding.shape[2:])

        coarse = functional.gelu(decoder.upscale_layer_norm(decoder.upscale_conv1(pixels)))
        coarse = functional.gelu(decoder.upscale_conv2(coarse))
        fine = functional.gelu(decoder.mask_norm(decoder.mask_conv1(coarse)))
        fine = decoder.mask_conv2(fine) + features.detail
        quality_token, single_token, hq_token = tokens[:, 0], tokens[:, 1], tokens[:, len(asking) - 1]
        logits = torch.einsum("nc,ncyx->nyx", decoder.hq_mask_mlp(hq_token), fine)
        if not hq_token_only:
            single = decoder.output_hypernetworks_mlps[0](single_token)
            logits = logits + torch.einsum("nc,ncyx->nyx", single, coarse)
        return logits, decoder.iou_prediction_head(quality_token)[:, 0]
