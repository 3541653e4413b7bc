"""Ways in which an object grows from a click, and which of them this machine has."""

import os

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import MosegError
from moseg.workflows.stages.registry import find_stage
from moseg.workflows.weights.folder import open_weights
from moseg.workflows.weights.reading import require_network_packages

STAGE = "grown_object"


def list_growing_methods(config: PipelineConfig, non_commercial: bool = False) -> list[str]:
    """Return the methods whose network, if they have one, is here already: a click must not download anything."""
    weights = open_weights(os.environ, offline=True, allow_non_commercial=non_commercial, quiet=True)
    found = []
    for task in find_stage(STAGE).tasks:
        try:
            if task.network is not None:
                require_network_packages()
                if not weights.is_present(weights.item(task.network.item(config))):
                    continue
        except MosegError:
            # The libraries or the licence are missing.
            continue
        found.append(task.method)
    return found
