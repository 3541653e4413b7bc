"""Matching: the first estimate of a point in every frame, each for itself, from the similarity to all places."""

import torch
import torch.nn.functional as F
from torch import nn

TEMPERATURE = 20.0
"""Factor of the heat map before its softmax, as published."""
REACH = 5.0
"""Places nearer to the best one than this are averaged, cells, as published."""


class Matching(nn.ModuleDict):
    """Layers that read a position, an occlusion and an uncertainty from the similarities of a point to a frame.

    Names and sizes are those of the published state dict.
    """

    def __init__(self):
        super().__init__(
            {
                "hid1": nn.Conv2d(1, 16, 3, padding=1),
                "hid2": nn.Conv2d(16, 1, 3, padding=1),
                "hid3": nn.Conv2d(16, 32, 3, stride=2),
                "hid4": nn.Linear(32, 16),
                "occ_out": nn.Linear(16, 2),
            }
        )

    def forward(self, appearances: torch.Tensor, maps: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Search points in all frames.

        Parameters
        ----------
        appearances : torch.Tensor (N, C)
        maps : torch.Tensor (S, y, x, C)

        Returns
        -------
        positions : torch.Tensor (N, S, 2)
            xy, as a share of the frame's width and height, from its upper left edge.
        occlusion, uncertainty : torch.Tensor (N, S)
            Logits.
        """
        num_frames, height, width, _ = maps.shape
        # Half precision keeps three digits of a similarity: too few to locate its peak.
        with torch.autocast(maps.device.type, enabled=False):
            similarity = torch.einsum("nc,syxc->nsyx", appearances, maps)
            hidden = self["hid1"](similarity.reshape(-1, 1, height, width)).relu()
            positions = soft_argmax(self["hid2"](hidden)[:, 0])
            # Padded at the lower right only, like strided convolutions of JAX.
            hidden = self["hid3"](F.pad(hidden, (0, 2, 0, 2))).relu().mean(dim=(2, 3))
            logits = self["occ_out"](self["hid4"](hidden).relu())
        occlusion, uncertainty = logits.view(-1, num_frames, 2).unbind(-1)
        return positions.view(-1, num_frames, 2), occlusion, uncertainty


def soft_argmax(heat: torch.Tensor) -> torch.Tensor:
    """Return the mean position around the maximum of each map (B, y, x): (B, 2), xy as a share of width and height."""
    height, width = heat.shape[-2:]
    weight = (heat.flatten(1) * TEMPERATURE).softmax(dim=1).view_as(heat)
    best = weight.flatten(1).argmax(dim=1)
    x, y = (torch.arange(side, device=heat.device, dtype=heat.dtype) + 0.5 for side in (width, height))
    dx = x - x[best % width][:, None]
    dy = y - y[best // width][:, None]
    weight = weight * (dx[:, None] ** 2 + dy[:, :, None] ** 2 < REACH**2)
    total = weight.sum(dim=(1, 2)).clamp(min=1e-12)
    mean_x = (weight.sum(dim=1) @ x) / total
    mean_y = (weight.sum(dim=2) @ y) / total
    return torch.stack([mean_x / width, mean_y / height], dim=1)
