"""A PIPs network from its checkpoint."""

import torch

from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.pips.config import PipsConfig
from moseg.tasks.networks.pips.model import Pips
from moseg.tasks.networks.strict import load_strictly


def build_pips(checkpoint: Checkpoint) -> Pips:
    """The network of a checkpoint, ready to be run.

    Parameters
    ----------
    checkpoint : Checkpoint
        Tensors of the published ``model-000200000.pth``, or of a network of the sizes in `config` (`PipsConfig`).

    Returns
    -------
    Pips
        float32, on the CPU, in evaluation mode and without gradients.

    Raises
    ------
    InputError
        A tensor is missing, left over or of another shape.
    """
    # Without memory of its own until the tensors are there: initial values would only be overwritten.
    with torch.device("meta"):
        network = Pips(PipsConfig(**checkpoint.config))
    return load_strictly(network.to_empty(device="cpu"), checkpoint.tensors, checkpoint.name)
