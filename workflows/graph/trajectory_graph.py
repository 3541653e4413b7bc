"""The graph of a clip of labelled trajectories: from a score back to the points.

Like a `SequenceGraph` it only writes recipes. One artifact holds a model's results for a whole clip, with all frame
pairs stacked, because storing a pair alone would take longer than computing it.
"""

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.recipes import Recipe
from moseg.tasks.point_models import POINT_MODELS
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves


class TrajectoryGraph:
    """Writer of the recipes of one clip under one configuration."""

    def __init__(self, leaves: TrajectoryLeaves, config: PipelineConfig):
        self.leaves = leaves
        self._config = config
        self._nodes = Nodes(leaves, config)

    @property
    def recipes(self) -> dict[str, Recipe]:
        """Recipes written so far, by reference."""
        return self._nodes.recipes

    def score(self, variant: TrajectoryVariant) -> str:
        """Return the reference of the variant's score."""
        inputs = {"clustering": self.clustering(variant), "labels": self.leaves.labels}
        return self._nodes.add("score", inputs, "trajectories")

    def clustering(self, variant: TrajectoryVariant) -> str:
        """Return the reference of the motion groups."""
        # In a fixed order, from the least general model to the most: the clustering identifies views by their position.
        models = sorted(self._config.point_models(variant), key=list(POINT_MODELS).index)
        motions = self._config.clustering.motions
        num_motions = self.leaves.num_motions if motions == "gt" else motions
        inputs = {
            "kernels": tuple(map(self.kernel, models)),
            "hypotheses": tuple(map(self.hypotheses, models)),
            "trajectories": self.trajectories(),
        }
        found = None if num_motions == "auto" else num_motions
        return self._nodes.add("trajectory_clustering", inputs, models=models, num_motions=found)

    def kernel(self, model: str) -> str:
        """Return the reference of the affinity between trajectories under one model."""
        inputs = {"hypotheses": self.hypotheses(model), "trajectories": self.trajectories()}
        return self._nodes.add("kernel", inputs, model=model)

    def hypotheses(self, model: str) -> str:
        """Return the reference of the hypotheses of one model; no other recipe of this graph reads the seed."""
        return self._nodes.add("hypotheses", {"trajectories": self.trajectories()}, model=model)

    def trajectories(self) -> str:
        """Return the reference of the points from which everything is computed: those of the clip with less noise."""
        return self._nodes.add("noise_reduction", {"trajectories": self.leaves.trajectories})
