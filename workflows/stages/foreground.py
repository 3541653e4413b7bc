"""Probability of each pixel of a section's frames to move on its own."""

import numpy as np

from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.tasks.appearance import ColourCount, colour_ratio, pool_sections
from moseg.tasks.half_floats import to_float16
from moseg.tasks.saliency import foreground_probability
from moseg.workflows.stages.accumulation import mean_of_passes
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    appearance, foreground = (
        AppearanceParams.of_recipe(params["appearance"]),
        ForegroundParams.of_recipe(params["foreground"]),
    )
    sections, centres, own = inputs.all("appearance"), params["centres"], params["own"]
    counts = [_read_count(section) for section in sections]
    looks = {}

    def look(section):
        """Log ratio of colours and usual reliability at the middle of a section."""
        if section not in looks:
            near = slice(max(section - appearance.reach, 0), section + appearance.reach + 1)
            pooled = pool_sections(counts[near], centres[near], centres[section], appearance.memory)
            usual = pooled.reliability / pooled.weight if pooled.weight > 0 else 1.0
            looks[section] = colour_ratio(pooled, appearance), usual
        return looks[section]

    accumulated = mean_of_passes(inputs, "accumulation", "maps")
    misfits = mean_of_passes(inputs, "coherence", "misfit")
    probabilities = []
    for t, (bins, maps, misfit) in enumerate(zip(sections[own].array("bins"), accumulated, misfits, strict=True)):
        ratio, usual = _blend(look, centres, own, params["start"] + t)
        moves = foreground_probability(maps[..., 1], maps[..., 2], misfit, ratio[bins], usual, foreground)
        probabilities.append(to_float16(moves))
    return Output({"foreground": np.stack(probabilities)})


def _read_count(section) -> ColourCount:
    moving, static = section.array("histograms").astype(np.float64)
    return ColourCount(moving, static, section.attributes["reliability"], section.attributes["weight"])


def _blend(look, centres, own, frame):
    """What is looked up between the middles of two sections: without steps, so that no cut between sections shows."""
    ratio0, usual0 = look(own)
    other = own + (1 if frame > centres[own] else -1)
    if frame == centres[own] or not 0 <= other < len(centres):
        return ratio0, usual0
    ratio1, usual1 = look(other)
    share = abs((frame - centres[own]) / (centres[other] - centres[own]))
    return (1 - np.float32(share)) * ratio0 + np.float32(share) * ratio1, (1 - share) * usual0 + share * usual1


MOTION_AND_COLOUR = Task("foreground", "motion-and-colour", version=1, run=_run)
