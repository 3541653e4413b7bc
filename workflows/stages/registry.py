"""Every task that can stand in a recipe, by stage and method. A new backend is one more line here."""

from moseg.schemas.errors import InputError
from moseg.workflows.stages import (
    accumulation,
    affinity,
    appearance,
    clustering,
    components,
    depth,
    detections,
    flow,
    flow_models,
    foreground,
    fundamental,
    hypotheses,
    instances,
    linking,
    own_motion,
    proposals,
    saliency,
    score,
    seeds,
    segmentation,
    tags,
    tracks,
    trajectories,
)
from moseg.workflows.stages.task import Task

TASKS: dict[tuple[str, str], Task] = {
    (task.name, task.method): task
    for task in (
        flow.DIS,
        flow.RAFT,
        depth.DPT_DINOV2,
        depth.DEPTH_ANYTHING_V2,
        tags.RAM,
        tags.RAM_PLUS,
        detections.GROUNDING_DINO,
        instances.SAM_HQ,
        instances.SAM2,
        seeds.MASK_OVERLAP,
        saliency.MODEL_SELECTION,
        saliency.BACKGROUND_RESIDUAL,
        accumulation.FLOW_CONSISTENCY,
        accumulation.ALONG_FLOW,
        own_motion.AFFINE_MISFIT,
        accumulation.MISFIT_ALONG_FLOW,
        appearance.COLOUR_HISTOGRAMS,
        foreground.MOTION_AND_COLOUR,
        components.SPACE_TIME,
        proposals.SALIENCY,
        proposals.DEAOT,
        proposals.SAM2,
        proposals.GIVEN_MASKS,
        linking.BY_OVERLAP,
        linking.BY_IDENTITY,
        tracks.LUCAS_KANADE,
        tracks.PIPS,
        tracks.GIVEN_TRACKS,
        fundamental.RANSAC_FIT,
        fundamental.SAMPSON_RESIDUAL,
        flow_models.LEAST_SQUARES_FIT,
        flow_models.MSE_RESIDUAL,
        hypotheses.FLOW_PATCHES,
        hypotheses.TRACK_SAMPLES,
        affinity.RESIDUAL_SIZE,
        affinity.ORDERED_RESIDUAL_KERNEL,
        affinity.MANY_HYPOTHESES,
        affinity.SIZE_AND_HYPOTHESES,
        clustering.MOTION_GROUPS,
        segmentation.MOVING_OBJECTS,
        trajectories.MINIMAL_SAMPLES,
        trajectories.POINT_MODEL,
        trajectories.ORDERED_RESIDUALS,
        trajectories.MOTION_GROUPS,
        trajectories.SCORE,
        score.MOTION_SEGMENTATION,
        score.LABELLED_POINTS,
    )
}


def find_task(name: str, method: str) -> Task:
    """The task of a stage and method; raises InputError where there is none."""
    try:
        return TASKS[name, method]
    except KeyError:
        known = sorted(m for n, m in TASKS if n == name)
        raise InputError(f"unknown method of stage {name}", got=method, expected=" or ".join(known)) from None
