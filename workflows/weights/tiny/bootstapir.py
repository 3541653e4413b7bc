"""A tiny BootsTAPIR checkpoint."""

from io import BytesIO

import torch

from moseg.tasks.networks.bootstapir import BootsTapir, BootsTapirConfig
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

CONFIG = {"widths": [8, 8, 16, 32], "extra_blocks": 1, "extra_expansion": 1, "hidden": 16, "depth": 1}
UPDATE_SCALE = 0.02
"""Factor of the layer that moves points: a random network then moves them by some tenths of a pixel."""
MATCHING_SCALE = 3.0
"""Factor of the similarity in the heat map: the places that are most similar then outweigh all others."""
HIDDEN_LOGIT = -4.0


def make_bootstapir(seed: int) -> TinyCheckpoint:
    """Return a random network that finds points where they look most alike, so that later stages have data."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        network = BootsTapir(BootsTapirConfig(**CONFIG))
    with torch.no_grad():
        for tensor in network.torch_pips_mixer.linear_1.parameters():
            tensor.mul_(UPDATE_SCALE)
        # Means instead of random patterns: maps that are smooth change little where a frame moves by a part of a cell.
        for layer in network.resnet_torch.modules():
            if isinstance(layer, torch.nn.Conv2d):
                layer.weight.copy_(layer.weight.mean(dim=(2, 3), keepdim=True).expand_as(layer.weight))
        matching = network.torch_cost_volume_track_mods
        # The first hidden map is the similarity itself, and the heat map is a multiple of it.
        for layer, factor in ((matching["hid1"], 1.0), (matching["hid2"], MATCHING_SCALE)):
            layer.weight[0] = 0
            layer.weight[0, 0, 1, 1] = factor
            layer.bias[0] = 0
        matching["occ_out"].bias.fill_(HIDDEN_LOGIT)
    content = BytesIO()
    torch.save(network.state_dict(), content)
    return TinyCheckpoint({"model.pth": content.getvalue()}, CONFIG)
