"""The detector of SAM 3 with its tokenizer, run as by its authors."""

from types import SimpleNamespace
from typing import NamedTuple

import torch
from transformers import CLIPTokenizer, Sam3Model, Sam3VideoConfig
from transformers.models.sam3.modeling_sam3 import Sam3ImageSegmentationOutput, Sam3VisionEncoderOutput

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.transformers_model import build_transformers, read_json

VOCABULARY, MERGES = "vocab.json", "merges.txt"
_ENDS = ("<|startoftext|>", "<|endoftext|>")


class Sam3Detector(NamedTuple):
    """A detector of the objects that a phrase names.

    Attributes
    ----------
    model : Sam3Model
    tokenizer : CLIPTokenizer
    """

    model: Sam3Model
    tokenizer: CLIPTokenizer

    def to(self, device: torch.device | str) -> "Sam3Detector":
        """Return a copy with its network on another device."""
        return self._replace(model=self.model.to(device))

    @property
    def side(self) -> int:
        """Return the side to which frames are resized, whatever their aspect, px: 1008 in the published network."""
        return self.model.config.vision_config.image_size

    def tokenize(self, phrase: str) -> list[int]:
        """Return the tokens of a phrase between those of its start and end.

        Raises
        ------
        InputError
            The phrase has no word, or more tokens than the network reads, 32 in the published one.
        """
        tokens = self.tokenizer(phrase)["input_ids"]
        longest = self.model.config.text_config.max_position_embeddings
        if not 2 < len(tokens) <= longest:
            expected = f"1 to {longest - 2} of CLIP's tokens"
            raise InputError("no words, or too many", where="names of objects", got=repr(phrase), expected=expected)
        return tokens

    def find(self, vision: Sam3VisionEncoderOutput, phrase: str) -> Sam3ImageSegmentationOutput:
        """Return the network's answer to a phrase about an image that `Sam3Model.get_vision_features` encoded.

        The authors add what their encoder of boxes makes of no boxes to the tokens of the phrase; transformers 5.23
        leaves it out.
        """
        tokens = torch.tensor([self.tokenize(phrase)], device=self.model.device)
        text = self.model.get_text_features(tokens, torch.ones_like(tokens)).pooler_output
        prompt = torch.cat([text, self._encode_no_boxes(vision)], dim=1)
        is_read = torch.ones(prompt.shape[:2], dtype=torch.bool, device=prompt.device)
        # It reads only this of an output of its text encoder.
        return self.model(
            vision_embeds=vision, text_embeds=SimpleNamespace(pooler_output=prompt), attention_mask=is_read
        )

    def _encode_no_boxes(self, vision: Sam3VisionEncoderOutput) -> torch.Tensor:
        """Return the one token (1, 1, channel) that the encoder of boxes always adds to them."""
        encoder = self.model.geometry_encoder
        features, places = (
            levels[-2].flatten(2).transpose(1, 2) for levels in (vision.fpn_hidden_states, vision.fpn_position_encoding)
        )
        token = encoder.prompt_layer_norm(encoder.final_proj(encoder.cls_embed.weight[None]))
        for layer in encoder.layers:
            token = layer(token, features, places, None)
        return encoder.output_layer_norm(token)


def build_sam3_detector(checkpoint: Checkpoint) -> Sam3Detector:
    """Build the image network of ``facebook/sam3``; the tracker's own tensors are ignored.

    Parameters
    ----------
    checkpoint : Checkpoint
        With ``config.json``, and CLIP's ``vocab.json`` and ``merges.txt``, among its documents.

    Raises
    ------
    InputError
        The checkpoint is not one of this network, or a document is missing or invalid.

    References
    ----------
    Carion et al., "SAM 3: Segment Anything with Concepts", arXiv 2511.16719, 2025.
    """
    model = build_transformers(Sam3Model, Sam3VideoConfig, checkpoint)
    return Sam3Detector(model, _build_tokenizer(checkpoint, model.config.text_config.vocab_size))


def _build_tokenizer(checkpoint: Checkpoint, max_tokens: int) -> CLIPTokenizer:
    """Build CLIP's tokenizer from a number for each token, and the pairs that are merged, one a line."""
    vocabulary = read_json(checkpoint, VOCABULARY)
    where = f"{VOCABULARY} of weights {checkpoint.name}"
    if not all(isinstance(number, int) and 0 <= number < max_tokens for number in vocabulary.values()):
        raise InputError("not numbers of tokens", where=where, expected=f"numbers from 0 to {max_tokens - 1}")
    if not all(end in vocabulary for end in _ENDS):
        raise InputError("not CLIP's vocabulary", where=where, expected=f"the tokens {' and '.join(_ENDS)}")
    # Not `splitlines`, which would cut at the line separators that are tokens themselves.
    lines = checkpoint.document(MERGES).removesuffix("\n").split("\n")
    pairs = [tuple(line.split(" ")) for line in lines if not line.startswith("#version")]
    known = all(len(pair) == 2 and {*pair, "".join(pair)} <= vocabulary.keys() for pair in pairs)
    if not known:
        where = f"{MERGES} of weights {checkpoint.name}"
        raise InputError("not CLIP's merges", where=where, expected="pairs of tokens that make a token, one a line")
    return CLIPTokenizer(vocab=vocabulary, merges=pairs)
