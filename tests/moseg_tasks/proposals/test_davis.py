"""The whole weights-free chain on a few frames of a real video."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from moseg_tasks.flow import estimate_flow
from moseg_tasks.proposals import propose_objects
from moseg_tasks.saliency import accumulate_saliency, estimate_saliency
from schemas.parameters import FlowParams, ProposalParams, SaliencyParams

SHARED = Path(os.environ.get("MOSEG_TEST_DATA", Path(__file__).parents[4] / "shared" / "data"))
DAVIS = SHARED / "davis"
NUM_FRAMES = 8


@pytest.mark.skipif(
    not DAVIS.is_dir(), reason=f"no DAVIS at {DAVIS}; set MOSEG_TEST_DATA to the folder that holds davis"
)
@pytest.mark.parametrize(("sequence", "least"), [("soapbox", 0.55), ("cows", 0.7)])
def test_the_moving_object_of_a_real_clip_is_proposed(sequence, least):
    images, truth = read_clip(sequence)
    absent = [None]
    backward = absent + [estimate_flow(images[t], images[t - 1], FlowParams()) for t in range(1, NUM_FRAMES)]
    forward = [estimate_flow(images[t], images[t + 1], FlowParams()) for t in range(NUM_FRAMES - 1)] + absent
    around = absent + images + absent
    frames = [
        estimate_saliency(images[t], around[t], around[t + 2], backward[t], forward[t], SaliencyParams())
        for t in range(NUM_FRAMES)
    ]
    accumulated = accumulate_saliency(
        np.stack([frame.saliency for frame in frames]), np.stack([frame.flows for frame in frames]), ProposalParams()
    )
    moving = propose_objects(accumulated, truth.shape[1:], ProposalParams()).masks > 0
    jaccard = (moving & truth).sum(axis=(1, 2)) / (moving | truth).sum(axis=(1, 2))
    assert jaccard.mean() > least


def read_clip(sequence: str) -> tuple[list[np.ndarray], np.ndarray]:
    """First frames uint8 (y, x, 3) RGB and their annotation bool (frame, y, x)."""
    names = [f"{t:05d}" for t in range(NUM_FRAMES)]
    images = [cv2.imread(str(DAVIS / "JPEGImages/480p" / sequence / f"{name}.jpg")) for name in names]
    truth = [cv2.imread(str(DAVIS / "Annotations/480p" / sequence / f"{name}.png"), 0) for name in names]
    return [cv2.cvtColor(image, cv2.COLOR_BGR2RGB) for image in images], np.stack(truth) > 127
