"""RAM and RAM++: logits of every tag of the list for an image."""

import torch
from torch import nn
from torch.nn import functional

from moseg.tasks.networks.ram.config import RamConfig
from moseg.tasks.networks.ram.head import TaggingHead
from moseg.tasks.networks.swin import SwinEncoder


class Ram(nn.Module):
    """Recognize Anything: the query of a tag is its text embedding.

    Parameters
    ----------
    config : RamConfig

    References
    ----------
    Zhang et al., "Recognize Anything: A Strong Image Tagging Model", 2023, section 3.
    """

    def __init__(self, config: RamConfig):
        super().__init__()
        self.config = config
        self.visual_encoder = SwinEncoder(config.image)
        self.image_proj = nn.Linear(config.image.output_width, config.embedding_width)
        self.label_embed = nn.Parameter(torch.zeros(self.num_embeddings(config), config.embedding_width))
        self.wordvec_proj = nn.Linear(config.embedding_width, config.width)
        self.tagging_head = TaggingHead(config)
        self.fc = nn.Linear(config.width, 1)

    @staticmethod
    def num_embeddings(config: RamConfig) -> int:
        """Return the number of text embeddings in the checkpoint."""
        return config.num_tags

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Return the logits of the tags.

        Parameters
        ----------
        images : (B, 3, image_size, image_size)
            RGB, normalised by ImageNet's mean and deviation.

        Returns
        -------
        logits : (B, num_tags)
            In the parameters' dtype, also under autocast.
        """
        tokens = self.image_proj(self.visual_encoder(images))
        queries = functional.relu(self.wordvec_proj(self._embed_tags(tokens)))
        logits = self.fc(self.tagging_head(queries, tokens)).squeeze(-1)
        return logits.to(self.label_embed.dtype)

    def _embed_tags(self, tokens: torch.Tensor) -> torch.Tensor:
        """Return the tags' queries, (B, num_tags, embedding_width)."""
        return self.label_embed.expand(len(tokens), -1, -1)


class RamPlus(Ram):
    """RAM++: a tag has many descriptions, weighted for each image by their similarity to it.

    References
    ----------
    Huang et al., "Open-Set Image Tagging with Multi-Grained Text Supervision", 2023, section 3.3.
    """

    def __init__(self, config: RamConfig):
        super().__init__(config)
        self.reweight_scale = nn.Parameter(torch.zeros(()))

    @staticmethod
    def num_embeddings(config: RamConfig) -> int:
        return config.num_tags * config.num_descriptions

    def _embed_tags(self, tokens: torch.Tensor) -> torch.Tensor:
        # Similarities are scaled by about 14 before the softmax: half precision would change the weights by percents.
        with torch.autocast(tokens.device.type, enabled=False):
            image = functional.normalize(tokens[:, 0].to(self.label_embed.dtype), dim=-1)
            similarity = self.reweight_scale.exp() * image @ self.label_embed.T
            weights = similarity.view(len(tokens), self.config.num_tags, -1).softmax(-1)
            descriptions = self.label_embed.view(self.config.num_tags, -1, self.config.embedding_width)
            return torch.einsum("btd,tdc->btc", weights, descriptions)
