"""Motion groups of a sequence's objects from the affinities of one or several motion models."""

from moseg.schemas.parameters import ClusteringParams
from moseg.schemas.parameters.clustering import READ_TRACKS
from moseg.tasks.clustering import MotionTracks, agreed_static, cluster_motions
from moseg.workflows.stages.task import Output, Task


def _tracks(inputs) -> list[MotionTracks]:
    """Tracks of every section, owned by the objects of the sequence."""
    identities = inputs["linking"].cached("identity")
    return [
        MotionTracks(section.cached("points"), section.cached("visible"), identity[section.cached("object")])
        for section, identity in zip(inputs.all("tracks"), identities, strict=True)
    ]


def _run(params, inputs, rng):
    views = inputs.all("affinities")
    clustering_params = ClusteringParams.of_recipe(params["clustering"])
    is_found, is_static = params["num_motions"] is None, None
    if is_found and clustering_params.static == "agreement":
        is_static = agreed_static([view.array("static_support") for view in views], clustering_params.threshold)
    affinities = [view.array("affinity") for view in views]
    tracks = _tracks(inputs) if is_found and clustering_params.auto in READ_TRACKS else []
    result = cluster_motions(affinities, params["num_motions"], clustering_params, is_static, tracks, rng)
    attributes = {"num_motions": int(result.num_motions), "objective": [float(value) for value in result.objective]}
    if len(result.scores):
        attributes["scores"] = [float(value) for value in result.scores]
    return Output(
        {"motion": result.motion, "embedding": result.embedding, "eigenvalues": result.eigenvalues}, attributes
    )


MOTION_GROUPS = Task("clustering", "motion-groups", version=4, run=_run)
