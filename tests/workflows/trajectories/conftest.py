"""Made-up clips of labelled trajectories: two rigid bodies, each in its way, before a camera that drives."""

import numpy as np
import pytest
from scipy.io import savemat

NUM_FRAMES, NUM_STATIC, NUM_MOVING = 6, 40, 25
FOCAL, CENTRE = 700.0, (620.0, 187.0)


def _rotation(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _clip(seed, hidden):
    """Points (N, F, 2) px, visible bool (N, F) and labels (N) of one clip; `hidden` is the share of hidden points."""
    rng = np.random.default_rng(seed)
    static = rng.uniform((-8, -2, 8), (8, 2, 30), (NUM_STATIC, 3))
    moving = rng.uniform((-3, -1.5, 10), (1, 1.5, 14), (NUM_MOVING, 3))
    points = np.empty((NUM_STATIC + NUM_MOVING, NUM_FRAMES, 2))
    for frame in range(NUM_FRAMES):
        turned = (moving - moving.mean(axis=0)) @ _rotation(5 * frame).T + moving.mean(axis=0)
        scene = np.concatenate([static, turned + frame * np.array([0.5, 0.05, 0.3])])
        seen = (scene - frame * np.array([0.1, 0, 0.6])) @ _rotation(0.4 * frame)
        points[:, frame] = FOCAL * seen[:, :2] / seen[:, 2:] + CENTRE
    points += rng.normal(0, 0.02, points.shape)
    visible = rng.random(points.shape[:2]) < 1 - hidden
    visible[0] = hidden == 0  # as one trajectory of the release
    return points, visible, np.repeat([1, 2], [NUM_STATIC, NUM_MOVING])


@pytest.fixture(scope="session")
def write_clip():
    """Writes one clip as the release does; `seed` makes another one of it, `hidden` is the share of hidden points."""

    def write(path, seed=0, hidden=0.1):
        points, visible, labels = _clip(seed, hidden)
        shown = np.where(visible[..., None], np.concatenate([points, np.ones((*visible.shape, 1))], axis=-1), 0)
        fields = {"ySparse": shown.transpose(2, 0, 1), "visibleSparse": visible.astype(np.uint8)}
        path.parent.mkdir(parents=True, exist_ok=True)
        savemat(path, {"Data": {**fields, "GtLabel": labels.astype(np.uint8)[:, None]}})
        return path

    return write


@pytest.fixture(scope="session")
def clips(write_clip, tmp_path_factory):
    """Root of a data set kt3dmoseg of two clips."""
    root = tmp_path_factory.mktemp("kt3dmoseg")
    for seed, name in enumerate(("Seq005_Clip01", "Seq028_clip03")):
        write_clip(root / f"{name}_Tracks.mat", seed)
    return root
