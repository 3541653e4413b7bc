"""Nothing moves in the scenes of ``still``, and their parallax is strong."""

import numpy as np
import pytest

from moseg.tasks.synthetic import SCENES, STILL_SCENES, render_scene

HEIGHT, WIDTH = 60, 106


@pytest.mark.parametrize("name", STILL_SCENES)
def test_nothing_moves_but_the_camera(name):
    scene = STILL_SCENES[name].model_copy(update={"height": HEIGHT, "width": WIDTH, "num_frames": 2})
    rendered = render_scene(scene)
    assert scene.num_motions == 1 and not rendered.moving.any()
    flow = rendered.flow_forward[0].reshape(-1, 2)
    x, y = np.meshgrid(np.linspace(-1, 1, WIDTH), np.linspace(-0.6, 0.6, HEIGHT))
    x, y = x.ravel(), y.ravel()
    design = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    left = np.linalg.norm(flow - design @ np.linalg.lstsq(design, flow)[0], axis=1)
    # Two-thirds of a pixel at the declared size that a quadratic flow without depth leaves somewhere.
    assert np.percentile(left, 99) * STILL_SCENES[name].width / WIDTH > 0.66


def test_names_differ_from_those_of_the_synthetic_suite():
    assert not STILL_SCENES.keys() & SCENES.keys()
