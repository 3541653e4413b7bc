"""Appearance: colours and textures of a section's moving and static pixels."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.workflows.stages.accumulation import CONSISTENT, EVIDENCE_PARAMS, STRICT, mean_of_passes
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

RATIO_PARAMS = frozenset(
    {"smoothing", "texture_smoothing", "floor", "doubt", "texture_doubt", "clip", "memory", "reach"}
)
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
    *histograms, reliability, weight = (sum(parts) for parts in zip(*counts, strict=True))
    arrays = {"bins": np.stack(bins), "histograms": np.stack(histograms).astype(np.float32)}
    return Output(arrays, {"reliability": reliability, "weight": weight})


def _params(config: PipelineConfig) -> dict:
    return {
        **config.foreground.model_dump(mode="json", include=EVIDENCE_PARAMS),
        "appearance": config.appearance.model_dump(mode="json", exclude=RATIO_PARAMS),
    }


COLOUR_HISTOGRAMS = Task("appearance", "lab-histograms", version=3, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="appearance",
    about="colours and textures of a section's moving and static pixels",
    inputs={
        "frames": "frames of the section",
        "accumulation_past": "saliency accumulated from the past",
        "accumulation_future": "saliency accumulated from the future",
        "coherence_past": "deviations accumulated from the past",
        "coherence_future": "deviations accumulated from the future",
    },
    arrays={
        "bins": layout("uint16", "frame y x", "bin of CIELAB and texture"),
        "histograms": layout("float32", "side bin", "weights of both sides, and of colours on both sides"),
    },
    tasks=(COLOUR_HISTOGRAMS,),
)
