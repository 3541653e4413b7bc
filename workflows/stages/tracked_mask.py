"""Tracked mask: an object that a user added in one frame, in a section's frames, by SAM 2.1's video network."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import Sam2Params
from moseg.workflows.stages.accumulation import PASSES
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Network, Output, Task


def _run_grown(params, inputs, rng):
    frames, own = inputs.all("frames"), params["frame"]
    seed = inputs["grown_object"].array("mask")
    masks = np.zeros((len(frames), *seed.shape), bool)
    # The frame of the click is the first of both passes.
    for order in (range(own, len(frames)), range(own, -1, -1)):
        masks[list(order)] = _track(params, inputs, seed, [frames[frame] for frame in order])
    return Output({"mask": masks}, made_on())


def _run_continued(params, inputs, rng):
    frames, before = inputs.all("frames"), inputs["tracked"]
    is_past = params["from"] == PASSES[0]
    row = before.shape("mask")[0] - 1 if is_past else 0
    seed = before.rows("mask", row, row + 1)[0]
    ordered = [inputs["border"], *(frames if is_past else reversed(frames))]
    masks = _track(params, inputs, seed, ordered)[1:]
    return Output({"mask": masks if is_past else np.ascontiguousarray(masks[::-1])}, made_on())


def _track(params, inputs, seed: np.ndarray, frames: list) -> np.ndarray:
    """Return the mask in all frames, bool (frame, y, x); the first has `seed`."""
    from moseg.tasks.networks.sam2 import build_sam2_video
    from moseg.tasks.proposals.sam2 import track_masks_sam2

    images = (frame.cached("image") for frame in frames)
    with open_network(build_sam2_video, inputs["weights"]) as network:
        labels = track_masks_sam2(network, images, seed.astype(np.uint16), Sam2Params.of_recipe(params["sam2"]))
    return labels > 0


def _read(config: PipelineConfig) -> dict:
    # The other parameter belongs to the masks of boxes.
    return {"sam2": config.sam2.model_dump(mode="json", exclude={"weights", "boxes_per_pass"})}


def _grown_params(config: PipelineConfig, frame: int) -> dict:
    return {"frame": frame, **_read(config)}


def _continued_params(config: PipelineConfig, origin: str) -> dict:
    return {"from": origin, **_read(config)}


NETWORK = Network("sam2", "sam2.weights", "sam2.1-hiera-large", ("config.json",))
GROWN = Task("tracked_mask", "grown", version=1, run=_run_grown, params=_grown_params, network=NETWORK)
CONTINUED = Task("tracked_mask", "continued", version=1, run=_run_continued, params=_continued_params, network=NETWORK)

STAGE = Stage(
    name="tracked_mask",
    about="an object that a user added, tracked through a section",
    inputs={
        "frames": "frames of the section",
        "grown_object": "its mask in one of them (grown)",
        "tracked": "its masks in the section that it comes from (continued)",
        "border": "the frame of that section next to this one (continued)",
        "weights": "of the network",
    },
    arrays={"mask": layout("bool", "frame y x")},
    tasks=(GROWN, CONTINUED),
    # The edit chooses, not the configuration.
    method=lambda config: None,
)
