"""Appearance: colours of a section's moving and static pixels."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.workflows.stages.accumulation import CONSISTENT, EVIDENCE_PARAMS, STRICT, mean_of_passes
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

RATIO_PARAMS = frozenset({"smoothing", "texture_smoothing", "floor", "doubt", "clip", "memory", "reach"})
"""Parameters of the appearance that only the foreground reads."""


def _run(params, inputs, rng):
    from moseg.tasks.appearance import colour_bins, count_colours

    appearance = AppearanceParams.of_recipe(params["appearance"])
    foreground = ForegroundParams.of_recipe({"threshold": params["threshold"], "sharpness": params["sharpness"]})
    accumulated = mean_of_passes(inputs, "accumulation", "maps", (STRICT, CONSISTENT))
    misfits = mean_of_passes(inputs, "coherence", "misfit")
    bins, counts = [], []
    for frame, maps, misfit in zip(inputs.all("frames"), accumulated, misfits, strict=True):
        bins.append(colour_bins(reduced_levels(frame, misfit.shape), appearance))
        counts.append(count_colours(bins[-1], *maps, misfit, appearance, foreground))
    histograms = np.stack([sum(count.moving for count in counts), sum(count.static for count in counts)])
    totals = {name: sum(getattr(count, name) for count in counts) for name in ("reliability", "weight")}
    return Output({"bins": np.stack(bins), "histograms": histograms.astype(np.float32)}, totals)


def _params(config: PipelineConfig) -> dict:
    return {
        **config.foreground.model_dump(mode="json", include=EVIDENCE_PARAMS),
        "appearance": config.appearance.model_dump(mode="json", exclude=RATIO_PARAMS),
    }


COLOUR_HISTOGRAMS = Task("appearance", "lab-histograms", version=2, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="appearance",
    about="colours of a section's moving and static pixels",
    inputs={
        "frames": "frames of the section",
        "accumulation_past": "saliency accumulated from the past",
        "accumulation_future": "saliency accumulated from the future",
        "coherence_past": "deviations accumulated from the past",
        "coherence_future": "deviations accumulated from the future",
    },
    arrays={
        "bins": layout("uint16", "frame y x", "bin of CIELAB"),
        "histograms": layout("float32", "side bin", "weight of what moves, of the background"),
    },
    tasks=(COLOUR_HISTOGRAMS,),
)
