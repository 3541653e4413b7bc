"""Labels of a section: 0 where static, else the moving object's identity (its own label where masks were given)."""

import numpy as np

from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    identity = inputs["linking"].cached("identity")[params["section"]]
    num_objects = inputs["linking"].attributes["num_objects"]
    moves = np.arange(num_objects) > 0
    if "clustering" in inputs:
        moves = inputs["clustering"].cached("motion") > 0
    names = np.arange(num_objects, dtype=np.uint16)
    if "given" in inputs["linking"].attributes:
        names[1:] = inputs["linking"].attributes["given"]
    label = np.where(moves[identity], names[identity], 0)
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    labels = np.empty(masks.shape, np.uint16)
    # Frame by frame: for indexing NumPy turns labels into integers of four times their size.
    for mask, out in zip(masks, labels, strict=True):
        out[:] = label[mask]
    return Output({"labels": labels})


MOVING_OBJECTS = Task("segmentation", "moving-objects", version=1, run=_run)
