"""Foreground: probability that each pixel of a section's frames moves on its own."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import AppearanceParams, ForegroundParams, VideoNetworkParams
from moseg.workflows.stages.accumulation import CONSISTENT, SALIENT, mean_of_passes
from moseg.workflows.stages.appearance import RATIO_PARAMS
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task
from moseg.workflows.stages.video_network import ADDITION_PARAMS


def _run(params, inputs, rng):
    from moseg.tasks.appearance import colour_ratio, pool_sections
    from moseg.tasks.half_floats import to_float16
    from moseg.tasks.saliency import foreground_probability, remembered_logit

    appearance, foreground = (
        AppearanceParams.of_recipe(params["appearance"]),
        ForegroundParams.of_recipe(params["foreground"]),
    )
    sections, centres, own = inputs.all("appearance"), params["centres"], params["own"]
    counts = [_read_count(section) for section in sections]
    looks = {}

    def look(section):
        """Return the log ratio of colours and the usual reliability at the middle of a section."""
        if section not in looks:
            near = slice(max(section - appearance.reach, 0), section + appearance.reach + 1)
            pooled = pool_sections(counts[near], centres[near], centres[section], appearance.memory)
            usual = pooled.reliability / pooled.weight if pooled.weight > 0 else 1.0
            looks[section] = colour_ratio(pooled, appearance), usual
        return looks[section]

    accumulated = mean_of_passes(inputs, "accumulation", "maps", (SALIENT, CONSISTENT))
    misfits = mean_of_passes(inputs, "coherence", "misfit")
    remembered = mean_of_passes(inputs, "motion_memory", "odds")
    probabilities = []
    cues = zip(sections[own].array("bins"), accumulated, misfits, remembered, strict=True)
    for t, (bins, maps, misfit, odds) in enumerate(cues):
        ratio, usual = _blend(look, centres, own, params["start"] + t)
        moves = foreground_probability(*maps, misfit, ratio[bins], usual, foreground, remembered_logit(odds))
        probabilities.append(to_float16(moves))
    return Output({"foreground": np.stack(probabilities)})


def _run_video_network(params, inputs, rng):
    from moseg.tasks.half_floats import to_float16, to_float32
    from moseg.tasks.video_network import Outcome, refine_foreground

    foreground, trained = inputs["foreground"].array("foreground"), inputs["video_network"].attributes
    if not trained.pop("is_trained"):
        return Output({"foreground": foreground})

    from moseg.tasks.video_network.crops import lab_bytes
    from moseg.tasks.video_network.network import infer_logits, restore_network

    network, outcome = restore_network(inputs["video_network"].array("weights")), Outcome(**trained)
    network_params = VideoNetworkParams.of_recipe(params["video_network"])
    refined = []
    for frame, probability in zip(inputs.all("frames"), foreground, strict=True):
        logits = infer_logits(network, lab_bytes(reduced_levels(frame, probability.shape)))
        refined.append(to_float16(refine_foreground(to_float32(probability), logits, outcome, network_params)))
    return Output({"foreground": np.stack(refined)})


def _read_count(section):
    from moseg.tasks.appearance import ColourCount

    histograms, totals = section.array("histograms").astype(np.float64), section.attributes
    return ColourCount(*histograms, totals["reliability"], totals["weight"])


def _blend(look, centres, own, frame):
    """Return the results of `look`, interpolated between the middles of two sections to avoid a step at the cut."""
    ratio0, usual0 = look(own)
    other = own + (1 if frame > centres[own] else -1)
    if frame == centres[own] or not 0 <= other < len(centres):
        return ratio0, usual0
    ratio1, usual1 = look(other)
    share = abs((frame - centres[own]) / (centres[other] - centres[own]))
    return (1 - np.float32(share)) * ratio0 + np.float32(share) * ratio1, (1 - share) * usual0 + share * usual1


def _params(config: PipelineConfig, start: int, centres: list[float], own: int) -> dict:
    return {
        "start": start,
        "centres": centres,
        "own": own,
        "appearance": config.appearance.model_dump(mode="json", include=RATIO_PARAMS | {"levels", "texture_levels"}),
        "foreground": config.foreground.model_dump(mode="json"),
    }


def _network_params(config: PipelineConfig) -> dict:
    return {"video_network": config.video_network.model_dump(mode="json", include=ADDITION_PARAMS)}


MOTION_AND_COLOUR = Task("foreground", "motion-and-colour", version=5, run=_run, params=_params, is_cue=True)
VIDEO_NETWORK = Task("foreground", "video-network", version=2, run=_run_video_network, params=_network_params)

STAGE = Stage(
    name="foreground",
    about="probability to move of a section's pixels",
    inputs={
        "appearance": "colours of the section and of those near it",
        "accumulation_past": "saliency accumulated from the past",
        "accumulation_future": "saliency accumulated from the future",
        "coherence_past": "deviations accumulated from the past",
        "coherence_future": "deviations accumulated from the future",
        "foreground": "the same by motion and colour, to which a network adds (video-network)",
        "video_network": "network of the stretch (video-network)",
        "frames": "frames of the section (video-network)",
        "motion_memory_past": "odds of motion remembered from the past",
        "motion_memory_future": "odds of motion remembered from the future",
    },
    arrays={"foreground": layout("float16", "frame y x", "probability", step=1 / 1024)},
    tasks=(MOTION_AND_COLOUR, VIDEO_NETWORK),
)
