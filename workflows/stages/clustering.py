"""Clustering: motion groups of a sequence's objects from the affinities of one or several motion models."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import MOVING_SOURCES, PipelineConfig
from moseg.schemas.parameters import ClusteringParams
from moseg.schemas.parameters.clustering import COUNT_READS, READ_TRACKS
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _tracks(inputs):
    """Return the tracks of every section, owned by the objects of the sequence."""
    from moseg.tasks.clustering import MotionTracks

    identities = inputs["linking"].cached("identity")
    return [
        MotionTracks(section.cached("points"), section.cached("visible"), identity[section.cached("object")])
        for section, identity in zip(inputs.all("tracks"), identities, strict=True)
    ]


def _supports(views):
    return [view.array("static_support") for view in views]


def _run(params, inputs, rng):
    from moseg.tasks.clustering import agreed_static, cluster_motions
    from moseg.tasks.rigid_support import combine_sections

    views = inputs.all("affinities")
    clustering_params = ClusteringParams.of_recipe(params["clustering"])
    is_found, is_static = params["num_motions"] is None, None
    if "rigid_support" in inputs:
        rigid = combine_sections([section.array("support") for section in inputs.all("rigid_support")])
        is_static = agreed_static(_supports(views), clustering_params.threshold, rigid)
    elif is_found and clustering_params.static == "agreement":
        is_static = agreed_static(_supports(views), clustering_params.threshold)
    affinities = [view.array("affinity") for view in views]
    tracks = _tracks(inputs) if is_found and clustering_params.auto in READ_TRACKS else []
    result = cluster_motions(affinities, params["num_motions"], clustering_params, is_static, tracks, rng)
    attributes = {"num_motions": int(result.num_motions), "objective": [float(value) for value in result.objective]}
    if len(result.scores):
        attributes["scores"] = [float(value) for value in result.scores]
    return Output(
        {"motion": result.motion, "embedding": result.embedding, "eigenvalues": result.eigenvalues}, attributes
    )


def _run_scenes(params, inputs, rng):
    from moseg.tasks.scenes import join_motions

    motion = join_motions([scene.cached("motion") for scene in inputs.all("scenes")])
    # Coordinates of different scenes are not comparable: the clusterings of the scenes have them.
    arrays = {"motion": motion, "embedding": np.zeros((len(motion), 0)), "eigenvalues": np.zeros((0, 0))}
    return Output(arrays, {"num_motions": int(motion.max()) + 1})


def _params(config: PipelineConfig, num_views: int, num_motions: int | None, has_rigid: bool = False) -> dict:
    """Return the parameters that a clustering of so many views reads.

    `num_motions` is None if it has to be found; `has_rigid` is whether it reads the objects' rigid support.
    """
    params, is_auto = config.clustering, num_motions is None
    by_agreement = params.static == "agreement"
    if params.static == "auto":
        by_agreement = config.proposal_source in MOVING_SOURCES
    unread = {"motions", "count"}
    if not is_auto:
        unread |= {"auto", "static"}
    if not has_rigid and not (is_auto and (params.auto == "threshold" or by_agreement)):
        unread.add("threshold")
    if num_views == 1 or params.fusion != "coregularised":
        unread |= {"co_regularisation", "num_iterations", "tolerance"}
    if num_views == 1:
        unread.add("fusion")
    read = params.model_dump(mode="json", exclude=unread)
    if is_auto:
        read["static"] = "agreement" if by_agreement or has_rigid else "group"
        if params.auto in COUNT_READS:
            read["count"] = params.count.model_dump(mode="json", include=COUNT_READS[params.auto])
    return {"num_motions": num_motions, "clustering": read}


MOTION_GROUPS = Task("clustering", "motion-groups", version=5, run=_run, params=_params)
OF_SCENES = Task("clustering", "scenes", version=1, run=_run_scenes)

STAGE = Stage(
    name="clustering",
    about="motion groups of a sequence's objects",
    inputs={
        "affinities": "affinity under every motion model",
        "tracks": "tracks of every section, if the number of motions is found from them",
        "linking": "identities of the objects, beside the tracks",
        "rigid_support": "of the objects, by every section in which they are compared with a rigid scene",
        "scenes": "clustering of every scene, in place of all these, where scenes were segmented apart",
    },
    arrays={
        "motion": layout("uint16", "object", "motion group, 0 = the background's"),
        "embedding": layout("float64", "object coordinate"),
        "eigenvalues": layout("float64", "view eigenvalue"),
    },
    tasks=(MOTION_GROUPS, OF_SCENES),
)
