"""The trained networks: our own modules, and those of transformers, built strictly from a checkpoint's tensors."""

from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly, unwrap_state

__all__ = ["Checkpoint", "load_strictly", "unwrap_state"]
