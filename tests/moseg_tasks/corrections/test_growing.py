import numpy as np
import pytest

from moseg.schemas.parameters import AppearanceParams, GrowingParams, RefinementParams
from moseg.tasks.corrections.growing import Grower, grow_object

SHAPE = (96, 160)
PARAMS = Grower(GrowingParams(min_area=0.002), AppearanceParams(), RefinementParams())
NONE = np.zeros((0, 2))


def grow(scene, points, not_points=NONE, t=5, moves=True, params=PARAMS):
    saliency = np.where(scene.discs[t] & moves, 0.9, 0.02).astype(np.float32)
    velocity = scene.forward[t] if moves else np.zeros_like(scene.forward[t])
    evidence = saliency, np.stack([-velocity, velocity])
    return grow_object(scene.frames[t], *evidence, np.array(points, float), np.array(not_points, float), params)


@pytest.mark.parametrize("offset", [(0, 0), (8, 5), (-10, 3)])
def test_a_click_on_a_moving_disc_finds_the_disc(offset, render, iou):
    scene = render()
    mask = grow(scene, [(50 + offset[0], 45 + offset[1])])
    assert mask.dtype == bool and mask.shape == SHAPE
    assert iou(mask, scene.discs[5]) > 0.9


def test_a_click_on_a_disc_of_the_backgrounds_colour_finds_it_by_motion(render, iou):
    scene = render(same_colour=True)
    assert iou(grow(scene, [(50, 45)]), scene.discs[5]) > 0.75


def test_a_click_on_a_disc_at_rest_finds_it_by_colour(render, iou):
    scene = render()
    assert iou(grow(scene, [(50, 45)], moves=False), scene.discs[5]) > 0.85


def test_a_click_on_the_background_does_not_take_the_disc(render):
    scene = render()
    mask = grow(scene, [(120, 20)])
    assert mask[20, 120] and (mask & scene.discs[5]).sum() < 0.05 * scene.discs[5].sum()
    assert mask.mean() < 0.2


def test_points_on_two_parts_take_both(render, iou):
    scene, other = render(), render(start=(90, 60), speed=(0, 0))
    t = 5
    both = np.where(other.discs[t][..., None], other.frames[t], scene.frames[t])
    scene.frames[t] = both
    scene.discs[t] = scene.discs[t] | other.discs[t]
    scene.forward[t] = np.where(scene.discs[t][..., None], np.float32([4, 1]), np.float32(0))
    assert iou(grow(scene, [(50, 45)]), render().discs[t]) > 0.9
    assert iou(grow(scene, [(50, 45), (90, 60)]), scene.discs[t]) > 0.9


def test_points_beside_it_are_left_out(render):
    scene = render()
    mask = grow(scene, [(44, 45)], [(60, 45)])
    assert mask[45, 44] and not mask[45, 60]


def test_an_object_on_a_frame_without_neighbours_grows_by_colour(render, iou):
    scene = render()
    nothing = np.zeros(SHAPE, np.float32), np.zeros((2, *SHAPE, 2), np.float32)
    mask = grow_object(scene.frames[5], *nothing, np.array([[50.0, 45]]), NONE, PARAMS)
    assert iou(mask, scene.discs[5]) > 0.85
