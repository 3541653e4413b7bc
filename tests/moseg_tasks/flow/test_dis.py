import cv2
import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowParams
from moseg.tasks.flow import estimate_flow
from moseg.tasks.flow.dis import search_flow

MEDIUM = FlowParams(preset="medium")
LEVELS = {
    "ultrafast": (2, cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST),
    "fast": (2, cv2.DISOPTICAL_FLOW_PRESET_FAST),
    "medium": (1, cv2.DISOPTICAL_FLOW_PRESET_MEDIUM),
    "fine": (0, cv2.DISOPTICAL_FLOW_PRESET_MEDIUM),
}
"""Finest level of each preset's pyramid, and OpenCV's preset."""
EFFORTS = ("lighter", "light", "balanced", "medium")


def texture(shape: tuple[int, int], seed: int = 0, sigma: float = 2.0) -> np.ndarray:
    """Smooth random RGB texture of blobs of `sigma` px."""
    noise = np.random.default_rng(seed).integers(0, 256, (*shape, 3), np.uint8)
    smooth = cv2.GaussianBlur(noise, (0, 0), sigma).astype(np.float32)
    return np.clip((smooth - 127) * 2.5 * sigma + 127, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("preset", ["ultrafast", "fast", "medium", "fine"])
@pytest.mark.parametrize("shape", [(120, 160), (101, 133)])
def test_the_flow_is_that_of_opencv_whatever_grid_it_is_searched_on(preset, shape):
    image0, image1 = (texture((140, 180))[start:][: shape[0], : shape[1]] for start in (5, 8))
    level, opencv = LEVELS[preset]
    search = cv2.DISOpticalFlow_create(opencv)
    search.setFinestScale(level)
    expected = search.calc(*(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for image in (image0, image1)), None)
    # OpenCV multiplies by powers of two also where a side is not a multiple of one.
    expected *= np.float32([side / ((side >> level) << level) for side in reversed(shape)])
    params = FlowParams(preset=preset, search_side=16)
    np.testing.assert_allclose(estimate_flow(image0, image1, params), expected, atol=1e-4)
    assert search_flow(image0, image1, params).shape == (shape[0] >> level, shape[1] >> level, 2)


@pytest.mark.parametrize("preset", ["ultrafast", "fast", "lighter", "light", "balanced", "medium"])
def test_a_translation_is_recovered(preset):
    canvas = texture((140, 180))
    image0, image1 = canvas[10:130, 10:170], canvas[12:132, 7:167]
    flow = estimate_flow(image0, image1, FlowParams(preset=preset))
    assert flow.dtype == np.float32 and flow.shape == (120, 160, 2)
    inner = flow[16:-16, 16:-16].reshape(-1, 2)
    np.testing.assert_allclose(np.median(inner, axis=0), [3.0, -2.0], atol=0.2)
    assert np.mean(np.abs(inner - [3.0, -2.0]).max(axis=1) < 0.5) > 0.95


@pytest.mark.parametrize(
    ("preset", "side", "grid"),
    [
        ("fast", 16, (30, 40)),
        ("fast", 44, (30, 40)),
        ("fast", 45, (34, 45)),
        ("medium", 80, (60, 80)),
        ("medium", 100, (75, 100)),
        ("medium", 150, (112, 150)),
        ("fine", 200, (150, 200)),
        ("balanced", 427, (240, 320)),
    ],
)
def test_a_search_ends_on_a_grid_of_the_side_asked_for_but_of_twice_the_frame_at_most(preset, side, grid):
    canvas = texture((140, 180))
    image0, image1 = canvas[10:130, 10:170], canvas[12:132, 7:167]
    flow = search_flow(image0, image1, FlowParams(preset=preset, search_side=side))
    assert flow.shape == (*grid, 2)
    # In pixels of the frames, whatever the grid.
    np.testing.assert_allclose(np.median(flow, axis=(0, 1)), [3.0, -2.0], atol=0.2)
    assert estimate_flow(image0, image1, FlowParams(preset=preset, search_side=side)).shape == (120, 160, 2)


@pytest.mark.parametrize(
    ("longer", "grid"),
    [(200, 400), (300, 427), (400, 400), (480, 480), (640, 640), (854, 640), (1242, 621), (1280, 640), (1920, 960)],
)
def test_frames_of_less_than_427_px_are_enlarged_to_that_and_others_are_not(longer, grid):
    image = np.zeros((longer // 2, longer, 3), np.uint8)
    assert search_flow(image, image, FlowParams()).shape[1] == grid
    less = search_flow(image, image, FlowParams(preset="medium", search_side=300)).shape[1]
    assert less == (longer // 2 if longer >= 640 else 300)


def test_an_enlarged_search_finds_what_is_too_small_for_that_of_the_frames():
    backdrop, small = texture((100, 140)), texture((12, 12), 1)
    frames = [np.roll(backdrop, (0, step), axis=(0, 1)).copy() for step in (0, 2)]
    for number, frame in enumerate(frames):
        frame[44:56, 60 - 2 * number : 72 - 2 * number] = small
    own, enlarged = (
        np.abs(estimate_flow(*frames, FlowParams(search_side=side))[46:54, 62:70] - (-2.0, 0.0)).mean()
        for side in (16, 280)
    )
    assert enlarged < own / 2


def followed_by_the_camera(step: int, seed: int = 0) -> tuple[list[np.ndarray], tuple[slice, slice]]:
    """Two frames 480 x 270 whose background moves `step` px to the left past a thing that stays, and its place."""
    backdrop, thing = texture((270, 560), seed, 6.0), texture((60, 50), seed + 1, 6.0)
    place = slice(110, 170), slice(200, 250)
    frames = [backdrop[:, start : start + 480].copy() for start in (0, step)]
    for frame in frames:
        frame[place] = thing
    return frames, place


@pytest.mark.parametrize("seed", [0, 5, 9])
def test_a_small_thing_before_a_fast_background_is_found_by_the_coarse_search(seed):
    frames, place = followed_by_the_camera(30, seed)
    with_it, without = (
        np.abs(estimate_flow(*frames, FlowParams(search_side=480, coarse_side=side))[place]).max(axis=2) < 1
        for side in (107, 0)
    )
    assert with_it.mean() > 0.7 > 0.3 > without.mean()


def test_grids_of_less_than_three_times_the_coarse_side_and_narrow_ones_have_no_coarse_search():
    frames, _ = followed_by_the_camera(10)
    narrow = [np.ascontiguousarray(frame[:40]) for frame in frames]
    for pair, side in ((frames, 161), (narrow, 107)):
        expected = search_flow(*pair, FlowParams(search_side=480, coarse_side=0))
        assert np.array_equal(search_flow(*pair, FlowParams(search_side=480, coarse_side=side)), expected)


@pytest.mark.parametrize("preset", ["ultrafast", "medium"])
def test_a_translation_is_not_shortened_where_sides_are_no_multiples_of_the_grid(preset):
    canvas = texture((140, 180))
    image0, image1 = canvas[10:113, 10:165], canvas[16:119, 4:159]
    flow = estimate_flow(image0, image1, FlowParams(preset=preset))
    np.testing.assert_allclose(np.median(flow[16:-16, 16:-16], axis=(0, 1)), [6.0, -6.0], atol=0.05)


@pytest.mark.parametrize("preset", ["light", "balanced", "fine"])
def test_the_flow_does_not_depend_on_what_was_searched_before(preset):
    params = FlowParams(preset=preset)
    image0, image1, other = (texture((240, 320), seed) for seed in range(3))
    first = search_flow(image0, image1, params)
    search_flow(image1, other, params)
    again = search_flow(image0, image1, params)
    search_flow(other[:120, :160], image0[:120, :160], params)
    assert first.tobytes() == again.tobytes() == search_flow(image0, image1, params).tobytes()


def test_the_flow_without_a_coarse_search_does_not_depend_on_one_before():
    frames, _ = followed_by_the_camera(40)
    with_it, without = (FlowParams(search_side=480, coarse_side=side) for side in (107, 0))
    flows = [search_flow(*frames, params).tobytes() for params in (without, with_it, without, with_it)]
    assert flows[0] == flows[2] != flows[1] == flows[3]


def test_a_search_with_more_effort_is_closer_to_medium():
    image0, image1 = texture((240, 320)), texture((240, 320), 1)
    moved = cv2.remap(
        image0, *np.meshgrid(*(np.arange(n, dtype=np.float32) * 0.99 + 2 for n in (320, 240))), cv2.INTER_LINEAR
    )
    moved[80:140, 100:180] = image1[80:140, 100:180]
    flows = {name: estimate_flow(image0, moved, FlowParams(preset=name)) for name in EFFORTS}
    lighter, light, balanced, _ = (np.abs(flows[name] - flows["medium"]).mean() for name in EFFORTS)
    assert 0 < light < lighter and 0 < balanced < lighter


def test_the_flow_between_equal_frames_is_zero():
    image = texture((64, 96))
    assert np.abs(estimate_flow(image, image, MEDIUM)).max() < 1e-3


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (16, 16), (20, 400), (400, 12), (33, 600)])
@pytest.mark.parametrize("preset", ["ultrafast", "fast", "medium"])
def test_frames_smaller_than_the_search_give_finite_flow(shape, preset):
    flow = estimate_flow(texture(shape, 1), texture(shape, 2), FlowParams(preset=preset))
    assert flow.shape == (*shape, 2) and np.isfinite(flow).all()


def test_a_translation_is_recovered_in_a_frame_smaller_than_the_search():
    canvas = texture((40, 60))
    flow = estimate_flow(canvas[4:24, 4:54], canvas[4:24, 3:53], MEDIUM)
    np.testing.assert_allclose(np.median(flow[4:-4, 4:-4].reshape(-1, 2), axis=0), [1.0, 0.0], atol=0.1)


def test_the_same_frames_give_the_same_bytes_on_any_number_of_threads():
    image0, image1 = texture((240, 320)), np.roll(texture((240, 320)), 3, axis=1)
    before = cv2.getNumThreads()
    try:
        flows = []
        for threads in (1, 3, 1):
            cv2.setNumThreads(threads)
            flows.append(estimate_flow(image0, image1, MEDIUM).tobytes())
    finally:
        cv2.setNumThreads(before)
    assert len(set(flows)) == 1


def test_the_frames_are_left_as_they_were():
    image0, image1 = texture((40, 40), 1), texture((40, 40), 2)
    copies = image0.copy(), image1.copy()
    estimate_flow(image0, image1, MEDIUM)
    assert np.array_equal(image0, copies[0]) and np.array_equal(image1, copies[1])


@pytest.mark.parametrize(
    ("image0", "image1", "message"),
    [
        (np.zeros((8, 8), np.uint8), np.zeros((8, 8), np.uint8), "not an RGB frame in image0"),
        (np.zeros((8, 8, 3), np.uint8), np.zeros((8, 8, 3), np.float32), "not an RGB frame in image1"),
        (np.zeros((8, 0, 3), np.uint8), np.zeros((8, 0, 3), np.uint8), "not an RGB frame"),
        (np.zeros((8, 8, 3), np.uint8), np.zeros((8, 9, 3), np.uint8), "differ in size"),
    ],
)
def test_other_than_two_rgb_frames_of_one_size_is_an_input_error(image0, image1, message):
    with pytest.raises(InputError, match=message):
        estimate_flow(image0, image1, MEDIUM)
