import numpy as np
import pytest

from moseg.schemas.parameters import AppearanceParams, GrowingParams, RefinementParams
from moseg.tasks.corrections.growing import Grower, grow_object

SHAPE = (96, 160)
PARAMS = Grower(GrowingParams(min_area=0.002), AppearanceParams(), RefinementParams())
NONE = np.zeros((0, 2))
ROWS, COLUMNS = np.ogrid[: SHAPE[0], : SHAPE[1]]


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


def test_a_click_takes_what_moves_alike_and_not_what_touches_it(render, iou):
    scene = render(same_colour=True)
    left, right = ((abs(COLUMNS - x) <= 14) & (abs(ROWS - 45) <= 14) for x in (50, 79))
    velocity = np.where(left[..., None], np.float32([4, 0]), np.where(right[..., None], np.float32([-4, 0]), 0))
    saliency = np.where(left | right, 0.9, 0.02).astype(np.float32)
    flows = np.stack([-velocity, velocity]).astype(np.float32)
    mask = grow_object(scene.frames[5], saliency, flows, np.array([[50.0, 45.0]]), NONE, PARAMS)
    assert iou(mask, left) > 0.6 and (mask & right).sum() < 0.2 * right.sum()


def test_no_region_that_covers_a_point_beside_it_is_taken(render):
    scene = render(same_colour=True)
    discs = [(COLUMNS - x) ** 2 + (ROWS - 45) ** 2 <= 14**2 for x in (30, 130)]
    bridge = (abs(ROWS - 45) <= 10) & (COLUMNS > 30) & (COLUMNS < 130)
    saliency = np.where(discs[0] | discs[1], 0.9, np.where(bridge, 0.7, 0.02)).astype(np.float32)
    velocity = np.where((saliency > 0.1)[..., None], np.float32([3, 0]), np.float32(0))
    inside, beside = np.array([[30.0, 45.0]]), np.array([[130.0, 45.0]])
    mask = grow_object(scene.frames[5], saliency, np.stack([-velocity, velocity]), inside, beside, PARAMS)
    assert (mask & discs[0]).sum() > 0.6 * discs[0].sum()
    assert (mask & bridge & (COLUMNS > 50)).sum() < 100


def test_a_click_on_the_last_pixel_of_a_cell_is_in_that_cell():
    frame = np.full((96, 160, 3), 90, np.uint8)
    frame[32:64, 64:96] = (200, 40, 40)
    saliency = np.full((24, 40), 0.02, np.float32)
    saliency[8:16, 16:24] = 0.9
    params = PARAMS._replace(growing=GrowingParams(min_area=0.002, spot=0, band=1))
    still = np.zeros((2, 24, 40, 2), np.float32)
    mask = grow_object(frame, saliency, still, np.array([[95.0, 63.0]]), NONE, params)
    assert mask[32:64, 64:96].mean() > 0.9
