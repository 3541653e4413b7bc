"""The whole weights-free chain on a few frames of a real video."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import (
    AccumulationParams,
    AppearanceParams,
    ComponentParams,
    FlowParams,
    ForegroundParams,
    LocalColourParams,
    OwnMotionParams,
    RefinementParams,
    SaliencyParams,
)
from moseg.tasks.appearance import colour_bins, colour_ratio, count_colours, pool_sections
from moseg.tasks.flow import estimate_flow
from moseg.tasks.frame_grid import frame_on_grid
from moseg.tasks.proposals import keep_best, label_components, refine_outlines
from moseg.tasks.saliency import (
    accumulate,
    estimate_saliency,
    flow_consistency,
    foreground_probability,
    memory_weight,
    motion_logit,
    own_motion_misfit,
    probability,
)

SHARED = Path(os.environ.get("MOSEG_TEST_DATA", Path(__file__).parents[4] / "shared" / "data"))
DAVIS = SHARED / "davis"
NUM_FRAMES = 6
ACCUMULATION, APPEARANCE, FOREGROUND, OWN = (
    AccumulationParams(),
    AppearanceParams(),
    ForegroundParams(),
    OwnMotionParams(),
)


# The motion of all pixels alone, without colour, coherence or a border that counts more, reaches 0.62, 0.33 and 0.19.
@pytest.mark.skipif(
    not DAVIS.is_dir(), reason=f"no DAVIS at {DAVIS}; set MOSEG_TEST_DATA to the folder that holds davis"
)
@pytest.mark.parametrize(("sequence", "least"), [("soapbox", 0.65), ("blackswan", 0.5), ("parkour", 0.55)])
def test_the_moving_object_of_a_real_clip_is_proposed(sequence, least):
    images, truth = read_clip(sequence)
    moving = propose(images) > 0
    jaccard = (moving & truth).sum(axis=(1, 2)) / (moving | truth).sum(axis=(1, 2))
    assert jaccard.mean() > least


def propose(images: list[np.ndarray]) -> np.ndarray:
    """Objects uint16 (frame, y, x) of a video of a single section."""
    frames = find_salient(images)
    flows = [frame.flows.astype(np.float32) for frame in frames]
    consistency = flow_consistency(flows, ACCUMULATION)
    maps = mean_of_passes(flows, *zip(*(see(frames, consistency, way) for way in (0, 1)), strict=True))
    misfits = [find_misfit(frames, maps, t)[..., None] for t in range(NUM_FRAMES)]
    weights = [ACCUMULATION.memory] * NUM_FRAMES
    misfits = mean_of_passes(flows, (misfits, misfits), (weights, weights))[..., 0]
    bins = [colour_bins(frame_on_grid(image, misfits.shape[1:]).astype(np.uint8), APPEARANCE) for image in images]
    counts = [
        count_colours(bins[t], maps[t, ..., 0], maps[t, ..., 2], misfits[t], APPEARANCE, FOREGROUND)
        for t in range(NUM_FRAMES)
    ]
    count = pool_sections(counts, [0.0] * NUM_FRAMES, 0.0, APPEARANCE.memory)
    ratio, usual = colour_ratio(count, APPEARANCE), count.reliability / count.weight
    foreground = [
        foreground_probability(maps[t, ..., 1], maps[t, ..., 2], misfits[t], ratio[bins[t]], usual, FOREGROUND)
        for t in range(NUM_FRAMES)
    ]
    foreground = np.stack(foreground)
    labels = keep_best(foreground, label_components(foreground, ComponentParams()), ComponentParams()).labels
    outlines = zip(images, labels, foreground, strict=True)
    return np.stack([refine_outlines(*each, RefinementParams(), LocalColourParams()) for each in outlines])


def find_salient(images: list[np.ndarray]) -> list:
    around = [None, *images, None]

    def flow(t, other):
        return None if other is None else estimate_flow(images[t], other, FlowParams())

    return [
        estimate_saliency(image, around[t], around[t + 2], flow(t, around[t]), flow(t, around[t + 2]), SaliencyParams())
        for t, image in enumerate(images)
    ]


def see(frames, consistency: np.ndarray, way: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """What one pass accumulates of each frame, and the weights of its memory."""
    seen = [
        np.dstack([frame.strict_saliency, frame.saliency, consistent[way]]).astype(np.float32)
        for frame, consistent in zip(frames, consistency, strict=True)
    ]
    weights = [memory_weight(consistent, way, ACCUMULATION) for consistent in consistency]
    return seen, [np.dstack([weight, weight, np.full_like(weight, ACCUMULATION.memory)]) for weight in weights]


def mean_of_passes(flows, maps, weights) -> np.ndarray:
    passes = []
    for way, order in enumerate((slice(None), slice(None, None, -1))):
        along = [flow[way] for flow in flows]
        passes.append(accumulate(maps[way][order], along[order], weights[way][order])[order].astype(np.float32))
    return (passes[0] + passes[1]) / 2


def find_misfit(frames, maps: np.ndarray, t: int) -> np.ndarray:
    to_previous, to_next = frames[t].residual_flows.astype(np.float32)
    moves = probability(motion_logit(maps[t, ..., 0], FOREGROUND.threshold, FOREGROUND.sharpness))
    weight = moves**OWN.sharpness * maps[t, ..., 2] ** 2
    return own_motion_misfit((to_previous if t > 0 else None, to_next if t + 1 < NUM_FRAMES else None), weight, OWN)


def read_clip(sequence: str) -> tuple[list[np.ndarray], np.ndarray]:
    """First frames uint8 (y, x, 3) RGB and their annotation bool (frame, y, x)."""
    names = [f"{t:05d}" for t in range(NUM_FRAMES)]
    images = [cv2.imread(str(DAVIS / "JPEGImages/480p" / sequence / f"{name}.jpg")) for name in names]
    truth = [cv2.imread(str(DAVIS / "Annotations/480p" / sequence / f"{name}.png"), 0) for name in names]
    return [cv2.cvtColor(image, cv2.COLOR_BGR2RGB) for image in images], np.stack(truth) > 127
