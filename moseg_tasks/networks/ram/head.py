"""The tagging head, in which tags attend to the image's tokens."""

import torch
from torch import nn
from torch.nn import functional

from moseg.tasks.networks.ram.config import RamConfig

# Of BERT, from which the head's layers are taken.
_NORM_EPS = 1e-12


class _Residual(nn.Module):
    """Linear layer, sum with the shortcut, norm."""

    def __init__(self, inner: int, width: int):
        super().__init__()
        self.dense = nn.Linear(inner, width)
        self.LayerNorm = nn.LayerNorm(width, eps=_NORM_EPS)

    def forward(self, inner: torch.Tensor, added: torch.Tensor) -> torch.Tensor:
        return self.LayerNorm(self.dense(inner) + added)


class CrossAttention(nn.Module):
    """Multi-head attention of the tags to the image's tokens."""

    def __init__(self, width: int, token_width: int, num_heads: int):
        super().__init__()
        self.num_heads = num_heads
        projections = {"query": width, "key": token_width, "value": token_width}
        self.self = nn.ModuleDict({name: nn.Linear(channels, width) for name, channels in projections.items()})
        self.output = _Residual(width, width)

    def forward(self, tags: torch.Tensor, tokens: torch.Tensor) -> torch.Tensor:
        """Map (B, n, C) tags and (B, m, D) tokens to (B, n, C)."""
        query, key, value = (
            projection(source).unflatten(-1, (self.num_heads, -1)).transpose(1, 2)
            for projection, source in zip(self.self.values(), (tags, tokens, tokens), strict=True)
        )
        seen = functional.scaled_dot_product_attention(query, key, value)
        return self.output(seen.transpose(1, 2).flatten(2), tags)


class TaggingLayer(nn.Module):
    """Cross-attention and a perceptron; the tags do not attend to each other."""

    def __init__(self, config: RamConfig):
        super().__init__()
        self.crossattention = CrossAttention(config.width, config.embedding_width, config.num_heads)
        self.intermediate = nn.ModuleDict({"dense": nn.Linear(config.width, config.hidden)})
        self.output = _Residual(config.hidden, config.width)

    def forward(self, tags: torch.Tensor, tokens: torch.Tensor) -> torch.Tensor:
        tags = self.crossattention(tags, tokens)
        return self.output(functional.gelu(self.intermediate["dense"](tags)), tags)


class TaggingHead(nn.Module):
    """The image-tag recognition decoder.

    References
    ----------
    Liu et al., "Query2Label: A Simple Transformer Way to Multi-Label Classification", 2021: a tag's query is its
    embedding, and its output alone decides on the tag.
    """

    def __init__(self, config: RamConfig):
        super().__init__()
        layers = nn.ModuleList(TaggingLayer(config) for _ in range(config.num_layers))
        self.encoder = nn.ModuleDict({"layer": layers})

    def forward(self, tags: torch.Tensor, tokens: torch.Tensor) -> torch.Tensor:
        """Map (B, n, width) queries and (B, m, embedding_width) tokens to (B, n, width) outputs."""
        for layer in self.encoder["layer"]:
            tags = layer(tags, tokens)
        return tags
