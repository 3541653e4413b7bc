"""Colours of a section's moving and static pixels."""

import numpy as np

from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.tasks.appearance import colour_bins, count_colours
from moseg.tasks.saliency import reduce_frame
from moseg.workflows.stages.accumulation import mean_of_passes
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    appearance = AppearanceParams.of_recipe(params["appearance"])
    foreground = ForegroundParams.of_recipe({"threshold": params["threshold"], "sharpness": params["sharpness"]})
    accumulated = mean_of_passes(inputs, "accumulation", "maps")
    misfits = mean_of_passes(inputs, "coherence", "misfit")
    bins, counts = [], []
    for frame, maps, misfit in zip(inputs.all("frames"), accumulated, misfits, strict=True):
        reduced = reduce_frame(frame.cached("image"), misfit.shape).astype(np.uint8)
        bins.append(colour_bins(reduced, appearance))
        counts.append(count_colours(bins[-1], maps[..., 0], maps[..., 2], misfit, appearance, foreground))
    histograms = np.stack([sum(count.moving for count in counts), sum(count.static for count in counts)])
    totals = {name: sum(getattr(count, name) for count in counts) for name in ("reliability", "weight")}
    return Output({"bins": np.stack(bins), "histograms": histograms.astype(np.float32)}, totals)


COLOUR_HISTOGRAMS = Task("appearance", "lab-histograms", version=1, run=_run)
