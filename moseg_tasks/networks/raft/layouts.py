"""The two layouts in which RAFT's tensors are published: torchvision's names, which are ours, and princeton's."""

import re
from collections.abc import Mapping

from torch import Tensor

from moseg.schemas.errors import InputError

_PRINCETON_ENCODERS = {"fnet.": "feature_encoder.", "cnet.": "context_encoder."}
_ENCODER_RULES = (
    (r"^conv1\.", r"convnormrelu.0."),
    (r"^norm1\.", r"convnormrelu.1."),
    (r"^conv2\.", r"conv."),
    (r"^(layer\d\.\d)\.conv(\d)\.", r"\1.convnormrelu\2.0."),
    (r"^(layer\d\.\d)\.norm(\d)\.", r"\1.convnormrelu\2.1."),
)
_UPDATE_RULES = (
    (r"^update_block\.encoder\.convc(\d)\.", r"update_block.motion_encoder.convcorr\1.0."),
    (r"^update_block\.encoder\.convf(\d)\.", r"update_block.motion_encoder.convflow\1.0."),
    (r"^update_block\.encoder\.conv\.", r"update_block.motion_encoder.conv.0."),
    (r"^update_block\.gru\.(conv[zrq])(\d)\.", r"update_block.recurrent_block.convgru\2.\1."),
    (r"^update_block\.gru\.(conv[zrq])\.", r"update_block.recurrent_block.convgru1.\1."),
    (r"^update_block\.mask\.0\.", r"mask_predictor.convrelu.0."),
    (r"^update_block\.mask\.2\.", r"mask_predictor.conv."),
)
_SHORTCUT_NORM = ".downsample.1."
_SHORTCUT_NORM_AGAIN = ".norm3."


def to_own_names(tensors: Mapping[str, Tensor], name: str) -> dict[str, Tensor]:
    """Rename tensors to our module's names; a name of neither layout is kept, and the loader refuses it.

    Raises
    ------
    InputError
        A copy of a shortcut's normalisation, which princeton's layout holds twice, is missing or differs.
    """
    if not any(key.startswith(tuple(_PRINCETON_ENCODERS)) for key in tensors):
        return dict(tensors)
    return {_rename(key): value for key, value in _without_copies(tensors, name).items()}


def _without_copies(tensors: Mapping[str, Tensor], name: str) -> dict[str, Tensor]:
    kept = dict(tensors)
    for key in tensors:
        if _SHORTCUT_NORM in key:
            copy = kept.pop(key.replace(_SHORTCUT_NORM, _SHORTCUT_NORM_AGAIN), None)
            if copy is None or not copy.equal(tensors[key]):
                raise InputError("a tensor has no equal copy under norm3", where=f"weights {name}", got=key)
    return kept


def _rename(key: str) -> str:
    for theirs, ours in _PRINCETON_ENCODERS.items():
        if key.startswith(theirs):
            return ours + _apply(_ENCODER_RULES, key.removeprefix(theirs))
    return _apply(_UPDATE_RULES, key)


def _apply(rules: tuple[tuple[str, str], ...], key: str) -> str:
    for pattern, replacement in rules:
        renamed, count = re.subn(pattern, replacement, key)
        if count:
            return renamed
    return key
