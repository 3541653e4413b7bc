"""The layout in which SEA-RAFT's tensors are published, in our module's names."""

import re
from collections.abc import Mapping

from torch import Tensor

from moseg.schemas.errors import InputError

_RULES = (
    (r"^cnet\.", "context_encoder."),
    (r"^fnet\.", "feature_encoder."),
    (r"^(context|feature)_encoder\.conv1\.", r"\1_encoder.convnormrelu.0."),
    (r"^(context|feature)_encoder\.bn1\.", r"\1_encoder.convnormrelu.1."),
    (r"^(context|feature)_encoder\.final_conv\.", r"\1_encoder.conv."),
    (r"(layer\d\.\d+)\.conv(\d)\.", r"\1.convnormrelu\2.0."),
    (r"(layer\d\.\d+)\.bn(\d)\.", r"\1.convnormrelu\2.1."),
    (r"^update_block\.encoder\.convc(\d)\.", r"update_block.encoder.convcorr\1.0."),
    (r"^update_block\.encoder\.convf(\d)\.", r"update_block.encoder.convflow\1.0."),
    (r"^update_block\.encoder\.conv\.", r"update_block.encoder.conv.0."),
    (r"^upsample_weight\.0\.", "mask_predictor.convrelu.0."),
    (r"^upsample_weight\.2\.", "mask_predictor.conv."),
)
_SHORTCUT_NORM, _SHORTCUT_NORM_AGAIN = ".bn3.", ".downsample.1."


def to_own_names(tensors: Mapping[str, Tensor], name: str) -> dict[str, Tensor]:
    """Rename tensors to our module's names; an unknown name is kept, and the loader refuses it.

    The normalisation of a shortcut has two names in the authors' module. Their ``.pth`` files hold it under both, their
    ``.safetensors`` files, which hold no tensor twice, under one of them.

    Raises
    ------
    InputError
        The two copies of a shortcut's normalisation differ.
    """
    renamed = {}
    for key, tensor in tensors.items():
        alias = key.replace(_SHORTCUT_NORM, _SHORTCUT_NORM_AGAIN)
        if alias != key and not tensor.equal(tensors.get(alias, tensor)):
            raise InputError("two copies of a tensor differ", where=f"weights {name}", got=f"{key}, {alias}")
        renamed[_rename(alias)] = tensor
    return renamed


def _rename(key: str) -> str:
    own = key
    for pattern, replacement in _RULES:
        own = re.sub(pattern, replacement, own)
    return own
