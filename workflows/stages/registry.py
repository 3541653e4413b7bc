"""Registry of the stages, in the order of a run, and of the methods that plug-ins add to them."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from moseg.schemas.arrays import LEAF_LAYOUTS, ArrayLayout, check_arrays
from moseg.schemas.errors import InputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.stages import (
    accumulation,
    affinity,
    appearance,
    background,
    black_bars,
    cameras,
    carried_mask,
    clustering,
    coherence,
    components,
    confidence,
    consistency,
    corrected_objects,
    dense_tracks,
    depth,
    detections,
    filled_frame,
    flow,
    flow_model,
    flow_residual,
    foreground,
    fundamental,
    fundamental_residual,
    grown_object,
    hypotheses,
    instances,
    kernel,
    linking,
    motion_memory,
    motion_network,
    motion_prompts,
    motion_proof,
    moves_now,
    moving_tracks,
    noise_reduction,
    object_areas,
    object_hypotheses,
    object_points,
    own_motion,
    painted,
    proposals,
    repetitions,
    rigid_support,
    rigidity,
    saliency,
    scene_cuts,
    scene_parallax,
    score,
    screen_graphics,
    seeds,
    segmentation,
    sightings,
    slow_motion,
    tags,
    track_groups,
    track_objects,
    track_surfaces,
    tracked_mask,
    tracks,
    trajectory_clustering,
    video_network,
)
from moseg.workflows.stages.stage import Backend, Choice, Stage
from moseg.workflows.stages.task import Task

STAGES: dict[str, Stage] = {
    module.STAGE.name: module.STAGE
    for module in (
        *(tags, detections, motion_prompts, instances, seeds),
        *(black_bars, screen_graphics, filled_frame, repetitions, scene_cuts),
        *(
            flow,
            slow_motion,
            scene_parallax,
            background,
            saliency,
            motion_network,
            consistency,
            accumulation,
            motion_memory,
            own_motion,
            coherence,
        ),
        *(appearance, motion_proof, video_network, foreground, components),
        *(dense_tracks, cameras, rigidity, moving_tracks, track_surfaces, track_groups, track_objects),
        object_points,
        *(sightings, proposals, linking, rigid_support),
        *(depth, tracks, fundamental, fundamental_residual, flow_model, flow_residual, object_hypotheses),
        *(affinity, clustering, object_areas, corrected_objects, grown_object, carried_mask, tracked_mask, painted),
        *(segmentation, moves_now, confidence),
        *(noise_reduction, hypotheses, kernel, trajectory_clustering),
        score,
    )
}


def find_stage(name: str) -> Stage:
    """Return the stage of this name; raises InputError if there is none."""
    try:
        return STAGES[name]
    except KeyError:
        raise unknown_name("stage", name, STAGES) from None


def find_task(name: str, method: str) -> Task:
    """Return the task of a stage and method; raises InputError if there is none."""
    return find_stage(name).task(method)


def all_tasks() -> tuple[Task, ...]:
    """Return the tasks of all stages."""
    return tuple(task for stage in STAGES.values() for task in stage.tasks)


def all_choices() -> tuple[Choice, ...]:
    """Return every parameter that chooses a method."""
    return tuple(choice for stage in STAGES.values() for choice in stage.choices)


def add_method(name: str, task: Task, backend: Backend) -> None:
    """Add a method to a stage, and the line of `moseg backends` to the parameter that chooses between its methods.

    Raises
    ------
    InputError
        There is no such stage, nothing chooses its method, or the method exists.
    """
    stage = find_stage(name)
    if task.name != name or task.method != backend.method:
        got = f"{task.name} by {task.method}, {backend.method}"
        raise InputError("a task of another stage or method", where=f"stage {name}", got=got)
    if not stage.choices or not stage.choices[-1].parameter:
        raise InputError("no parameter chooses the method of this stage", where=f"stage {name}", got=task.method)
    if task.method in {each.method for each in stage.tasks}:
        (known,) = (each for each in stage.tasks if each.method == task.method)
        expected = f"another name than that of {'moseg itself' if known.code is None else 'another plug-in'}"
        raise InputError("method exists", where=f"stage {name}", got=task.method, expected=expected)
    choice = stage.choices[-1]
    choices = (*stage.choices[:-1], choice._replace(backends=(*choice.backends, backend)))
    STAGES[name] = replace(stage, tasks=(*stage.tasks, task), choices=choices)


def names_of(parameter: str) -> tuple[str, ...]:
    """Return the values that a parameter accepts: names of a stage's methods, or of motion models."""
    if parameter == "fused_flow_model":
        from moseg.tasks.motion_models import FLOW_MODELS

        return tuple(FLOW_MODELS)
    if parameter in ("fused_point_models", "clustering.count.affinity.models"):
        from moseg.tasks.point_models import POINT_MODELS

        are_pairs = parameter != "fused_point_models"
        models = [model for model in POINT_MODELS.values() if not model.needs_depth]
        return tuple(model.name for model in models if model.num_frames == 2 or not are_pairs)
    if parameter.startswith("weights."):
        return _names_of_weights(parameter)
    (names,) = (choice.names for choice in all_choices() if choice.parameter == parameter)
    return names


def _names_of_weights(parameter: str) -> tuple[str, ...]:
    """Return every architecture, or the documents of one (``weights.documents.<architecture>``)."""
    documents = {task.network.architecture: task.network.documents for task in all_tasks() if task.network is not None}
    if parameter == "weights.architecture":
        return tuple(documents)
    return documents[parameter.removeprefix("weights.documents.")]


def artifact_names() -> tuple[str, ...]:
    """Return the names of all kinds of artifacts: decoded leaves, then stages."""
    return (*LEAF_LAYOUTS, *STAGES)


def layouts_of(name: str) -> Mapping[str, ArrayLayout]:
    """Return the layouts of the arrays of a stage or a decoded leaf; none for any other name."""
    return STAGES[name].arrays if name in STAGES else LEAF_LAYOUTS.get(name, {})


def axes_of(name: str, arrays: Mapping[str, np.ndarray]) -> dict[str, tuple[str, ...]]:
    """Return the axis names of the arrays of a stage or leaf; raises StoreError if they do not have its layouts."""
    return check_arrays(name, arrays, layouts_of(name))
