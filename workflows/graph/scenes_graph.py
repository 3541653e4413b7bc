"""The graph of a video of several scenes, each of which is segmented like a video of its own."""

from collections.abc import MutableMapping, Sequence
from itertools import chain

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.joined_writers import (
    JoinedCues,
    JoinedForeground,
    JoinedMotions,
    JoinedObjects,
    ScenePlaces,
)
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.painted_sections import PaintedSections
from moseg.workflows.graph.sequence_graph import SequenceGraph
from moseg.workflows.graph.sequence_leaves import SequenceLeaves


class ScenesGraph(SequenceGraph):
    """Writer of the recipes of a sequence of several scenes.

    Up to the motion groups each scene has the graph, and the keys, of a video that has its frames alone. Identities and
    motion groups of the scenes are then joined, and labels and all that is known about them are those of the whole.
    """

    def __init__(
        self,
        leaves: SequenceLeaves,
        config: PipelineConfig,
        recipes: MutableMapping[str, Recipe] | None = None,
    ):
        nodes = self._nodes = self._motion_nodes = self._first_nodes = Nodes(leaves, config, recipes)
        self._config, self.leaves = config, leaves
        self._join([SequenceGraph(scene, config, nodes.recipes) for scene in leaves.scenes()])

    def _write_on(self, nodes: Nodes, keeps_motions: bool) -> None:
        self._nodes, self._config, self.leaves = nodes, nodes.config, nodes.leaves
        if not keeps_motions:
            self._motion_nodes = nodes
        self._join([scene.changed(scene.leaves, nodes.config, nodes.recipes) for scene in self.scenes])

    def _join(self, scenes: Sequence[SequenceGraph]) -> None:
        """Take the graphs of the scenes, which share the recipes of this one."""
        self._places = places = ScenePlaces(scenes)
        self.sections = places.cut_sections()
        self.frame_cues = JoinedCues(places)
        self.foreground = JoinedForeground(places)
        self.objects = JoinedObjects(self._nodes, places)
        self.motions = JoinedMotions(places)
        self._painted = PaintedSections(self._nodes, self.frame_cues, self.sections, places.sections)

    @property
    def scenes(self) -> tuple[SequenceGraph, ...]:
        """The graph of each scene."""
        return self._places.scenes

    @property
    def first_frames(self) -> tuple[int, ...]:
        """The first frame of each scene."""
        return self._places.first_frames

    def clustering(self, variant: Variant) -> str | None:
        """Return the reference of the motion groups of all scenes; None for the variant that keeps every proposal."""
        if not self._config.views(variant):
            return None
        scenes = tuple(scene.clustering(variant) for scene in self.scenes)
        return self._nodes.add("clustering", {"scenes": scenes}, "scenes")

    def rigid_supports(self, variant: Variant) -> tuple[str, ...]:
        """Return the references of the objects' rigid support that the motion groups of all scenes read."""
        return tuple(chain.from_iterable(scene.rigid_supports(variant) for scene in self.scenes))


def make_graph(leaves: SequenceLeaves, config: PipelineConfig) -> SequenceGraph:
    """Return the graph of a sequence, scene by scene where its leaves have cuts."""
    return ScenesGraph(leaves, config) if leaves.cuts else SequenceGraph(leaves, config)
