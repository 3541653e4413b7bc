"""Masks of objects of tracks: votes of the nearest tracks by distance, brightness and motion."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import LocalColourParams, RefinementParams, TrackMaskParams
from moseg.tasks.proposals import track_masks as kernel
from moseg.tasks.proposals.track_masks import number_seen, track_masks

PARAMS, VOTES, OUTLINES = TrackMaskParams(), TrackMaskParams(softness=0.0), RefinementParams()
SHAPE = (101, 151)
NUM_FRAMES = 3
BOX = (slice(30, 70), slice(40, 100))
"""Rows and columns of the object in the first frame; it moves by STEP px/frame."""
STEP = 2


def _scene(spacing=8):
    """Return frames, flows to the next frame, tracks, their visibility and objects, and the true masks."""
    frames = np.full((NUM_FRAMES, *SHAPE, 3), 60, np.uint8)
    flows = np.zeros((NUM_FRAMES, *SHAPE, 2), np.float32)
    truth = np.zeros((NUM_FRAMES, *SHAPE), bool)
    for number in range(NUM_FRAMES):
        box = BOX[0], slice(BOX[1].start + STEP * number, BOX[1].stop + STEP * number)
        frames[number][box], flows[number][box], truth[number][box] = 180, (STEP, 0), True
    y, x = np.mgrid[3 : SHAPE[0] : spacing, 3 : SHAPE[1] : spacing].reshape(2, -1)
    objects = truth[0][y, x].astype(np.uint16)
    start = np.stack([x, y], axis=1).astype(np.float32)
    points = start[:, None] + objects[:, None, None] * np.float32([STEP, 0]) * np.arange(NUM_FRAMES)[:, None]
    return frames, flows, points.astype(np.float32), np.ones(points.shape[:2], bool), objects, truth


def _iou(found, truth):
    return (found & truth).sum() / (found | truth).sum()


def test_an_object_is_cut_out_along_its_outline():
    *scene, truth = _scene()
    masks = track_masks(*scene, 0, PARAMS, OUTLINES)
    assert masks.dtype == np.uint16
    assert all(_iou(mask > 0, true) > 0.95 for mask, true in zip(masks, truth, strict=True))


@pytest.mark.parametrize("cue", ["grey", "motion"])
def test_either_cue_alone_finds_the_outline_better_than_distance(cue):
    frames, flows, points, visible, objects, truth = _scene()
    if cue == "grey":
        flows = np.zeros_like(flows)
        visible = visible.copy()
        visible[:, 1:] = False
    else:
        frames = np.full_like(frames, 60)
    blind = track_masks(
        frames[:1] * 0, np.zeros_like(flows[:1]), points, visible & [True, False, False], objects, 0, VOTES, OUTLINES
    )
    found = track_masks(frames[:1], flows[:1], points, visible, objects, 0, VOTES, OUTLINES)
    assert _iou(found[0] > 0, truth[0]) > max(0.93, _iou(blind[0] > 0, truth[0]))


def test_edges_of_the_frame_draw_the_outline():
    frames, *scene, truth = _scene(spacing=13)
    # Flow that is smeared over the outline, and contrast that tells votes little.
    frames = np.where(frames > 100, 80, frames).astype(np.uint8)
    scene[0] = np.stack([cv2.GaussianBlur(flow, (0, 0), 8) for flow in scene[0]])
    coarse, found = (track_masks(frames, *scene, 0, params, OUTLINES) for params in (VOTES, PARAMS))
    assert _iou(found > 0, truth) > 0.98 and _iou(coarse > 0, truth) < 0.92
    rows, columns = (range(0, side - 1, kernel.STEP) for side in SHAPE)
    for shift in (0, 1):
        np.testing.assert_array_equal(coarse[:, rows][..., columns], coarse[:, rows][..., shift + np.array(columns)])


def test_an_outline_is_as_soft_as_asked():
    mask = np.arange(40)[None].repeat(30, axis=0) < 20
    # The centres of the cells are 1, 3, 5, ... px from the outline.
    distance = kernel.STEP * (19.5 - np.arange(40))
    expected = np.broadcast_to(1 / (1 + np.exp(-distance / 8)), mask.shape)
    np.testing.assert_allclose(kernel._soften(mask, 8.0), expected, rtol=1e-5)
    assert (kernel._soften(mask | True, 8.0) > 0.99).all() and (kernel._soften(mask & False, 8.0) < 0.01).all()


def test_smoothing_removes_specks():
    frames, flows, *tracks, _ = _scene()
    noisy = np.where(np.random.default_rng(0).random((*SHAPE, 1)) < 0.1, 255 - frames[0], frames[0])
    rough, smooth = (
        kernel._label_grid(noisy, flows[0], *kernel._seen_tracks(*tracks, 0), TrackMaskParams(**changes))
        for changes in ({"grey_blur": 0.3, "smoothing": radius} for radius in (0, 2))
    )
    num_changes = [np.count_nonzero(np.diff(grid, axis=1)) for grid in (rough, smooth)]
    assert num_changes[1] < 0.8 * num_changes[0]


def test_outlines_of_neighbours_stay_theirs():
    frames, flows, points, visible, objects, truth = _scene()
    is_right = points[:, 0, 0] > BOX[1].stop
    objects[is_right] = 2
    frames[:, :, BOX[1].stop + 8 :] = 120
    masks = track_masks(frames, flows, points, visible, objects, 0, PARAMS, OUTLINES)
    assert _iou(masks == 1, truth) > 0.95
    assert (masks[0, 20:80, BOX[1].stop + 12 : 140] == 2).all()


def test_no_pixel_is_farther_from_its_object_than_the_radius():
    frames, flows, points, visible, objects, _ = _scene()
    objects[np.flatnonzero(objects)[1:]] = 0
    only = np.flatnonzero(objects)[0]
    # The only other tracks are far away.
    kept = [only, 0]
    mask = track_masks(
        frames[:1], flows[:1], points[kept], visible[kept], objects[kept], 0, TrackMaskParams(radius=10.0), OUTLINES
    )[0]
    y, x = np.nonzero(mask)
    assert len(x)
    assert np.hypot(x - points[only, 0, 0], y - points[only, 0, 1]).max() < 10 + 2 * kernel.STEP


def _beside_a_plain_road():
    """Return a scene whose background has tracks far from the object only; flow is smeared over the outline."""
    frames, flows, points, visible, objects, truth = _scene(spacing=6)
    near = cv2.dilate(truth[0].astype(np.uint8), np.ones((81, 81))) > 0
    x, y = points[:, 0].astype(int).T
    kept = (objects > 0) | ~near[y, x]
    assert (objects[kept] == 0).any()
    flows = np.stack([cv2.GaussianBlur(flow, (0, 0), 12) for flow in flows])
    return frames, flows, points[kept], visible[kept], objects[kept], truth


def test_what_has_tracks_on_one_side_only_stays_out():
    frames, *scene, truth = _beside_a_plain_road()
    plain = np.full_like(frames, 60)
    wide, between = (
        track_masks(plain, *scene, 0, TrackMaskParams(softness=0.0, closing=closing), OUTLINES) > 0
        for closing in (0.0, PARAMS.closing)
    )
    assert (between & truth).sum() > 0.97 * truth.sum()
    assert (between & ~truth).sum() < 0.3 * (wide & ~truth).sum()


def test_colours_of_both_sides_draw_the_outline():
    frames, flows, points, visible, objects, truth = _scene(spacing=6)
    # Tracks beside the object follow it too.
    strays = cv2.dilate(truth[0].astype(np.uint8), np.ones((21, 21))) > 0
    x, y = points[:, 0].astype(int).T
    objects = strays[y, x].astype(np.uint16)
    scene = frames, flows * 0, points, visible, objects
    without, found = (track_masks(*scene, 0, PARAMS, OUTLINES, colours) > 0 for colours in (None, LocalColourParams()))
    assert _iou(found, truth) > 0.95 > 0.8 > _iou(without, truth)


def test_few_tracks_know_the_outline_less_well():
    place = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0)), axis=-1).reshape(-1, 2)
    margins = [kernel._margin(place * spacing, PARAMS) for spacing in (2, 9, 90)]
    assert margins == [PARAMS.margin, 9, 2 * PARAMS.margin]
    assert kernel._margin(place[:1], PARAMS) == 2 * PARAMS.margin


def _two_parts():
    """Return labels of an object of two parts and of another one; the first part has two holes."""
    labels = np.zeros((30, 60), np.uint16)
    labels[5:25, 5:25], labels[5:10, 40:50], labels[20:25, 40:50] = 2, 2, 3
    labels[8:12, 8:12] = labels[16:20, 16:20] = 0
    return labels


def test_parts_and_holes_without_a_track_are_no_part_and_no_hole():
    labels = _two_parts()
    place, objects = np.float32([[6, 6], [17, 17], [45, 22], [45, 7]]), np.array([2, 0, 3, 3], np.uint16)
    expected = labels.copy()
    # The first hole has no track, the second one the background's; the object's other part has another object's.
    expected[8:12, 8:12], expected[5:10, 40:50] = 2, 0
    np.testing.assert_array_equal(kernel._tidy(labels, place, objects), expected)


def test_an_objects_own_track_is_no_reason_for_a_hole():
    labels = _two_parts()
    tidied = kernel._tidy(labels, np.float32([[6, 6], [17, 17]]), np.array([2, 2], np.uint16))
    assert (tidied[5:25, 5:25] == 2).all()


@pytest.mark.parametrize(("away", "is_kept"), [(3, True), (4, False)])
def test_a_track_a_little_outside_of_a_part_is_the_parts(away, is_kept):
    place = np.float32([[6, 6], [49 + away, 7]])
    tidied = kernel._tidy(_two_parts(), place, np.array([2, 2], np.uint16))
    assert (tidied[5:10, 40:50] == 2).all() == is_kept


def test_an_object_whose_tracks_lie_outside_keeps_its_largest_part():
    tidied = kernel._tidy(_two_parts(), np.float32([[30, 15]]), np.array([2], np.uint16))
    assert (tidied[5:8, 5:25] == 2).all()
    assert not (tidied[5:10, 40:50] == 2).any()


def test_without_moving_tracks_there_is_no_mask():
    frames, flows, points, visible, objects, _ = _scene()
    assert not track_masks(frames, flows, points, visible, objects * 0, 0, PARAMS, OUTLINES).any()
    assert not track_masks(frames, flows, points, visible & False, objects, 0, PARAMS, OUTLINES).any()
    assert not track_masks(frames, flows, points[:0], visible[:0], objects[:0], 0, PARAMS, OUTLINES).any()


def test_frames_are_counted_from_the_first_one_of_the_masks():
    frames, flows, *tracks, _ = _scene()
    whole = track_masks(frames, flows, *tracks, 0, PARAMS, OUTLINES)
    np.testing.assert_array_equal(track_masks(frames[1:], flows[1:], *tracks, 1, PARAMS, OUTLINES), whole[1:])


def test_blocks_that_are_labelled_at_once_have_the_labels_of_their_pixels(monkeypatch):
    frames, flows, points, visible, objects, _ = _scene()
    objects[points[:, 0, 0] > 120] = 2
    expected = track_masks(frames, flows, points, visible, objects, 0, PARAMS, OUTLINES)

    def decide_nothing(candidates, *more):
        return np.zeros(candidates.shape, np.uint16), np.zeros_like(candidates)

    label_blocks, decided = kernel._label_blocks, []
    monkeypatch.setattr(kernel, "_label_blocks", lambda *more: decided.append(label_blocks(*more)) or decided[-1])
    track_masks(frames[:1], flows[:1], points, visible, objects, 0, PARAMS, OUTLINES)
    assert decided[0][1].mean() > 0.1
    monkeypatch.setattr(kernel, "_label_blocks", decide_nothing)
    np.testing.assert_array_equal(track_masks(frames, flows, points, visible, objects, 0, PARAMS, OUTLINES), expected)


def test_fewer_tracks_than_votes_are_enough():
    frames, flows, points, visible, objects, _ = _scene(spacing=40)
    few = slice(0, 6)
    objects[few] = 3
    masks = track_masks(frames, flows, points[few], visible[few], objects[few], 0, PARAMS, OUTLINES)
    assert set(np.unique(masks)) == {0, 3}


def test_objects_without_a_pixel_leave_no_gap_in_the_numbers():
    masks = np.array([[[0, 5, 2], [2, 0, 9]]], np.uint16)
    numbered, labels = number_seen(masks)
    assert numbered.tolist() == [[[0, 2, 1], [1, 0, 3]]]
    assert numbered.dtype == np.uint16
    assert labels.tolist() == [2, 5, 9]
    assert number_seen(masks * 0)[1].size == 0


@pytest.mark.parametrize("params", [VOTES, PARAMS])
def test_masks_are_not_shifted_to_one_side(params):
    shape = (100, 150)
    y, x = np.mgrid[3 : shape[0] : 8, 3 : shape[1] : 8].reshape(2, -1)
    place = np.stack([x, y], axis=1).astype(np.float32)[:, None]
    objects = ((abs(x - 70) < 30) & (abs(y - 50) < 20)).astype(np.uint16)
    frame, flow = np.full((1, *shape, 3), 90, np.uint8), np.zeros((1, *shape, 2), np.float32)
    last = np.float32(shape[::-1]) - 1
    rows, columns = [], []
    for points in (place, last - place):
        mask = track_masks(frame, flow, points, np.ones((len(x), 1), bool), objects, 0, params, OUTLINES)[0]
        for axis, found in enumerate((columns, rows)):
            found.append(np.flatnonzero(mask.any(axis=axis)).mean())
    # The mask of mirrored tracks is the mirrored mask.
    np.testing.assert_allclose([sum(columns), sum(rows)], last, atol=0.3)
