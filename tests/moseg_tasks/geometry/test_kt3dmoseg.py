"""Real trajectories of road scenes: the background's model tells what moves from what does not."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry import fit_fundamentals, fundamental_residuals

SHARED = Path(os.environ.get("MOSEG_TEST_DATA", Path(__file__).parents[4] / "shared" / "data"))
FOLDER = SHARED / "kt3dmoseg"
IMAGE_SHAPE = (375, 1242)
BACKGROUND_LABEL = 1

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"no KT3DMoSeg trajectories in {FOLDER}")


def residuals_of(clip, params):
    """Objects: 0 half of the background's tracks, 1 the other half, then the movers. Median over pairs, px."""
    data = loadmat(FOLDER / f"{clip}_Tracks.mat", squeeze_me=True, struct_as_record=False)["Data"]
    points, visible = data.ySparse[:2].transpose(1, 2, 0), data.visibleSparse.astype(bool)
    labels = data.GtLabel.astype(int)
    background = labels == BACKGROUND_LABEL
    object = np.where(background, np.cumsum(background) % 2, labels).astype(np.uint16)
    num_objects = labels.max() + 1
    rng = np.random.default_rng(0)
    residuals = []
    for frame0 in range(visible.shape[1] - params.gap):
        frame1 = frame0 + params.gap
        seen = visible[:, frame0] & visible[:, frame1]
        pair = points[seen, frame0], points[seen, frame1], object[seen]
        fits = fit_fundamentals(*pair, num_objects, params, rng, IMAGE_SHAPE)
        residuals.append(fundamental_residuals(fits, *pair, params))
    return np.sqrt(np.nanmedian(residuals, axis=0))


@pytest.mark.parametrize("estimator", ["eight_point_ransac", "poselib"])
@pytest.mark.parametrize("clip", ["Seq009_Clip03", "Seq028_clip03", "Seq059_Clip01"])
def test_the_background_predicts_itself_and_no_mover(clip, estimator):
    residual = residuals_of(clip, FundamentalParams(estimator=estimator))
    assert residual[0, 1] < 0.2
    assert residual[0, 2:].min() > 3 * residual[0, 1]
