"""A tiny PIPs checkpoint."""

from io import BytesIO

import torch

from moseg.tasks.networks.pips import Pips, PipsConfig
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

CONFIG = {"latent": 16, "widths": [8, 8, 8, 8], "encoding": 8, "hidden": 16, "depth": 1}
UPDATE_SCALE = 0.02
"""Factor of the layer that moves points: a random network then moves them by some tenths of a pixel."""
VISIBLE_LOGIT = 4.0


def make_pips(seed: int) -> TinyCheckpoint:
    """Return a random network whose points stay near their start and visible, so that later stages have data."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        network = Pips(PipsConfig(**CONFIG))
    with torch.no_grad():
        for tensor in network.delta_block.to_delta[-1].parameters():
            tensor.mul_(UPDATE_SCALE)
        network.vis_predictor[0].bias.fill_(VISIBLE_LOGIT)
    content = BytesIO()
    torch.save({"model_state_dict": network.state_dict()}, content)
    return TinyCheckpoint({"model.pth": content.getvalue()}, CONFIG)
