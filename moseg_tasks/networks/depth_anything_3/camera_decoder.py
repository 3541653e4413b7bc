"""Depth Anything 3's decoder of cameras, with the tensor names of the published checkpoints."""

import torch
from torch import Tensor, nn


class CameraDecoder(nn.Module):
    """Centre, rotation and field of view of a camera from its token."""

    def __init__(self, channels: int):
        super().__init__()
        self.backbone = nn.Sequential(
            nn.Linear(channels, channels), nn.ReLU(), nn.Linear(channels, channels), nn.ReLU()
        )
        self.fc_t = nn.Linear(channels, 3)
        self.fc_qvec = nn.Linear(channels, 4)
        self.fc_fov = nn.Sequential(nn.Linear(channels, 2), nn.ReLU())

    def forward(self, tokens: Tensor) -> Tensor:
        """Return cameras (S, 9), as `Views` describes them, of tokens (S, channels)."""
        tokens = self.backbone(tokens)
        return torch.cat([self.fc_t(tokens), self.fc_qvec(tokens), self.fc_fov(tokens)], dim=1)
