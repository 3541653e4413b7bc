import torch
from torch import nn

from moseg.tasks.networks.depth.positions import resample_as_trained

SIDE, PATCH = 37, 14


class Embeddings(nn.Module):
    """Positions that tell the column of their cell, and a token that tells -1."""

    def __init__(self):
        super().__init__()
        columns = torch.arange(SIDE, dtype=torch.float32).expand(SIDE, SIDE).reshape(1, -1, 1)
        self.position_embeddings = torch.cat([torch.full((1, 1, 1), -1.0), columns], dim=1)
        self.patch_size = PATCH


class Model(nn.Module):
    def __init__(self):
        super().__init__()
        self.backbone = nn.Module()
        self.backbone.embeddings = Embeddings()


def _columns(height, width):
    embeddings = resample_as_trained(Model()).backbone.embeddings
    found = embeddings.interpolate_pos_encoding(None, height * PATCH, width * PATCH)
    assert found.shape == (1, 1 + height * width, 1) and found[0, 0, 0] == -1
    return found[0, 1:, 0].view(height, width)


def test_on_the_published_grid_positions_are_the_trained_ones():
    assert torch.equal(_columns(SIDE, SIDE), torch.arange(SIDE, dtype=torch.float32).expand(SIDE, SIDE))


def test_positions_of_other_grids_follow_the_authors_factor():
    width = 61
    columns = torch.arange(width) + 0.5
    # Bicubic resampling waves around a ramp and bends at its ends: a mean over the middle tells the factor.
    middle = slice(10, -10)
    found = _columns(20, width)[10, middle].mean()
    trained, by_size = (((columns * SIDE / cells) - 0.5)[middle].mean() for cells in (width + 0.1, width))
    assert abs(found - trained) < 0.005 < 0.02 < abs(found - by_size)
