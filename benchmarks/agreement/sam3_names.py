"""Names that SAM 3's authors give to the tensors of the networks by transformers."""

import re

import sam2_family
import torch

# Names of transformers to the authors', applied one after the other.
DETECTOR = (
    (r"^vision_encoder\.backbone\.", "backbone.vision_backbone.trunk."),
    (r"^vision_encoder\.neck\.fpn_layers\.", "backbone.vision_backbone.convs."),
    (r"embeddings\.position_embeddings", "pos_embed"),
    (r"embeddings\.patch_embeddings\.projection", "patch_embed.proj"),
    (r"trunk\.layer_norm", "trunk.ln_pre"),
    (r"trunk\.layers\.", "trunk.blocks."),
    (r"(blocks\.\d+\.)layer_norm", r"\1norm"),
    (r"(blocks\.\d+\.)attention\.o_proj", r"\1attn.proj"),
    (r"(blocks\.\d+\.)attention\.", r"\1attn."),
    (r"convs\.0\.scale_layers\.0", "convs.0.dconv_2x2_0"),
    (r"convs\.0\.scale_layers\.2", "convs.0.dconv_2x2_1"),
    (r"convs\.1\.scale_layers\.0", "convs.1.dconv_2x2"),
    (r"(convs\.\d\.)proj1", r"\1conv_1x1"),
    (r"(convs\.\d\.)proj2", r"\1conv_3x3"),
    (r"^text_encoder\.(text_model\.)?", "backbone.language_backbone.encoder."),
    (r"embeddings\.token_embedding", "token_embedding"),
    (r"embeddings\.position_embedding\.weight", "positional_embedding"),
    (r"final_layer_norm", "ln_final"),
    (r"encoder\.encoder\.layers\.", "encoder.transformer.resblocks."),
    (r"(resblocks\.\d+\.)layer_norm", r"\1ln_"),
    (r"(resblocks\.\d+\.)self_attn", r"\1attn"),
    (r"(resblocks\.\d+\.)mlp\.fc1", r"\1mlp.c_fc"),
    (r"(resblocks\.\d+\.)mlp\.fc2", r"\1mlp.c_proj"),
    (r"^text_projection\.", "backbone.language_backbone.resizer."),
    (r"^geometry_encoder\.layers\.", "geometry_encoder.encode."),
    (r"vision_layer_norm", "img_pre_norm"),
    (r"prompt_layer_norm", "norm"),
    (r"^geometry_encoder\.output_layer_norm", "geometry_encoder.encode_norm"),
    (r"^detr_encoder\.", "transformer.encoder."),
    (r"((?:encode|encoder\.layers)\.\d+\.)cross_attn", r"\1cross_attn_image"),
    (r"((?:encode|encoder\.layers)\.\d+\.)layer_norm", r"\1norm"),
    (r"^detr_decoder\.", "transformer.decoder."),
    (r"decoder\.output_layer_norm", "decoder.norm"),
    (r"presence_layer_norm", "presence_token_out_norm"),
    (r"presence_head", "presence_token_head"),
    (r"box_head", "bbox_embed"),
    (r"box_rpb_embed", "boxRPB_embed"),
    (r"(decoder\.layers\.\d+\.)vision_cross_attn_layer_norm", r"\1norm1"),
    (r"(decoder\.layers\.\d+\.)text_cross_attn_layer_norm", r"\1catext_norm"),
    (r"(decoder\.layers\.\d+\.)self_attn_layer_norm", r"\1norm2"),
    (r"(decoder\.layers\.\d+\.)mlp_layer_norm", r"\1norm3"),
    (r"(decoder\.layers\.\d+\.)vision_cross_attn", r"\1cross_attn"),
    (r"(decoder\.layers\.\d+\.)text_cross_attn", r"\1ca_text"),
    (r"((?:encode|layers)\.\d+\.)mlp\.fc", r"\1linear"),
    (r"^dot_product_scoring\.text_mlp_out_norm", "dot_prod_scoring.prompt_mlp.out_norm"),
    (r"^dot_product_scoring\.text_mlp", "dot_prod_scoring.prompt_mlp"),
    (r"^dot_product_scoring\.text_proj", "dot_prod_scoring.prompt_proj"),
    (r"^dot_product_scoring\.query_proj", "dot_prod_scoring.hs_proj"),
    (r"^mask_decoder\.mask_embedder", "segmentation_head.mask_predictor.mask_embed"),
    (r"^mask_decoder\.instance_projection", "segmentation_head.instance_seg_head"),
    (r"^mask_decoder\.semantic_projection", "segmentation_head.semantic_seg_head"),
    (r"^mask_decoder\.prompt_cross_attn_norm", "segmentation_head.cross_attn_norm"),
    (r"^mask_decoder\.prompt_cross_attn", "segmentation_head.cross_attend_prompt"),
    (r"^mask_decoder\.", "segmentation_head."),
    (r"\.layer(\d)\.", lambda found: f".layers.{int(found[1]) - 1}."),
    (r"\.o_proj\.", ".out_proj."),
)
# Names of SAM 2's authors to those of SAM 3.
TRACKER = (
    (r"^memory_attention\.", "transformer.encoder."),
    (r"^memory_encoder\.", "maskmem_backbone."),
    (r"(mask_decoder\.transformer\.layers\.\d\.mlp\.)layers\.0", r"\1lin1"),
    (r"(mask_decoder\.transformer\.layers\.\d\.mlp\.)layers\.1", r"\1lin2"),
)


def official_detector(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return the detector's tensors under the authors' names; attention has one matrix there for its three inputs."""
    tensors = {_renamed(name, DETECTOR): value for name, value in state.items()}
    for name in [name for name in tensors if ".q_proj." in name]:
        parts = [tensors.pop(name.replace(".q_proj.", f".{part}_proj.")) for part in "qkv"]
        stem, kind = name.split(".q_proj.")
        joined = f"{stem}.qkv.{kind}" if "trunk" in name else f"{stem}.in_proj_{kind}"
        tensors[joined] = torch.cat(parts)
    # Theirs also has a place for a token that they drop.
    name = "backbone.vision_backbone.trunk.pos_embed"
    tensors[name] = torch.cat([torch.zeros_like(tensors[name][:, :1]), tensors[name]], dim=1)
    del tensors["backbone.language_backbone.encoder.text_projection.weight"]
    return tensors


def official_tracker(
    tracker: dict[str, torch.Tensor], neck: dict[str, torch.Tensor], detector: dict[str, torch.Tensor]
) -> dict[str, torch.Tensor]:
    """Return the tensors of the tracker and its neck under the authors' names, with the detector's image encoder."""
    tensors = {_renamed(name, TRACKER): value for name, value in sam2_family.official_names(tracker).items()}
    tensors |= {name: value for name, value in detector.items() if ".vision_backbone." in name}
    for name, value in neck.items():
        name = _renamed(f"vision_encoder.neck.{name}", DETECTOR)
        tensors[name.replace(".convs.", ".sam2_convs.")] = value
    return tensors


def _renamed(name: str, names) -> str:
    for pattern, replacement in names:
        name = re.sub(pattern, replacement, name)
    return name
