"""Scores of a sequence's labels against its annotation."""

from functools import partial

from moseg_tasks.metrics import score_sequence
from workflows.resize import resize_labels
from workflows.stages.task import Output, Task


def _annotated_frames(inputs, indices, section_length):
    """Pairs of predicted and annotated labels at the annotation's size, one frame at a time."""
    sections, annotation = inputs.all("segmentation"), inputs["annotation"]
    for index, truth in zip(indices, annotation.each_row("masks"), strict=True):
        section, offset = divmod(index, section_length)
        labels = sections[section].rows("labels", offset, offset + 1)[0]
        yield resize_labels(labels, truth.shape), truth


def _run(params, inputs, rng):
    indices = inputs["annotation"].attributes["indices"]
    frames = partial(_annotated_frames, inputs, indices, params["section_length"])
    return Output({}, score_sequence(frames, void=params["void"]).model_dump())


MOTION_SEGMENTATION = Task("score", "motion-segmentation", version=1, run=_run)
