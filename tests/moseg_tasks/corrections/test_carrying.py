import numpy as np
import pytest

from moseg.schemas.parameters import AppearanceParams, CarryingParams, RefinementParams
from moseg.tasks.corrections.carrying import Carrier, carry_mask, outline_mask, start_carrying
from moseg.tasks.frame_grid import flow_on_grid

SHAPE, RADIUS = (96, 160), 16
PARAMS = Carrier(CarryingParams(), AppearanceParams(), RefinementParams())
ROWS, COLUMNS = np.ogrid[: SHAPE[0], : SHAPE[1]]


def carry(scene, mask, start=0, params=PARAMS):
    """Return the masks of all frames after `start`."""
    carried, masks = start_carrying(scene.frames[start], mask, SHAPE, params), []
    for t in range(start + 1, len(scene.frames)):
        carried = carry_mask(carried, scene.frames[t], scene.backward[t - 1], scene.forward[t - 1], params)
        masks.append(outline_mask(carried, scene.frames[t], params.refinement))
    return masks


def test_a_painted_disc_follows_the_disc(render, iou):
    scene = render()
    for mask, disc in zip(carry(scene, scene.discs[0]), scene.discs[1:], strict=True):
        assert mask.dtype == bool and iou(mask, disc) > 0.9


def test_it_follows_the_disc_against_time(render, iou):
    scene = render()
    last = len(scene.frames) - 1
    carried = start_carrying(scene.frames[last], scene.discs[last], SHAPE, PARAMS)
    for t in range(last - 1, -1, -1):
        carried = carry_mask(carried, scene.frames[t], scene.forward[t], scene.backward[t], PARAMS)
        assert iou(outline_mask(carried, scene.frames[t], PARAMS.refinement), scene.discs[t]) > 0.9


def test_a_part_of_the_disc_stays_that_part(render, iou):
    scene = render()
    for t, mask in enumerate(carry(scene, scene.discs[0] & (ROWS < 40)), start=1):
        part = scene.discs[t] & (40 + t > ROWS)
        assert iou(mask, part) > 0.8


def test_a_part_of_the_background_stays_where_it_is(render, iou):
    scene = render()
    spot = (COLUMNS - 120) ** 2 + (ROWS - 20) ** 2 <= 100
    for mask in carry(scene, spot):
        assert iou(mask, spot) > 0.85


def test_a_mask_that_is_too_large_loses_the_background_that_stays_behind(render, iou):
    scene = render()
    generous = (COLUMNS - 30) ** 2 + (ROWS - 40) ** 2 <= (RADIUS + 4) ** 2
    assert iou(generous, scene.discs[0]) < 0.7
    assert iou(carry(scene, generous)[-1], scene.discs[-1]) > iou(generous, scene.discs[0]) + 0.05


def test_what_hides_behind_another_object_is_lost_and_does_not_paint_it(render, iou):
    scene = render(num_frames=30, speed=(3, 0), bar=(60, 110))
    hidden = next(t for t, disc in enumerate(scene.discs) if not disc.any())
    masks = carry(scene, scene.discs[0])
    assert iou(masks[5], scene.discs[6]) > 0.85
    for mask in masks[hidden:]:
        assert not mask.any()
    bar = (COLUMNS >= 62) & (COLUMNS < 110) & (ROWS >= 0)
    assert max((mask & bar).sum() for mask in masks) < 0.05 * scene.discs[0].sum()


def test_it_is_lost_at_a_cut(render):
    scene, other = render(num_frames=6), np.random.default_rng(1)
    noise = other.integers(0, 255, (*SHAPE, 3)).astype(np.uint8)
    scene.frames[3:] = [noise] * 3
    scene.forward[2], scene.backward[2] = (other.normal(0, 20, (*SHAPE, 2)).astype(np.float32) for _ in range(2))
    masks = carry(scene, scene.discs[0])
    assert masks[1].any() and not any(mask.any() for mask in masks[2:])


def test_it_leaves_the_frame_with_what_it_covers(render):
    scene = render(num_frames=20, speed=(-4, 0))
    masks = carry(scene, scene.discs[0])
    assert masks[1].any() and not masks[-1].any()


@pytest.mark.parametrize("empty", [True, False])
def test_nothing_and_everything_can_be_carried(empty, render):
    scene = render(num_frames=4)
    for mask in carry(scene, np.full(SHAPE, not empty)):
        assert mask.mean() == 0 if empty else mask.mean() > 0.9


def test_colours_enlarge_a_mask_by_no_more_than_its_growth(render):
    scene = render(num_frames=10, speed=(0, 0))
    small = (COLUMNS - 30) ** 2 + (ROWS - 40) ** 2 <= 9**2
    grid = (SHAPE[0] // 2, SHAPE[1] // 2)
    still, shares = np.zeros((*grid, 2), np.float32), {}
    for growth in (0.0, 0.005, 0.5):
        params = PARAMS._replace(carrying=CarryingParams(growth=growth, colour=2))
        carried = start_carrying(scene.frames[0], small, grid, params)
        for frame in scene.frames[1:]:
            carried = carry_mask(carried, frame, still, still, params)
        shares[growth] = carried.share.sum() / carried.area
    assert shares[0.0] == pytest.approx(1, abs=0.01)
    assert 1.02 < shares[0.005] < 1.005**9 + 0.01 < shares[0.5]


def test_an_outline_follows_the_edges_at_full_size(render, iou):
    scene = render(num_frames=2)
    grid = (SHAPE[0] // 2, SHAPE[1] // 2)
    carried = start_carrying(scene.frames[0], scene.discs[0], grid, PARAMS)
    flows = (flow_on_grid(flow[0], grid, SHAPE) for flow in (scene.backward, scene.forward))
    carried = carry_mask(carried, scene.frames[1], *flows, PARAMS)
    assert carried.share.shape == grid
    assert iou(outline_mask(carried, scene.frames[1], PARAMS.refinement), scene.discs[1]) > 0.85


def test_carrying_draws_no_random_numbers_and_changes_no_input(render):
    scene = render(num_frames=3)
    copies = [each.copy() for each in (*scene.frames, *scene.forward, *scene.backward, *scene.discs)]
    first, second = carry(scene, scene.discs[0]), carry(scene, scene.discs[0])
    np.testing.assert_array_equal(first, second)
    for before, after in zip(copies, (*scene.frames, *scene.forward, *scene.backward, *scene.discs), strict=True):
        np.testing.assert_array_equal(before, after)


def test_a_disc_that_leaps_farther_than_it_is_wide_is_followed(render, iou):
    scene = render(num_frames=3, speed=(40, 3))
    for mask, disc in zip(carry(scene, scene.discs[0]), scene.discs[1:], strict=True):
        assert iou(mask, disc) > 0.6
