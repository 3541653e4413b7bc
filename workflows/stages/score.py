"""Score of labels against ground truth: masks, points or trajectories with labels, or that nothing moves."""

from functools import partial

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.trajectory_scores import TrajectoryScore
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _annotated_frames(inputs, indices, section_length):
    """Yield pairs of predicted and annotated labels at the annotation's size, one frame at a time."""
    from moseg.workflows.sources.resize import resize_labels

    sections = [section.row_reader("labels") for section in inputs.all("segmentation")]
    annotation = inputs["annotation"].row_reader("masks")
    for row, index in enumerate(indices):
        section, offset = divmod(index, section_length)
        truth = annotation(row)
        yield resize_labels(sections[section](offset), truth.shape), truth


def _run_masks(params, inputs, rng):
    from moseg.tasks.metrics import score_sequence

    indices = inputs["annotation"].attributes["indices"]
    frames = partial(_annotated_frames, inputs, indices, params["section_length"])
    return Output({}, score_sequence(frames, void=params["void"]).model_dump())


def _labelled_frames(inputs, section_length):
    """Yield predicted and true labels of the visible points of every frame, looked up at the original size."""
    from moseg.tasks.metrics import sample_points
    from moseg.workflows.sources.resize import resize_labels

    sections = [section.row_reader("labels") for section in inputs.all("segmentation")]
    ground_truth = inputs["labelled_points"]
    size = ground_truth.attributes["size"]
    points, visible, truth = (ground_truth.array(name) for name in ("points", "visible", "labels"))
    for index in range(visible.shape[1]):
        section, offset = divmod(index, section_length)
        labels = resize_labels(sections[section](offset), size)
        yield sample_points(labels, points[:, index], visible[:, index], truth)


def _run_points(params, inputs, rng):
    from moseg.tasks.metrics import score_points

    score = score_points(_labelled_frames(inputs, params["section_length"]))
    return Output({}, score.model_dump(exclude_none=True))


def _all_labels(inputs):
    """Yield the labels of every frame of all sections."""
    for section in inputs.all("segmentation"):
        labels = section.row_reader("labels")
        yield from (labels(row) for row in range(section.shape("labels")[0]))


def _run_still(params, inputs, rng):
    from moseg.tasks.metrics import score_still

    return Output({}, score_still(_all_labels(inputs)).model_dump())


def _run_trajectories(params, inputs, rng):
    from moseg.tasks.metrics import clustering_error

    labels = inputs["labels"].array("labels")
    # A trajectory without a label takes part in the clustering, because nothing in it says so. It is not scored.
    labelled = labels > 0
    labels = labels[labelled]
    score = TrajectoryScore(
        error=clustering_error(inputs["clustering"].array("motion")[labelled], labels),
        num_motions=inputs["clustering"].attributes["num_motions"],
        num_motions_true=len(set(labels.tolist())),
    )
    return Output({}, score.model_dump())


def _mask_params(config: PipelineConfig, void: int | None) -> dict:
    return {"void": void, "section_length": config.sections.length}


def _point_params(config: PipelineConfig) -> dict:
    return {"section_length": config.sections.length}


MOTION_SEGMENTATION = Task("score", "motion-segmentation", version=1, run=_run_masks, params=_mask_params)
LABELLED_POINTS = Task("score", "labelled-points", version=1, run=_run_points, params=_point_params)
STILL = Task("score", "still", version=1, run=_run_still)
TRAJECTORIES = Task("score", "trajectories", version=1, run=_run_trajectories, is_brief=True)

STAGE = Stage(
    name="score",
    about="score of a sequence or clip",
    inputs={
        "segmentation": "labels of every section",
        "annotation": "annotated masks (motion-segmentation)",
        "labelled_points": "labelled points (labelled-points)",
        "clustering": "motion groups of trajectories (trajectories)",
        "labels": "true motions of trajectories (trajectories)",
    },
    arrays={},
    tasks=(MOTION_SEGMENTATION, LABELLED_POINTS, STILL, TRAJECTORIES),
)
