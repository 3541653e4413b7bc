"""Enough points last on real video."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import FundamentalParams, TrackParams
from moseg.tasks.tracks import track_points

SHARED = Path(os.environ.get("MOSEG_TEST_DATA", Path(__file__).parents[4] / "shared" / "data"))
DAVIS = SHARED / "davis"
NUM_MASKS = 16
GAP = FundamentalParams().gap

pytestmark = pytest.mark.skipif(not DAVIS.is_dir(), reason=f"no DAVIS sequences in {DAVIS}")


@pytest.mark.parametrize("sequence", ["car-shadow", "cows"])
def test_every_pair_of_a_section_has_tracks_on_object_and_background(sequence):
    images = sorted((DAVIS / "JPEGImages" / "480p" / sequence).glob("*.jpg"))[: NUM_MASKS + GAP]
    annotations = sorted((DAVIS / "Annotations" / "480p" / sequence).glob("*.png"))[:NUM_MASKS]
    frames = (cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB) for path in images)
    masks = np.stack([cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) > 0 for path in annotations]).astype(np.uint16)
    _, visible, object = track_points(frames, masks, TrackParams(), np.random.default_rng(0))
    for label, least in ((0, 60), (1, 30)):
        own = visible[object == label]
        assert min((own[:, m] & own[:, m + GAP]).sum() for m in range(NUM_MASKS)) >= least
