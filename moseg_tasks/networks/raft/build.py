"""RAFT from a checkpoint."""

from pydantic import ValidationError

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.raft.config import LARGE, SMALL, RaftConfig
from moseg.tasks.networks.raft.layouts import to_own_names
from moseg.tasks.networks.raft.network import Raft
from moseg.tasks.networks.strict import load_strictly


def build_raft(checkpoint: Checkpoint) -> Raft:
    """RAFT with a checkpoint's tensors, in evaluation mode, float32 and without gradients.

    Parameters
    ----------
    checkpoint : Checkpoint
        Tensors in torchvision's or princeton's layout. They are of the large network if they have an upsampling head,
        of the small one otherwise; `config` holds fields of `RaftConfig` that differ from its sizes.

    Raises
    ------
    InputError
        A tensor is missing, left over or of another shape; or `config` has other fields than `RaftConfig`.
    """
    tensors = to_own_names(checkpoint.tensors, checkpoint.name)
    published = LARGE if any(key.startswith("mask_predictor.") for key in tensors) else SMALL
    try:
        config = RaftConfig.model_validate(published.model_dump() | dict(checkpoint.config))
    except ValidationError as error:
        raise InputError("no sizes of RAFT", where=f"config of weights {checkpoint.name}", got=error) from error
    return load_strictly(Raft(config).float(), tensors, checkpoint.name)
