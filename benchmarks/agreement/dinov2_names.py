"""Names that DINOv2's authors give to the tensors of a backbone by transformers."""

import re

import torch

NAMES = (
    (r"^embeddings\.cls_token", "cls_token"),
    (r"^embeddings\.mask_token", "mask_token"),
    (r"^embeddings\.position_embeddings", "pos_embed"),
    (r"^embeddings\.patch_embeddings\.projection", "patch_embed.proj"),
    (r"^encoder\.layer\.", "blocks."),
    (r"attention\.o_proj", "attn.proj"),
    (r"layer_scale(\d)\.lambda1", r"ls\1.gamma"),
    (r"^layernorm", "norm"),
)


def official_backbone(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return the tensors of ``backbone.*``, with the queries, keys and values of a layer concatenated."""
    tensors, parts = {}, {}
    for name, value in state.items():
        if not name.startswith("backbone."):
            continue
        name = name.removeprefix("backbone.")
        for pattern, replacement in NAMES:
            name = re.sub(pattern, replacement, name)
        found = re.fullmatch(r"(blocks\.\d+\.)attention\.([qkv])_proj\.(weight|bias)", name)
        if found:
            parts.setdefault(f"{found[1]}attn.qkv.{found[3]}", {})[found[2]] = value
        else:
            tensors[name] = value
    return tensors | {name: torch.cat([part[kind] for kind in "qkv"]) for name, part in parts.items()}


def random_state(model: torch.nn.Module) -> dict[str, torch.Tensor]:
    """Return nonzero weights that keep signal sizes from layer to layer, and smooth positions, like trained ones."""
    state = model.state_dict()
    for name, value in state.items():
        noise = torch.randn(value.shape)
        if name.endswith("position_embeddings"):
            cells = torch.randn(1, value.shape[2], 8, 8)
            side = round((value.shape[1] - 1) ** 0.5)
            smooth = torch.nn.functional.interpolate(cells, (side, side), mode="bicubic").flatten(2).transpose(1, 2)
            state[name] = torch.cat([noise[:, :1], smooth], dim=1)
        elif "norm" in name or "layer_scale" in name:
            state[name] = 0.1 * noise + (not name.endswith("bias")) * (0.3 if "scale" in name else 1.0)
        elif value.ndim > 1:
            # Transposed convolutions keep their input channels first; without an overlap each output has one cell.
            fan_in = len(value) if re.search(r"layers\.[01]\.resize", name) else value[0].numel()
            state[name] = noise * fan_in**-0.5
        else:
            state[name] = 0.1 * noise
    return state
