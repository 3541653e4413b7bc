"""Frame pairs of a section to which fundamental matrices are fitted."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.affinity import RESIDUAL_SIZE
from moseg.workflows.stages.fundamental import pair_params, pair_tracks

NUM_FRAMES, NUM_TRACKS = 10, 4


class _Arrays(dict):
    """Arrays by name, as an artifact's view gives them."""

    def cached(self, name):
        return self[name]


@pytest.fixture
def inputs():
    """Tracks of one object whose x is the frame's number."""
    points = np.zeros((NUM_TRACKS, NUM_FRAMES, 2), np.float32)
    points[..., 0] = np.arange(NUM_FRAMES)
    visible = np.ones((NUM_TRACKS, NUM_FRAMES), bool)
    owner = np.ones(NUM_TRACKS, np.uint16)
    tracks = _Arrays(points=points, visible=visible, object=owner)
    return {"tracks": tracks, "linking": _Arrays(identity=np.array([[0, 1]]))}


@pytest.mark.parametrize(("step", "firsts"), [(1, [0, 1, 2, 3, 4, 5, 6]), (3, [0, 3, 6])])
def test_pairs_begin_at_multiples_of_the_step_and_keep_their_gap(inputs, step, firsts):
    config = PipelineConfig.model_validate({"fundamental": {"step": step}})
    pairs = list(pair_tracks(pair_params(config, 0, 7, 2), inputs))
    assert [points0[0, 0] for points0, _, _ in pairs] == firsts
    assert all((points1 - points0 == [2, 0]).all() for points0, points1, _ in pairs)


def test_a_run_of_pairs_covers_as_many_frames_with_a_step():
    def static_pairs(step, view):
        config = PipelineConfig.model_validate({"fundamental": {"step": step}, "affinity": {"static_pairs": 16}})
        return RESIDUAL_SIZE.params(config, view)["affinity"]["static_pairs"]

    assert [static_pairs(step, "trajs") for step in (1, 3, 16)] == [16, 5, 2]
    assert static_pairs(3, "oc") == 16
