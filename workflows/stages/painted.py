"""Painted: what a user painted, erased and added, at every pixel of a section."""

from collections.abc import Sequence

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.corrections.painting import Brush, paint_pixels

    views = inputs.all("masks")
    brushes = [Brush(each["number"], each["erases"]) for each in params["brushes"]]
    masks = zip(params["first"], (view.array("mask") for view in views), strict=True)
    shape = (params["num_frames"], *views[0].shape("mask")[1:])
    painted, erased = paint_pixels(masks, brushes, shape)
    return Output({"painted": painted}, {"erased": [list(each) for each in erased]})


def _params(config: PipelineConfig, num_frames: int, first: Sequence[int], brushes: Sequence[tuple]) -> dict:
    written = [{"number": number, "erases": erases} for number, erases in brushes]
    return {"num_frames": num_frames, "first": list(first), "brushes": written}


IN_ORDER = Task("painted", "in-order", version=2, run=_run, params=_params)

STAGE = Stage(
    name="painted",
    about="what a user painted, erased and added in a section",
    inputs={"masks": "masks of the edits that reach the section, in the order of the edits"},
    arrays={"painted": layout("int32", "frame y x", "strokes by number; 0 erased, -1 left as it is, less: see erased")},
    tasks=(IN_ORDER,),
)
