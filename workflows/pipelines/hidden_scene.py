"""Black bars and graphics, which hide the scene of a user's video, found before the rest of the graph is written.

The graph reads filled frames where there is any, so that a video without it has nothing of it in its keys.
"""

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceLeaves
from moseg.workflows.graph.black_bars import black_bars, read_bars
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.screen_graphics import read_graphics, screen_graphics


def settle_hidden(session: Session, leaves: SequenceLeaves, config: PipelineConfig) -> SequenceLeaves:
    """Return the leaves with the bars and the graphics that are left out; None of each where it is none, or scene."""
    nodes = Nodes(leaves, config)
    sinks = {
        name: write(nodes)
        for name, write, fills in (
            ("bars", black_bars, config.black_bars.fill),
            ("graphics", screen_graphics, config.screen_graphics.fill),
        )
        if fills
    }
    found = dict(zip(sinks, session.settle(nodes.recipes, list(sinks.values()), leaves.refs()), strict=True))
    bars = read_bars(found["bars"]) if "bars" in found else ()
    graphics = read_graphics(found["graphics"]) if "graphics" in found else None
    return leaves._replace(
        bars=bars if any(bars) else None, graphics=graphics if graphics is not None and graphics.parts else None
    )
