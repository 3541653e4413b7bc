import pickle

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.synthetic import SCENES, render_scene
from moseg.workflows.sources import SceneDepth, SceneFlow, SceneFrames, SceneMasks, SceneTracks


@pytest.fixture
def tiny(monkeypatch):
    """Return a declared scene, small enough to render at once."""
    scene = SCENES["two-motions"].model_copy(update={"height": 30, "width": 53, "num_frames": 3})
    monkeypatch.setitem(SCENES, "tiny", scene)
    return scene


def test_sources_return_the_rendered_arrays(tiny):
    rendered = render_scene(tiny)
    frames = SceneFrames("tiny")
    np.testing.assert_array_equal(list(frames.read()), rendered.images)
    assert frames.describe() == ((30, 53), None)
    assert frames.num_frames() == 3
    assert frames.chunks(1) == (frames,)
    for which in ("moving", "objects"):
        indices, labels = zip(*SceneMasks("tiny", which).read(), strict=True)
        assert indices == (0, 1, 2)
        np.testing.assert_array_equal(labels, getattr(rendered, which))
    np.testing.assert_array_equal(list(SceneDepth("tiny").read()), rendered.inverse_depth)
    np.testing.assert_array_equal(list(SceneFlow("tiny", "forward").read()), rendered.flow_forward)
    np.testing.assert_array_equal(list(SceneFlow("tiny", "backward").read()), rendered.flow_backward)
    points, visible = SceneTracks("tiny").read()
    np.testing.assert_array_equal(points, rendered.points)
    np.testing.assert_array_equal(visible, rendered.visible)


def test_arrays_have_the_layout_that_is_stored(tiny):
    assert next(SceneFrames("tiny").read()).dtype == np.uint8
    assert next(SceneMasks("tiny").read())[1].dtype == np.uint16
    assert next(SceneDepth("tiny").read()).dtype == np.float32
    assert next(SceneFlow("tiny", "forward").read()).dtype == np.float32
    assert [array.dtype for array in SceneTracks("tiny").read()] == [np.float32, bool]


def test_pickled_sources_keep_their_fingerprint(tiny):
    kinds = (SceneFrames, SceneMasks, SceneDepth, SceneTracks)
    sources = [kind("tiny") for kind in kinds] + [SceneFlow("tiny", "forward"), SceneFlow("tiny", "backward")]
    copies = pickle.loads(pickle.dumps(sources))
    assert [copy.fingerprint() for copy in copies] == [source.fingerprint() for source in sources]
    assert len({source.fingerprint() for source in sources}) == len(sources)


def test_another_declaration_under_the_same_name_is_another_source(tiny, monkeypatch):
    before, images = SceneFrames("tiny").fingerprint(), list(SceneFrames("tiny").read())
    monkeypatch.setitem(SCENES, "tiny", tiny.model_copy(update={"noise": 5.0}))
    assert SceneFrames("tiny").fingerprint() != before
    assert not np.array_equal(list(SceneFrames("tiny").read()), images)


def test_an_unknown_scene_gets_the_nearest_name():
    with pytest.raises(InputError, match="did you mean 'two-motions'"):
        SceneFrames("two_motion").describe()
