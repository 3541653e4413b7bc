"""Motion groups of a sequence's objects from the affinities of one or several motion models."""

from moseg_tasks.clustering import cluster_motions
from schemas.parameters import ClusteringParams
from workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    affinities = [view.array("affinity") for view in inputs.all("affinities")]
    result = cluster_motions(affinities, params["num_motions"], ClusteringParams(**params["clustering"]))
    return Output(
        {"motion": result.motion, "embedding": result.embedding, "eigenvalues": result.eigenvalues},
        {"num_motions": int(result.num_motions), "objective": [float(value) for value in result.objective]},
    )


MOTION_GROUPS = Task("clustering", "motion-groups", version=1, run=_run)
