"""DeAOT from a checkpoint."""

from pydantic import ValidationError

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.deaot.config import DeaotConfig
from moseg.tasks.networks.deaot.network import Deaot
from moseg.tasks.networks.strict import load_strictly


def build_deaot(checkpoint: Checkpoint) -> Deaot:
    """DeAOT with the checkpoint's tensors: the published R50-DeAOTL, or of the sizes in `checkpoint.config`.

    Parameters
    ----------
    checkpoint : Checkpoint
        `config` holds fields of `DeaotConfig` that differ from the published ones.

    Returns
    -------
    Deaot
        On the CPU, float32, in evaluation mode, without gradients.

    Raises
    ------
    InputError
        The config has a field or value that DeAOT cannot have, or a tensor is missing, left over or of another shape.
    """
    try:
        config = DeaotConfig.model_validate(dict(checkpoint.config))
    except ValidationError as error:
        problem = error.errors()[0]
        where = f"config of weights {checkpoint.name}"
        raise InputError(problem["msg"], where=where, got=f"{problem['loc']}={problem['input']}") from error
    return load_strictly(Deaot(config), checkpoint.tensors, checkpoint.name)
