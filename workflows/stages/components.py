"""Objects of a section on the working grid: space-time components of the foreground, split and rejoined by motion."""

import numpy as np

from moseg.schemas.parameters import ComponentParams, IdentityParams
from moseg.tasks.half_floats import to_float32
from moseg.tasks.proposals import keep_best, label_components, rejoin_components, split_touching
from moseg.tasks.saliency import reduce_frame
from moseg.workflows.stages.task import Output, Task


def join_rows(sections, name: str, num_rows: int) -> np.ndarray:
    """The first `num_rows` rows of an array that goes on from section to section."""
    parts = []
    for section in sections:
        parts.append(section.rows(name, 0, min(num_rows, section.shape(name)[0])))
        num_rows -= len(parts[-1])
    return np.concatenate(parts) if len(parts) > 1 else parts[0]


def _run(params, inputs, rng):
    identity = IdentityParams.of_recipe(params["identity"])
    foreground = join_rows(inputs.all("foreground"), "foreground", params["num_frames"])
    component_params = ComponentParams.of_recipe(params["components"])
    labels = label_components(foreground, component_params)
    if labels.any():
        cues = inputs.all("saliency")
        flows, residual_flows = (
            np.stack([to_float32(frame.array(name)) for frame in cues]) for name in ("flows", "residual_flows")
        )
        labels = split_touching(labels, residual_flows, identity)
        images = [
            reduce_frame(frame.cached("image"), labels.shape[1:]).astype(np.uint8) for frame in inputs.all("frames")
        ]
        labels = rejoin_components(labels, np.stack(images), flows, residual_flows, identity)
    components = keep_best(foreground, labels, component_params)
    return Output({"labels": components.labels, "scores": components.scores})


SPACE_TIME = Task("components", "space-time", version=1, run=_run)
