import math
from functools import cache

import numpy as np
import pytest

from moseg.schemas.parameters import FlowParams, SaliencyParams
from moseg.tasks.flow.dis import estimate_flow
from moseg.tasks.saliency import choose_background, estimate_saliency
from moseg.tasks.saliency.choice import LAYERS
from moseg.tasks.saliency.gric import gric
from moseg.tasks.synthetic import SCENES, render_scene

PARAMS = SaliencyParams()


@pytest.fixture(scope="module")
def pairs():
    """Exact flow of a few pairs of a scene; its images are not painted."""

    @cache
    def of(name):
        scene = SCENES[name].model_copy(update={"num_frames": 14})
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("moseg.tasks.synthetic.render._render_images", lambda *arguments: None)
            return list(render_scene(scene).flow_forward[::6])

    return of


def test_gric_by_hand():
    residual = np.array([0.0, 0.5, 100.0])
    expected = (0 + 4 + 2 * 2 + 3 * 2 * math.log(4) + 6 * math.log(12)) / 3
    assert gric(residual, noise=0.25, dimension=2, num_parameters=6) == pytest.approx(expected)


def test_gric_prefers_the_smaller_model_of_equal_fit_and_the_larger_of_better_fit():
    noise = np.random.default_rng(0).normal(0, 0.2, 500)
    layers, rigid = (gric(noise, 0.25, dimension, 6) for dimension in (2, 3))
    assert layers < rigid < gric(noise + 2, 0.25, 2, 6)


@pytest.mark.parametrize("name", ["forward-drive-epipolar-car", "nothing-moves", "strong-parallax"])
def test_a_scene_with_parallax_over_a_ground_is_rigid(pairs, name):
    choice = choose_background(pairs(name), PARAMS)
    assert choice.model == "rigid" and choice.gain > 0.05
    assert choice.nearer_below == 1 and choice.tilt < 0.1


@pytest.mark.parametrize("name", ["pure-rotation", "static-camera", "zoom", "occlusion"])
def test_a_scene_without_much_parallax_keeps_its_layers(pairs, name):
    assert choose_background(pairs(name), PARAMS).model == "layers"


def test_a_world_on_its_head_has_no_ground(pairs):
    upside_down = [np.ascontiguousarray(flow[::-1]) * np.float32([1, -1]) for flow in pairs("strong-parallax")]
    choice = choose_background(upside_down, PARAMS)
    assert choice.model == "layers"
    assert choice.nearer_below < 1 or choice.ground_share < PARAMS.ground_share


def test_a_camera_that_turns_tells_its_focal_length(pairs):
    # 0.95 of the frame's width by its declaration.
    assert choose_background(pairs("handheld-jitter"), PARAMS).focal == 1.0


def test_the_model_can_be_asked_for(pairs):
    flows = pairs("static-camera")
    assert choose_background(flows, PARAMS.model_copy(update={"background": "rigid"})).model == "rigid"
    flows = pairs("strong-parallax")
    assert choose_background(flows, PARAMS.model_copy(update={"background": "layers"})) == LAYERS


def test_the_choice_is_the_same_each_time(pairs):
    flows = pairs("forward-drive-epipolar-car")
    assert choose_background(flows, PARAMS) == choose_background(flows, PARAMS)


@pytest.mark.parametrize("shape", [(1, 1), (7, 3), (30, 40)])
def test_frames_too_small_for_a_camera_motion_keep_their_layers(shape):
    assert choose_background([np.ones((*shape, 2), np.float32)], PARAMS).model == "layers"
    assert choose_background([], PARAMS) == LAYERS


@pytest.fixture(scope="module")
def sliding():
    """Two frames of the scene with strong parallax, their flows both ways, and what moves in the first."""
    scene = render_scene(SCENES["strong-parallax"].model_copy(update={"num_frames": 3}))
    frames = scene.images
    flows = [estimate_flow(frames[1], other, FlowParams()) for other in (frames[0], frames[2])]
    return frames, flows, scene.moving[1] > 0, scene.objects[1]


def test_a_rigid_background_leaves_the_mover_alone_where_layers_leave_all_that_is_near(sliding):
    frames, flows, mover, objects = sliding
    rigid = LAYERS._replace(model="rigid")
    salient, with_layers = (
        estimate_saliency(frames[1], frames[0], frames[2], *flows, PARAMS, choice).saliency > 0.5
        for choice in (rigid, LAYERS)
    )
    pillar = objects == 1
    assert with_layers[pillar].mean() > 0.5
    assert salient[pillar].mean() < 0.05
    assert salient[mover].mean() > 0.9
    assert salient[~mover].mean() < 0.02
