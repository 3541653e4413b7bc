"""All-pairs correlation of two feature maps, as a pyramid that is sampled around the current flow."""

import torch
import torch.nn.functional as F
from torch import Tensor

_MAX_BLOCK = 2**24
"""Correlations stored at a time on demand: 64 MB in float32."""


class CorrelationPyramid:
    """Correlation of every cell of the first frame with every cell of the second, at each level of detail.

    Correlations with averaged features are the averages of correlations. So each level is one product with the pooled
    second map, which can be computed again at each look-up, block by block, instead of being stored.

    Parameters
    ----------
    features0, features1 : Tensor (B, channels, h, w)
        Feature maps; half precision is correlated in float32, because sums over 256 channels exceed the digits and the
        range of half precision.
    levels : int
        Levels; each halves the resolution of the second frame only. The coarsest must have a cell.
    radius : int
        Half side of a look-up window, in the cells of its level.
    on_demand : bool
        Store no volume: its 1.33 (B, h w, h w) numbers are computed again at each look-up.

    References
    ----------
    Teed, Deng, ECCV 2020, section 3.2.
    """

    def __init__(self, features0: Tensor, features1: Tensor, levels: int, radius: int, on_demand: bool = False):
        self.radius = radius
        dtype = torch.promote_types(features0.dtype, torch.float32)
        self._queries = features0.to(dtype).flatten(2).transpose(1, 2) / features0.shape[1] ** 0.5
        self._pooled = [features1.to(dtype)]
        for _ in range(levels - 1):
            self._pooled.append(F.avg_pool2d(self._pooled[-1], 2))
        self._volumes = None if on_demand else [self._correlate(self._queries, pooled) for pooled in self._pooled]

    def look_up(self, positions: Tensor) -> Tensor:
        """Return the correlations in the window around a position in the second frame, for each cell of the first.

        Parameters
        ----------
        positions : Tensor (B, 2, h, w)
            xy, cells of the finest level.

        Returns
        -------
        Tensor (B, levels (2 radius + 1)^2, h, w)
            Interpolated bilinearly; zero outside the second frame. x is the slower index of a window.
        """
        centres = positions.flatten(2).transpose(1, 2)
        windows = [self._windows(level, centres / 2**level) for level in range(len(self._pooled))]
        return torch.cat(windows, dim=-1).transpose(1, 2).unflatten(2, positions.shape[2:])

    def _windows(self, level: int, centres: Tensor) -> Tensor:
        pooled = self._pooled[level]
        if self._volumes is not None:
            return _read_windows(self._volumes[level], pooled.shape[2:], centres, self.radius)
        rows = max(_MAX_BLOCK // (len(pooled) * pooled[0, 0].numel()), 1)
        blocks = zip(self._queries.split(rows, dim=1), centres.split(rows, dim=1), strict=True)
        return torch.cat(
            [_read_windows(self._correlate(own, pooled), pooled.shape[2:], at, self.radius) for own, at in blocks],
            dim=1,
        )

    @staticmethod
    def _correlate(queries: Tensor, pooled: Tensor) -> Tensor:
        # Autocast would take the product back to half precision.
        with torch.autocast(queries.device.type, enabled=False):
            return torch.matmul(queries, pooled.flatten(2))


def _read_windows(volume: Tensor, shape: tuple[int, int], centres: Tensor, radius: int) -> Tensor:
    """Return windows (B, N, (2 radius + 1)^2) of correlations (B, N, h w) about xy centres (B, N, 2).

    All points of a window share their fractions of a cell, so the cells under it are gathered once.
    """
    height, width = shape
    corners = centres.floor()
    offsets = torch.arange(-radius, radius + 2, device=centres.device)
    x, y = (corners[..., [axis]] + offsets for axis in range(2))
    is_inside = ((x >= 0) & (x < width)).unsqueeze(-1) & ((y >= 0) & (y < height)).unsqueeze(-2)
    # Clamped as integers, so that even infinite positions index a cell, which is masked out.
    index = y.long().clamp(0, height - 1).unsqueeze(-2) * width + x.long().clamp(0, width - 1).unsqueeze(-1)
    cells = volume.gather(-1, index.flatten(-2)).view(index.shape).masked_fill(~is_inside, 0)
    fraction_x, fraction_y = (centres - corners)[..., None, None].unbind(-3)
    cells = torch.lerp(cells[..., :-1, :], cells[..., 1:, :], fraction_x)
    return torch.lerp(cells[..., :-1], cells[..., 1:], fraction_y).flatten(-2)
