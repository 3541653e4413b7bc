"""Black bars of a sequence, which are settled before the rest of its graph is written."""

from collections.abc import Mapping

import numpy as np

from moseg.schemas.black_bars import BlackBars
from moseg.workflows.graph.nodes import Nodes


def black_bars(nodes: Nodes) -> str:
    """Write the recipe of the bars of a sequence, and return its reference."""
    frames, number = nodes.leaves.frames, nodes.config.black_bars.num_frames
    read = tuple(frames[index] for index in sample_frames(len(frames), number))
    return nodes.add("black_bars", {"frames": read})


def sample_frames(num_frames: int, number: int) -> list[int]:
    """Return the indices of at most `number` frames, spread over a sequence from its first to its last."""
    return np.linspace(0, num_frames - 1, min(num_frames, number)).round().astype(int).tolist()


def read_bars(attributes: Mapping) -> BlackBars:
    """Return the bars from the attributes of their artifact."""
    return BlackBars(**attributes["bars"])
