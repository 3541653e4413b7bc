"""Motion groups of a sequence's objects from the affinities of one or several motion models."""

from moseg_tasks.clustering import agreed_static, cluster_motions
from schemas.parameters import ClusteringParams
from workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    views = inputs.all("affinities")
    clustering_params = ClusteringParams(**params["clustering"])
    is_static = None
    if clustering_params.static == "agreement":
        is_static = agreed_static([view.array("static_support") for view in views], clustering_params.threshold)
    affinities = [view.array("affinity") for view in views]
    result = cluster_motions(affinities, params["num_motions"], clustering_params, is_static)
    return Output(
        {"motion": result.motion, "embedding": result.embedding, "eigenvalues": result.eigenvalues},
        {"num_motions": int(result.num_motions), "objective": [float(value) for value in result.objective]},
    )


MOTION_GROUPS = Task("clustering", "motion-groups", version=2, run=_run)
