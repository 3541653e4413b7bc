"""Graphics drawn into the frames of a sequence, which are settled before the rest of its graph is written."""

from collections.abc import Mapping

from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.workflows.graph.black_bars import black_bars, sample_frames
from moseg.workflows.graph.nodes import Nodes


def screen_graphics(nodes: Nodes) -> str:
    """Write the recipe of the graphics of a sequence, and return its reference."""
    frames, number = nodes.leaves.frames, nodes.config.screen_graphics.num_frames
    indices = sample_frames(len(frames) - 1, number)
    read, following = (tuple(frames[index + after] for index in indices) for after in (0, 1))
    return nodes.add("screen_graphics", {"bars": black_bars(nodes), "frames": read, "following": following})


def read_graphics(attributes: Mapping) -> ScreenGraphics:
    """Return the graphics from the attributes of their artifact."""
    return ScreenGraphics(tuple(tuple(map(tuple, part)) for part in attributes["graphics"]["parts"]))
