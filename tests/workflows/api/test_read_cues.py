"""The cues of a result, read from the store."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.api import segment_video


@pytest.fixture(scope="module")
def kept(segmented, config, tmp_path_factory):
    """The squares, by a run that kept its cues; the background moves by (-1, 0) px a frame."""
    store = tmp_path_factory.mktemp("kept") / "store"
    return segment_video(segmented.frames, config, store=store, progress=False, keep_cues=True)


def enlarged(mask: np.ndarray) -> np.ndarray:
    """Return a mask of a small frame on the working grid, which has twice its sides."""
    return mask.repeat(2, axis=0).repeat(2, axis=1)


def test_flow_leads_to_the_next_frame(kept):
    assert kept.cues == ("saliency", "flow", "residual_flow")
    labels = kept.labels[3]
    flow, residual = kept.cue("flow", 3), kept.cue("residual_flow", 3)
    assert flow.dtype == residual.dtype == np.float32 and flow.shape == (*kept.analysed_shape, 2)
    motions = {tuple(np.median(flow[labels == label], axis=0).round(1)) for label in (1, 2)}
    assert motions == {(3, 0), (-1, 3)}
    np.testing.assert_allclose(np.median(flow[labels == 0], axis=0), (-1, 0), atol=0.1)
    labels = enlarged(labels)
    motions = {tuple(np.median(residual[labels == label], axis=0).round(1)) for label in (1, 2)}
    assert motions == {(4, 0), (0, 3)}
    np.testing.assert_allclose(np.median(residual[labels == 0], axis=0), (0, 0), atol=0.1)


def test_saliency_is_high_where_something_moves(kept):
    saliency, moving = kept.cue("saliency", -1), enlarged(kept.labels[-1] > 0)
    assert saliency.dtype == np.float32 and saliency.min() >= 0 and saliency.max() <= 1
    assert np.median(saliency[moving]) > 0.5 > 0.1 > np.median(saliency[~moving])


def test_given_depth_is_read(segmented, config, tmp_path):
    maps = np.random.default_rng(0).uniform(1, 2, (10, *segmented.result.analysed_shape)).astype(np.float32)
    (tmp_path / "depth").mkdir()
    for index, values in enumerate(maps):
        np.save(tmp_path / "depth" / f"{index:05d}.npy", values)
    given = {"depth": tmp_path / "depth", "store": tmp_path / "store"}
    result = segment_video(segmented.frames, config, progress=False, **given)
    np.testing.assert_array_equal(result.cue("inverse_depth", 9), maps[9])


def test_a_cue_that_is_not_there_is_named(kept, segmented):
    with pytest.raises(InputError, match=r"no such cue.*'depth'.*saliency, flow, residual_flow"):
        kept.cue("depth", 0)
    with pytest.raises(InputError, match=r"flow of frame 2 is missing in the store; .*keep_cues=True"):
        segmented.result.cue("flow", 2)


def test_frames_without_a_cue_are_named(kept):
    with pytest.raises(IndexError, match="no frame 10: the video has 10"):
        kept.cue("saliency", 10)
    with pytest.raises(IndexError, match="no frame -11: the video has 10"):
        kept.overlay(-11)
    with pytest.raises(IndexError, match="flow leads to the next frame, and frame 9 is the last one"):
        kept.cue("flow", -1)
