"""The graph of a clip of labelled trajectories: from a score back to the points.

Like a `SequenceGraph` it only writes recipes. One artifact holds what a model gives for a whole clip: all pairs of
frames stacked, for storing a pair alone would take longer than computing it.
"""

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.parameters.clustering import COUNT_READS
from moseg.schemas.recipes import Recipe
from moseg.tasks.point_models import POINT_MODELS
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves


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
        return self._nodes.add("score", "trajectories", {}, inputs)

    def clustering(self, variant: TrajectoryVariant) -> str:
        """Reference of the motion groups."""
        # In one order, from the least general to the most: the clustering tells views apart by their place.
        models = sorted(self._config.point_models(variant), key=list(POINT_MODELS).index)
        motions = self._config.clustering.motions
        num_motions = self.leaves.num_motions if motions == "gt" else motions
        params = {
            "num_motions": None if num_motions == "auto" else num_motions,
            "clustering": self._clustering_params(len(models), num_motions == "auto"),
        }
        inputs = {"kernels": tuple(self.kernel(model) for model in models), "trajectories": self.leaves.trajectories}
        if params["clustering"]["method"] == "energy":
            inputs["residuals"] = tuple(self.residuals(model) for model in models)
        return self._nodes.add("trajectory_clustering", "motion-groups", params, inputs)

    def kernel(self, model: str) -> str:
        """Reference of the affinity between trajectories under one model."""
        params = {"num_draws": self._config.hypotheses.num_draws, "kernel": self._config.kernel.model_dump(mode="json")}
        return self._nodes.add("kernel", "ordered-residuals", params, {"residuals": self.residuals(model)})

    def residuals(self, model: str) -> str:
        """Reference of every trajectory's distance to every hypothesis of one model."""
        inputs = {"hypotheses": self.hypotheses(model), "trajectories": self.leaves.trajectories}
        return self._nodes.add("hypothesis_residual", "point-model", {"model": model}, inputs)

    def hypotheses(self, model: str) -> str:
        """Reference of the hypotheses of one model; of what is written here they alone depend on the seed."""
        params = {"model": model, "hypotheses": self._config.hypotheses.model_dump(mode="json")}
        return self._nodes.add("hypotheses", "minimal-samples", params, {"trajectories": self.leaves.trajectories})

    def _clustering_params(self, num_views: int, is_auto: bool) -> dict:
        """The parameters that a clustering of so many views reads."""
        params = self._config.trajectory_clustering
        # A row of one model is what was published of it: spectral clustering of its kernel.
        method = params.method if num_views > 1 else "sum"
        unread = set() if is_auto else {"most_motions", "auto", "separate"}
        if not is_auto or not params.separate:
            unread.add("separation")
        counts = COUNT_READS.get(params.auto, frozenset()) - {"most_motions"} if is_auto else frozenset()
        if params.auto == "stability":
            # Draws of hypotheses are the resamples.
            counts &= {"least_agreement"}
        if method != "coregularised":
            unread |= {"co_regularisation", "num_iterations", "tolerance"}
        if method != "energy":
            unread.add("pieces")
        read = params.model_copy(update={"method": method}).model_dump(mode="json", exclude=unread | {"count"})
        return read | ({"count": params.count.model_dump(mode="json", include=counts)} if counts else {})
