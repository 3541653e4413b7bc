"""Painted: what a user painted, erased and added, at every pixel of a section."""

from collections.abc import Iterator, Sequence

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.picture import bars_of, bars_params
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.corrections.painting import Brush, paint_pixels

    views = inputs.all("masks")
    brushes = [Brush(each["number"], each["erases"]) for each in params["brushes"]]
    masks = zip(params["first"], _masks(params, views), strict=True)
    shape = (params["num_frames"], *views[0].shape("mask")[1:])
    painted, erased = paint_pixels(masks, brushes, shape)
    return Output({"painted": painted}, {"erased": [list(each) for each in erased]})


def _masks(params, views) -> Iterator[np.ndarray]:
    """Yield the pixels of each edit, without those in black bars but where the user drew them."""
    if "bars" not in params:
        yield from (view.array("mask") for view in views)
        return
    from moseg.tasks.black_bars import clear_bars

    for view, drawn in zip(views, params["drawn"], strict=True):
        mask = view.array("mask")
        cleared = clear_bars(mask, bars_of(params))
        if drawn is not None:
            cleared[drawn] = mask[drawn]
        yield cleared


def _params(
    config: PipelineConfig,
    num_frames: int,
    first: Sequence[int],
    brushes: Sequence[tuple],
    bars: BlackBars | None = None,
    drawn: Sequence[int | None] = (),
) -> dict:
    """Return the parameters; `drawn` are the rows of the edits' masks in which the user drew strokes."""
    written = [{"number": number, "erases": erases} for number, erases in brushes]
    read = {"num_frames": num_frames, "first": list(first), "brushes": written}
    return read if bars is None else {**read, **bars_params(bars), "drawn": list(drawn)}


IN_ORDER = Task("painted", "in-order", version=2, run=_run, params=_params)

STAGE = Stage(
    name="painted",
    about="what a user painted, erased and added in a section",
    inputs={"masks": "masks of the edits that reach the section, in the order of the edits"},
    arrays={"painted": layout("int32", "frame y x", "strokes by number; 0 erased, -1 left as it is, less: see erased")},
    tasks=(IN_ORDER,),
)
