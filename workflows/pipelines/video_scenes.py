"""Scenes of a user's video, found before the rest of the graph is written.

Each scene has a graph of its own, so that the graph cannot be written before the cuts are known.
"""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceLeaves
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.scene_cuts import read_cuts, scene_cuts


def settle_cuts(session: Session, leaves: SequenceLeaves, config: PipelineConfig) -> SequenceLeaves:
    """Return the leaves with the cuts at which the video is segmented apart; as they are where it is not.

    Proposals and tracks that the user gives go over the whole video, so that it stays one scene.
    """
    if not config.scene_cuts.apart or leaves.masks is not None or leaves.tracks is not None:
        return leaves
    nodes = Nodes(leaves, config)
    stretches = scene_cuts(nodes)
    if not stretches:
        return leaves
    found = session.settle(nodes.recipes, [each.ref for each in stretches], leaves.refs())
    return leaves._replace(cuts=_between_scenes(read_cuts(stretches, found), len(leaves.frames)))


def _between_scenes(cuts: Sequence[int], num_frames: int) -> tuple[int, ...]:
    """Return the cuts that leave scenes of two or more frames: a single one shows no motion, and stays with others."""
    kept = [0]
    for cut in cuts:
        if cut - kept[-1] > 1 and num_frames - cut > 1:
            kept.append(cut)
    return tuple(kept[1:])
