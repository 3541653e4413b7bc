"""The graph of a clip of labelled trajectories: from a score back to the points.

Like a `SequenceGraph` it only writes recipes. One artifact holds what a model gives for a whole clip: all pairs of
frames stacked, for storing a pair alone would take longer than computing it.
"""

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.recipes import Recipe
from moseg.tasks.point_models import POINT_MODELS
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves
from moseg.workflows.stages.trajectory_clustering import clustering_method


class TrajectoryGraph:
    """Writes the recipes of one clip under one configuration."""

    def __init__(self, leaves: TrajectoryLeaves, config: PipelineConfig):
        self.leaves = leaves
        self._config = config
        self._nodes = Nodes(leaves, config)

    @property
    def recipes(self) -> dict[str, Recipe]:
        """Every recipe written so far, by reference."""
        return self._nodes.recipes

    def score(self, variant: TrajectoryVariant) -> str:
        """Reference of the variant's score."""
        inputs = {"clustering": self.clustering(variant), "labels": self.leaves.labels}
        return self._nodes.add("score", inputs, "trajectories")

    def clustering(self, variant: TrajectoryVariant) -> str:
        """Reference of the motion groups."""
        # In one order, from the least general to the most: the clustering tells views apart by their place.
        models = sorted(self._config.point_models(variant), key=list(POINT_MODELS).index)
        motions = self._config.clustering.motions
        num_motions = self.leaves.num_motions if motions == "gt" else motions
        inputs = {"kernels": tuple(self.kernel(model) for model in models), "trajectories": self.leaves.trajectories}
        if clustering_method(self._config, len(models)) == "energy":
            inputs["residuals"] = tuple(self.residuals(model) for model in models)
        found = None if num_motions == "auto" else num_motions
        return self._nodes.add("trajectory_clustering", inputs, num_views=len(models), num_motions=found)

    def kernel(self, model: str) -> str:
        """Reference of the affinity between trajectories under one model."""
        return self._nodes.add("kernel", {"residuals": self.residuals(model)})

    def residuals(self, model: str) -> str:
        """Reference of every trajectory's distance to every hypothesis of one model."""
        inputs = {"hypotheses": self.hypotheses(model), "trajectories": self.leaves.trajectories}
        return self._nodes.add("hypothesis_residual", inputs, model=model)

    def hypotheses(self, model: str) -> str:
        """Reference of the hypotheses of one model; of what is written here they alone depend on the seed."""
        return self._nodes.add("hypotheses", {"trajectories": self.leaves.trajectories}, model=model)
