"""Black bars of a user's video, found before the rest of the graph is written.

The graph reads filled frames where there are any, so that a video without bars has nothing of them in its keys.
"""

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceLeaves
from moseg.workflows.graph.black_bars import black_bars, read_bars
from moseg.workflows.graph.nodes import Nodes


def settle_bars(session: Session, leaves: SequenceLeaves, config: PipelineConfig) -> SequenceLeaves:
    """Return the leaves with the bars that are left out; as they are where there are none, or they are scene."""
    if not config.black_bars.fill:
        return leaves
    nodes = Nodes(leaves, config)
    sink = black_bars(nodes)
    (found,) = session.settle(nodes.recipes, [sink], leaves.refs())
    bars = read_bars(found)
    return leaves._replace(bars=bars) if any(bars) else leaves
