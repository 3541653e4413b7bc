import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import DenseTrackParams
from moseg.tasks.dense_tracks import join_runs, track_densely
from moseg.tasks.dense_tracks.thinning import first_in_cells, new_corners

PARAMS = DenseTrackParams()
HEIGHT, WIDTH = 120, 180
STEP = 2.5, -0.75
FAST, SIDE = 34, 30


def texture(height, width, seed=0) -> np.ndarray:
    """Smooth random texture, uint8 (y, x)."""
    noise = np.random.default_rng(seed).normal(size=(height, width)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 1.5)
    return np.clip(128 + 50 * smooth / smooth.std(), 0, 255).astype(np.uint8)


def moving(num_frames, step=STEP):
    """Frames of a texture that moves by `step` px/frame, and their exact flows."""
    wide = texture(HEIGHT + 120, WIDTH + 120)
    frames = []
    for t in range(num_frames):
        cut = np.array([[1.0, 0, 60 - t * step[0]], [0, 1.0, 60 - t * step[1]]])
        gray = cv2.warpAffine(wide, cut, (WIDTH, HEIGHT), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
        frames.append(cv2.cvtColor(gray, cv2.COLOR_GRAY2RGB))
    flow = np.full((HEIGHT, WIDTH, 2), step, np.float32)
    return frames, [(flow, -flow)] * (num_frames - 1)


def test_tracks_follow_the_motion_of_the_frame():
    tracks = track_densely(*moving(6), PARAMS)
    assert tracks.visible.sum(axis=0).min() > 200
    both = tracks.visible[:, 1:] & tracks.visible[:, :-1]
    steps = np.diff(tracks.points, axis=1)[both]
    assert np.abs(steps - STEP).max() < 0.7
    assert np.median(np.abs(steps - STEP)) < 0.05


def test_a_track_is_one_run_of_enough_frames_inside_the_border():
    tracks = track_densely(*moving(7), PARAMS)
    assert (np.abs(np.diff(tracks.visible.astype(int), axis=1)).sum(axis=1) <= 2).all()
    assert tracks.visible.sum(axis=1).min() >= PARAMS.min_frames
    seen, far = tracks.points[tracks.visible], np.array([WIDTH, HEIGHT]) - 1 - PARAMS.border
    assert ((seen >= PARAMS.border) & (seen <= far)).all()
    assert (tracks.points[~tracks.visible] == 0).all()


def test_tracks_are_replaced_where_the_frame_shows_something_new():
    tracks = track_densely(*moving(8, (6.0, 0.0)), PARAMS)
    # What is seen in frame 5 in the first 24 columns entered after frame 0.
    entered = tracks.visible[:, 5] & (tracks.points[:, 5, 0] < 24)
    assert entered.sum() > 10
    assert not tracks.visible[entered, 0].any()


def test_a_small_fast_object_is_followed_from_the_dense_flow():
    frames, no_flows = moving(4, (0.0, 0.0))
    own, boxes = texture(SIDE, SIDE, 1), [np.s_[40 : 40 + SIDE, x : x + SIDE] for x in 10 + FAST * np.arange(4)]
    flows = []
    for frame, box in zip(frames, boxes, strict=True):
        frame[box] = own[..., None]
    for (forward, backward), box0, box1 in zip(no_flows, boxes[:-1], boxes[1:], strict=True):
        flows.append((forward.copy(), backward.copy()))
        flows[-1][0][box0], flows[-1][1][box1] = (FAST, 0), (-FAST, 0)

    def num_fast(flows):
        points, visible = track_densely(frames, flows, PARAMS)
        steps = (points[:, 2] - points[:, 0])[visible[:, 0] & visible[:, 2]]
        return np.count_nonzero(np.abs(steps - [2 * FAST, 0]).max(axis=1) < 1)

    assert num_fast(flows) >= 5
    assert num_fast(no_flows) < num_fast(flows)


def test_a_point_whose_dense_flow_is_wrong_is_found_without_it():
    frames, flows = moving(3)
    wrong = [(forward + 25, backward - 25) for forward, backward in flows]
    found, lost = (
        track_densely(frames, wrong, PARAMS.model_copy(update={"doubtful": doubtful})).visible[:, :2].all(axis=1).sum()
        for doubtful in (PARAMS.doubtful, 1e4)
    )
    assert found > 200 > 5 * lost


def test_points_of_a_frame_are_apart_and_bounded_in_number():
    gray = texture(HEIGHT, WIDTH)
    taken = new_corners(gray, np.zeros((0, 2), np.float32), PARAMS)[:40]
    corners = new_corners(gray, taken, PARAMS)
    apart = np.linalg.norm(corners[:, None] - taken, axis=2)
    assert apart.min() >= PARAMS.corner_distance - 1
    few = PARAMS.model_copy(update={"max_points": 50})
    assert len(new_corners(gray, taken, few)) == 10
    assert len(new_corners(gray, corners, few)) == 0


def test_the_first_point_of_each_cell_goes_on():
    points = np.array([[0.5, 0.5], [9.0, 9.0], [1.5, 3.0], [4.0, 0.5], [9.5, 8.5]], np.float32)
    np.testing.assert_array_equal(first_in_cells(points, 3.6), [0, 1, 3])


@pytest.mark.parametrize("shape", [(64, 64), (12, 200), (3, 3), (1, 1)])
@pytest.mark.parametrize("num_frames", [1, 2, 4])
def test_frames_without_texture_or_of_few_pixels_have_no_tracks(shape, num_frames):
    frames = [np.full((*shape, 3), 90, np.uint8)] * num_frames
    flow = np.zeros((*shape, 2), np.float32)
    tracks = track_densely(frames, [(flow, flow)] * (num_frames - 1), PARAMS)
    assert tracks.points.shape == (0, num_frames, 2)
    assert tracks.visible.shape == (0, num_frames)


def test_the_tracks_are_the_same_bytes_each_time():
    first, second = (track_densely(*moving(4), PARAMS) for _ in range(2))
    assert first.points.tobytes() == second.points.tobytes()


def test_runs_keep_their_tracks_at_their_own_frames():
    frames, flows = moving(9)
    runs = [track_densely(frames[start : start + 3], flows[:2], PARAMS) for start in (0, 5)]
    joined = join_runs(runs, (0, 5), 9)
    first = len(runs[0].points)
    assert joined.points.shape == (first + len(runs[1].points), 9, 2)
    assert np.array_equal(joined.points[:first, :3], runs[0].points)
    assert np.array_equal(joined.visible[first:, 5:8], runs[1].visible)
    assert not joined.visible[:first, 3:].any() and not joined.visible[:, [3, 4, 8]].any()
    assert (joined.points[~joined.visible] == 0).all()
