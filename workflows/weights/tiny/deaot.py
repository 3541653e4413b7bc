"""A tiny DeAOT whose masks stay roughly where they were."""

import io

import numpy as np
import torch

from moseg.tasks.networks.deaot import Deaot, DeaotConfig
from moseg.tasks.networks.deaot.decoder import NORM_GROUPS
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

CONFIG = DeaotConfig(
    stem_width=8,
    stage_widths=(4, 8, 16),
    stage_depths=(1, 1, 1),
    d_model=32,
    num_layers=2,
    max_objects=5,
    window_radius=3,
)
# Deviation of what is random beside the path of the masks, as a share of what would keep a signal's variance.
_NOISE = 0.1
# Logit by which the same place outweighs any other place of the window.
_STAY = 6.0
# Middle of a cell, of which a class's share is taken: masks enlarged from cells to pixels give the same shares again.
_CORE = slice(4, 13)
# Weight of an object's share against the background's, so that small objects last.
_HOLD = 1.5
# Level at which signals pass the decoder's rectifiers unchanged.
_LEVEL = 4.0


def make_deaot(seed: int) -> TinyCheckpoint:
    """Return random weights in the official format, with one path that carries the masks of the frame before.

    On this path, each class (background, object 1, …) has its own channel, from the share of a cell that it covers to
    its logit: identity bank, memory, short-term attention to the same place, decoder. Everything else is small noise.
    """
    rng = np.random.default_rng(seed)
    state = {}
    for name, tensor in Deaot(CONFIG).state_dict().items():
        values = np.zeros(tensor.shape)
        if name.endswith("running_var") or (tensor.ndim == 1 and name.endswith("weight")):
            values += 1
        elif tensor.ndim > 1:
            share = 1.0 if name.startswith("encoder") else _NOISE
            values = rng.normal(0, share * np.prod(tensor.shape[1:]) ** -0.5, tensor.shape)
        state[name] = values
    _carry_masks(state)
    content = io.BytesIO()
    tensors = {name: torch.from_numpy(values.astype(np.float32)) for name, values in state.items()}
    torch.save({"state_dict": tensors}, content)
    return TinyCheckpoint({"model.pth": content.getvalue()}, CONFIG.model_dump(mode="json"))


def _carry_masks(state: dict[str, np.ndarray]) -> None:
    """Set the weights on the path of the masks; on all of it, the class with the largest signal stays the same."""
    d_model, num_objects = CONFIG.d_model, CONFIG.max_objects
    classes, objects = np.arange(1 + num_objects), np.arange(num_objects)

    bank = state["patch_wise_id_bank.weight"]
    bank[:] = 0
    bank[classes, classes, _CORE, _CORE] = 1 / bank[0, 0, _CORE, _CORE].size
    layer = "LSTT.layers.0."
    state[layer + "linear_ID_V.weight"][classes, classes] = 1
    state[layer + "short_term_attn.relative_emb_k.bias"][(2 * CONFIG.window_radius + 1) ** 2 // 2] = _STAY
    # Attention gathers the visual values, then the identities, 2 d_model channels each.
    gathered = 2 * d_model + classes
    smoothing = state[layer + "short_term_attn.dw_conv.conv.weight"]
    smoothing[gathered] = 0
    smoothing[gathered, 0, 2, 2] = 1
    state[layer + "short_term_attn.projection.weight"][d_model + classes, gathered] = 1

    # A normalisation shifts and scales the channels of a group alike, so each object has a group of its own with a copy
    # of the background; what is random falls on both alike.
    background, own = d_model + 0 * objects, d_model + 1 + objects
    hold = _HOLD
    for name, width in (("in", d_model), ("16x", d_model), ("8x", d_model // 2), ("4x", d_model // 2)):
        weight = state[f"decoder.conv_{name}.conv.weight"]
        centre = weight.shape[-1] // 2
        group = objects * (width // NORM_GROUPS)
        weight[group + 1] = weight[group]
        weight[group, background, centre, centre] = 1
        weight[group + 1, own, centre, centre] = hold
        state[f"decoder.conv_{name}.gn.bias"][:] = _LEVEL
        background, own, hold = group, group + 1, 1
        adapter = state.get(f"decoder.adapter_{name}.weight")
        if adapter is not None:
            adapter[group + 1] = adapter[group]
    state["decoder.conv_out.weight"][1 + objects, own] = 4
    state["decoder.conv_out.weight"][1 + objects, background] = -4
