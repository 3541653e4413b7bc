"""Video network: a small network trained on a stretch of the video, with labels that its motion makes sure."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ComponentParams, VideoNetworkParams
from moseg.workflows.stages.accumulation import PASSES
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

USE_PARAMS = frozenset({"use", "stretch_length"})
"""Parameters that only the graph reads."""
ADDITION_PARAMS = frozenset({"weight", "caution", "limit", "max_growth"})
"""Parameters of what the trained network adds to the foreground."""


def _run(params, inputs, rng):
    from moseg.tasks.proposals import keep_best, label_components
    from moseg.tasks.video_network import measure_outcome, sure_labels
    from moseg.tasks.video_network.crops import lab_bytes

    network_params = VideoNetworkParams.of_recipe(params["video_network"])
    component_params = ComponentParams.of_recipe(params["components"])
    sections = [section.array("foreground") for section in inputs.all("foreground")]
    objects = np.concatenate(
        [keep_best(each, label_components(each, component_params), component_params).labels > 0 for each in sections]
    )
    foreground = np.concatenate(sections)
    proof = np.concatenate([section.array("proof") for section in inputs.all("motion_proof")])
    labels = sure_labels(foreground, objects, proof, _misfits(inputs), network_params)
    if labels is None:
        return Output({"weights": np.zeros(0, np.float32)}, {"is_trained": False})

    from moseg.tasks.video_network.network import infer_logits, pack_weights
    from moseg.tasks.video_network.training import train_network

    shape = labels.shape[1:]
    frames = inputs.all("frames")
    lab = np.stack([lab_bytes(reduced_levels(frame, shape)) for frame in frames])
    network = train_network(lab, labels, rng, network_params)
    checked = slice(None, None, network_params.check_step)
    logits = np.stack([infer_logits(network, frame) for frame in lab[checked]])
    outcome = measure_outcome(logits, objects[checked], labels[checked])
    return Output({"weights": pack_weights(network)}, {"is_trained": True, **outcome._asdict()})


def _misfits(inputs) -> np.ndarray:
    """Return the mean float32 of the misfits of both passes."""
    from moseg.tasks.half_floats import to_float32

    past, future = (np.concatenate([each.array("misfit") for each in inputs.all(f"coherence_{o}")]) for o in PASSES)
    return (to_float32(past) + to_float32(future)) / 2


def _params(config: PipelineConfig) -> dict:
    return {
        "video_network": config.video_network.model_dump(mode="json", exclude=USE_PARAMS | ADDITION_PARAMS),
        "components": config.components.model_dump(mode="json"),
    }


SURE_LABELS = Task("video_network", "sure-labels", version=1, run=_run, params=_params)

STAGE = Stage(
    name="video_network",
    about="network trained on a stretch of the video",
    inputs={
        "frames": "frames of the stretch",
        "foreground": "probability to move of the stretch's sections, by motion and colour",
        "motion_proof": "photometric proof of motion of these sections",
        "coherence_past": "deviations of these sections, accumulated from the past",
        "coherence_future": "deviations of these sections, accumulated from the future",
    },
    arrays={"weights": layout("float32", "parameter", "none where nothing is sure to move")},
    tasks=(SURE_LABELS,),
)
