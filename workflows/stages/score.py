"""Scores of a sequence's labels against its annotation."""

from functools import partial

from moseg_tasks.metrics import score_sequence
from workflows.resize import resize_labels
from workflows.stages.task import Output, Task


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
