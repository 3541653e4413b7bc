"""Scores of a sequence's labels against its ground truth: annotated masks, or labelled points."""

from functools import partial

from moseg.tasks.metrics import sample_points, score_points, score_sequence
from moseg.workflows.sources.resize import resize_labels
from moseg.workflows.stages.task import Output, Task


def _annotated_frames(inputs, indices, section_length):
    """Pairs of predicted and annotated labels at the annotation's size, one frame at a time."""
    sections = [section.row_reader("labels") for section in inputs.all("segmentation")]
    annotation = inputs["annotation"].row_reader("masks")
    for row, index in enumerate(indices):
        section, offset = divmod(index, section_length)
        truth = annotation(row)
        yield resize_labels(sections[section](offset), truth.shape), truth


def _run(params, inputs, rng):
    indices = inputs["annotation"].attributes["indices"]
    frames = partial(_annotated_frames, inputs, indices, params["section_length"])
    return Output({}, score_sequence(frames, void=params["void"]).model_dump())


MOTION_SEGMENTATION = Task("score", "motion-segmentation", version=1, run=_run)


def _labelled_frames(inputs, section_length):
    """Predicted and true labels of the visible points of every frame, looked up at the original size."""
    sections = [section.row_reader("labels") for section in inputs.all("segmentation")]
    ground_truth = inputs["labelled_points"]
    size = ground_truth.attributes["size"]
    points, visible, truth = (ground_truth.array(name) for name in ("points", "visible", "labels"))
    for index in range(visible.shape[1]):
        section, offset = divmod(index, section_length)
        labels = resize_labels(sections[section](offset), size)
        yield sample_points(labels, points[:, index], visible[:, index], truth)


def _run_points(params, inputs, rng):
    score = score_points(_labelled_frames(inputs, params["section_length"]))
    return Output({}, score.model_dump(exclude_none=True))


LABELLED_POINTS = Task("score", "labelled-points", version=1, run=_run_points)
