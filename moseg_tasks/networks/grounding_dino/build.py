"""The network with its tokenizer and the size of its input."""

from typing import NamedTuple

import torch
from transformers import BertTokenizer, GroundingDinoConfig, GroundingDinoForObjectDetection

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.transformers_model import build_transformers, read_json

VOCABULARY = "vocab.txt"
PREPROCESSOR = "preprocessor_config.json"
SPECIAL_TOKENS = {"[CLS]": 101, "[SEP]": 102, ".": 1012, "?": 1029}
"""BERT's tokens that separate the phrases of a prompt: the network's code depends on these numbers."""


class GroundingDino(NamedTuple):
    """A detector of named objects.

    Attributes
    ----------
    model : GroundingDinoForObjectDetection
    tokenizer : BertTokenizer
    shorter_side, longer_side : int
        Images are resized until their shorter side has the first of them, or the longer the second, px.
    """

    model: GroundingDinoForObjectDetection
    tokenizer: BertTokenizer
    shorter_side: int
    longer_side: int

    def to(self, device: torch.device | str) -> "GroundingDino":
        """Return a copy with its network on another device."""
        return self._replace(model=self.model.to(device))

    def input_size(self, height: int, width: int, input_scale: float) -> tuple[int, int]:
        """Return height and width of the resized frame, px, rounded as in the authors' ``datasets/transforms.py``.

        transformers rounds differently: its longer side differs by up to 2 px for a quarter of all sizes.

        Parameters
        ----------
        height, width : int
            Of the frame, px.
        input_scale : float
            Share of the published sides.
        """
        shorter, longer = round(self.shorter_side * input_scale), round(self.longer_side * input_scale)
        low, high = sorted((height, width))
        side = shorter if high / low * shorter <= longer else max(round(longer * low / high), 1)
        if side == low:
            return height, width
        size = side, int(side * high / low)
        return size if height <= width else size[::-1]


def build_grounding_dino(checkpoint: Checkpoint) -> GroundingDino:
    """Build the network of ``IDEA-Research/grounding-dino-tiny`` and ``-base``.

    Parameters
    ----------
    checkpoint : Checkpoint
        With ``config.json``, ``preprocessor_config.json`` and BERT's ``vocab.txt`` among its documents.

    Raises
    ------
    InputError
        The checkpoint is not one of this network, or a document is missing or invalid.

    References
    ----------
    Liu et al., "Grounding DINO: Marrying DINO with Grounded Pre-Training for Open-Set Object Detection", ECCV 2024.
    """
    model = build_transformers(GroundingDinoForObjectDetection, GroundingDinoConfig, checkpoint)
    shorter, longer = _read_sides(checkpoint)
    return GroundingDino(model, _build_tokenizer(checkpoint, model.config.text_config.vocab_size), shorter, longer)


def _read_sides(checkpoint: Checkpoint) -> list[int]:
    """Return the shorter and the longer side to which images are resized, px."""
    size = read_json(checkpoint, PREPROCESSOR).get("size")
    sides = [size.get(name) if isinstance(size, dict) else None for name in ("shortest_edge", "longest_edge")]
    if not all(isinstance(side, int) and side > 0 for side in sides):
        where = f"{PREPROCESSOR} of weights {checkpoint.name}"
        raise InputError("no input size", where=where, got=size, expected="shortest_edge and longest_edge, px")
    return sides


def _build_tokenizer(checkpoint: Checkpoint, max_tokens: int) -> BertTokenizer:
    """Build the uncased tokenizer of a vocabulary with one token a line, numbered from 0."""
    where = f"{VOCABULARY} of weights {checkpoint.name}"
    # Not `splitlines`, which would cut at the line separators that are tokens themselves.
    tokens = checkpoint.document(VOCABULARY).removesuffix("\n").split("\n")
    vocabulary = {token: number for number, token in enumerate(tokens)}
    found = {token: vocabulary.get(token) for token in SPECIAL_TOKENS}
    if found != SPECIAL_TOKENS:
        raise InputError("not BERT's vocabulary", where=where, got=found, expected=SPECIAL_TOKENS)
    if len(tokens) > max_tokens:
        expected = f"at most {max_tokens}"
        raise InputError("more tokens than the network has", where=where, got=len(tokens), expected=expected)
    return BertTokenizer(vocab=vocabulary)
