from io import BytesIO

import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import TrackParams
from moseg.schemas.parameters.pips import PipsParams
from moseg.tasks.networks.checkpoint import Checkpoint, unwrap_state
from moseg.tasks.networks.pips import Pips, PipsConfig, build_pips
from moseg.tasks.networks.pips.model import Trajectories
from moseg.tasks.tracks.pips import overlapping_windows, track_points_pips
from moseg.workflows.weights.tiny.pips import CONFIG, make_pips

PARAMS = TrackParams(points_per_object=20, background_points=40)
SIZE = (120, 180)
"""Height and width of `drift`'s frames, px; the network sees them at 64 x 96 where `SMALL` caps its resolution."""
FULL = PipsParams()
SMALL = PipsParams(max_side=96)
SCALE = np.array([96 / 180, 64 / 120])


class Guide(Pips):
    """Moves every point by a known step a frame, px of its own image; remembers what it was asked."""

    def __init__(self, step=(0.0, 0.0), hidden=lambda points: torch.zeros(points.shape[:2], dtype=torch.bool)):
        super().__init__(PipsConfig(**CONFIG))
        self.step, self.hidden = torch.tensor(step), hidden
        self.num_encoded, self.passes = 0, []

    def encode(self, images):
        self.num_encoded += len(images)
        return super().encode(images)

    def forward(self, pyramid, points, appearances, iterations):
        self.passes.append((pyramid, points, appearances))
        times = torch.arange(self.config.window)[:, None]
        moved = points[:, None] + times * self.step
        return Trajectories(moved, torch.where(self.hidden(moved), -5.0, 5.0))


@pytest.fixture(scope="module")
def tiny():
    files, config = make_pips(seed=0)
    content = torch.load(BytesIO(files["model.pth"]), weights_only=True)
    return build_pips(Checkpoint("tiny", unwrap_state(content, "tiny"), config=config))


def track(model, frames, masks, params=PARAMS, pips_params=FULL, seed=0):
    return track_points_pips(model, iter(frames), masks, params, pips_params, np.random.default_rng(seed))


def background(num_frames):
    return np.zeros((num_frames, *SIZE), np.uint16)


def still(square, num_frames, **where):
    return np.repeat(square(60, 40, **where)[None], num_frames, axis=0)


@pytest.mark.parametrize("pips_params", [FULL, SMALL])
def test_points_are_at_the_networks_positions_in_frame_pixels(drift, pips_params):
    scale = SCALE if pips_params is SMALL else np.array([176 / 180, 1.0])
    tracks = track(Guide(step=(1.5, -0.5)), drift(17), background(17), pips_params=pips_params)
    both = tracks.visible[:, :-1] & tracks.visible[:, 1:]
    steps = np.diff(tracks.points, axis=1)[both]
    assert len(steps) > 200
    np.testing.assert_allclose(steps, np.broadcast_to([1.5, -0.5] / scale, steps.shape), atol=2e-4)
    assert (tracks.visible[:, 0] & tracks.visible[:, 15]).any()


def test_points_start_where_they_were_sampled(drift):
    model = Guide()
    tracks = track(model, drift(8), background(8), pips_params=SMALL)
    assert (tracks.points[:, 0] == np.floor(tracks.points[:, 0])).all()
    asked = model.passes[0][1].numpy()
    np.testing.assert_allclose(asked, (tracks.points[:, 0] + 0.5) * SCALE - 0.5, atol=1e-4)
    np.testing.assert_allclose(tracks.points[:, 7], tracks.points[:, 0], atol=1e-4)


@pytest.mark.parametrize(("every", "checks"), [(8, {0, 7, 14}), (100, {0, 7, 14}), (7, {0, 7, 14}), (4, {0, 4, 8, 12})])
def test_each_window_begins_with_a_check(drift, every, checks):
    params = PARAMS.model_copy(update={"resample_every": every})
    # Points leave on the right, so that each check has some to replace.
    tracks = track(Guide(step=(4.0, 0.0)), drift(15), background(15), params)
    assert set(tracks.visible.argmax(axis=1)) == checks
    for check in checks:
        assert tracks.visible[:, check].sum() == 40


def test_each_object_gets_its_quota_and_the_background_its_own(drift, square):
    masks = still(square, 8, label=5)
    tracks = track(Guide(), drift(8), masks)
    assert (tracks.object == 0).sum() == 40 and (tracks.object == 5).sum() == 20
    assert (np.diff(tracks.object.astype(int)) >= 0).all()
    x, y = tracks.points[:, 0].astype(int).T
    np.testing.assert_array_equal(masks[0][y, x], tracks.object)


def test_a_point_outside_its_mask_is_dropped_at_the_check_and_kept_before(drift, square):
    masks = still(square, 9)
    tracks = track(Guide(step=(3.0, 0.0)), drift(9), masks)
    old = (tracks.object == 1) & tracks.visible[:, 0]
    x = tracks.points[:, 6, 0] + 3 * 180 / 176
    assert tracks.visible[old, :7].all()
    np.testing.assert_array_equal(tracks.visible[old, 7], x[old] < 99.5)
    assert not tracks.visible[old, 7].all()
    assert (tracks.visible[:, 7] & (tracks.object == 1)).sum() == 20


def test_a_hidden_point_ends_its_track_for_good(drift):
    def hidden(points):
        gone = torch.zeros(points.shape[:2], dtype=torch.bool)
        gone[:, 3] = points[:, 0, 0] > 88.5  # 90 px of the frame
        return gone

    tracks = track(Guide(hidden=hidden), drift(7), background(7))
    right = tracks.points[:, 0, 0] > 90
    assert 5 < right.sum() < 35
    assert tracks.visible[:, :3].all() and tracks.visible[~right].all()
    assert not tracks.visible[right, 3:].any()
    assert (tracks.points[~tracks.visible] == 0).all()


def test_visibility_in_the_first_frame_ends_no_track(drift):
    def hidden(points):
        return (torch.arange(8) == 0).expand(points.shape[:2])

    assert track(Guide(hidden=hidden), drift(10), background(10)).visible.all()


def test_the_least_visibility_decides(drift):
    model = Guide(hidden=lambda points: torch.ones(points.shape[:2], dtype=torch.bool))
    probability = float(torch.sigmoid(torch.tensor(-5.0)))
    assert track(model, drift(3), background(3), pips_params=PipsParams(min_visibility=0.9 * probability)).visible.all()
    strict = track(model, drift(3), background(3), pips_params=PipsParams(min_visibility=1.1 * probability))
    assert not strict.visible[:, 1:].any()


def test_a_track_is_one_run_of_frames_inside_the_border(drift):
    tracks = track(Guide(step=(2.0, 1.0)), drift(20), background(20))
    starts = np.diff(np.pad(tracks.visible, ((0, 0), (1, 0))).astype(int), axis=1) == 1
    np.testing.assert_array_equal(starts.sum(axis=1), 1)
    x, y = np.moveaxis(tracks.points[tracks.visible], -1, 0)
    assert x.min() >= 6 and y.min() >= 6 and x.max() <= 179 - 6 and y.max() <= 119 - 6
    assert (np.diff(tracks.visible.argmax(axis=1)) >= 0).all()


@pytest.mark.parametrize("every", [1, 8])
def test_each_frame_is_encoded_once(drift, every):
    model = Guide()
    track(model, drift(18), background(18), PARAMS.model_copy(update={"resample_every": every}))
    assert model.num_encoded == 18


def test_the_last_window_repeats_the_last_frame(drift):
    model = Guide()
    tracks = track(model, drift(10), background(10))
    (full, _, _), (short, _, _) = model.passes
    frames = full[0]
    assert len(short[0]) == 8
    assert torch.equal(short[0][0], frames[7])
    assert all(torch.equal(frame, short[0][2]) for frame in short[0][3:])
    assert not torch.equal(short[0][1], short[0][2])
    assert tracks.visible.all() and tracks.points.shape == (40, 10, 2)


def test_windows_look_for_the_appearance_of_a_tracks_first_frame(drift):
    model = Guide()
    track(model, drift(15, step=(3.0, 2.0)), background(15))
    (pyramid, points, first), (_, _, second) = model.passes
    assert torch.equal(first, second)
    assert torch.equal(first, model.appearances(pyramid, points))


def test_an_object_that_enters_between_checks_gets_points_at_the_next(drift, square):
    masks = background(10)
    masks[5:] = square(60, 40, label=3)
    tracks = track(Guide(), drift(10), masks)
    assert (tracks.object == 3).sum() == 20
    assert set(tracks.visible[tracks.object == 3].argmax(axis=1)) == {7}


def test_frames_beyond_the_masks_extend_tracks_and_start_none(drift):
    tracks = track(Guide(step=(1.0, 0.0)), drift(20), background(7))
    assert tracks.points.shape[1] == 20
    assert set(tracks.visible.argmax(axis=1)) == {0}
    assert tracks.visible[:, 19].sum() > 20


@pytest.mark.parametrize("num_frames", [1, 2, 7, 8, 9])
def test_sections_of_any_length(drift, num_frames):
    tracks = track(Guide(), drift(num_frames), background(num_frames))
    assert tracks.points.shape == (40, num_frames, 2)
    assert tracks.visible.all()
    assert tracks.points.dtype == np.float32 and tracks.visible.dtype == bool and tracks.object.dtype == np.uint16


def test_no_points_to_track(drift):
    nothing = track(Guide(), [], background(0))
    assert nothing.points.shape == (0, 0, 2) and nothing.object.shape == (0,)
    assert track(Guide(), drift(3), background(0)).points.shape == (0, 3, 2)


def test_passes_do_not_change_the_tracks(tiny, drift, square):
    masks = still(square, 9)
    together, few = (track(tiny, drift(9), masks, pips_params=PipsParams(points_per_pass=n)) for n in (256, 7))
    np.testing.assert_array_equal(few.visible, together.visible)
    np.testing.assert_allclose(few.points, together.points, atol=1e-3)


def test_equal_generators_give_equal_bytes_and_others_do_not(tiny, drift, square):
    frames, masks = drift(9), still(square, 9)
    for array in [*frames, masks]:
        array.setflags(write=False)
    first, again, other = (track(tiny, frames, masks, seed=seed) for seed in (0, 0, 1))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(first, again, strict=True))
    assert first.points.tobytes() != other.points.tobytes()


def test_half_precision_gives_finite_tracks_in_full_precision(tiny, drift, square):
    with torch.autocast("cpu", dtype=torch.bfloat16):
        tracks = track(tiny, drift(9), still(square, 9))
    assert tracks.points.dtype == np.float32 and np.isfinite(tracks.points).all()
    assert tracks.visible[:, 1:].any()


def test_the_tiny_networks_points_are_seen_and_stay_near_without_standing_still(tiny, drift, square):
    tracks = track(tiny, drift(8), still(square, 8))
    assert tracks.visible.mean() > 0.9
    moved = np.linalg.norm(tracks.points[:, 1:] - tracks.points[:, :1], axis=-1)[tracks.visible[:, 1:]]
    assert 0.05 < np.median(moved) < 2 and moved.max() < 8


def test_a_tiny_checkpoint_is_small_and_depends_only_on_its_seed():
    state = torch.random.get_rng_state()
    first, again, other = make_pips(0), make_pips(0), make_pips(1)
    assert torch.equal(state, torch.random.get_rng_state())
    assert first.files == again.files and first.files != other.files
    assert list(first.files) == ["model.pth"] and len(first.files["model.pth"]) < 200_000


def test_wrong_frames_and_masks_are_refused(drift):
    with pytest.raises(InputError, match="fewer frames than masks"):
        track(Guide(), drift(2), background(3))
    with pytest.raises(InputError, match=r"mask of frame 0; got \(60, 90\); expected \(120, 180\)"):
        track(Guide(), drift(2), np.zeros((2, 60, 90), np.uint16))
    with pytest.raises(InputError, match=r"frame 1; got uint8 \(60, 180, 3\); expected uint8 \(120, 180, 3\)"):
        track(Guide(), [drift(1)[0], drift(1)[0][:60]], background(1))
    with pytest.raises(InputError, match=r"not an RGB frame in frame 0; got float64 \(120, 180\)"):
        track(Guide(), [np.zeros(SIZE)], background(1))


def test_windows_take_items_only_as_they_need_them():
    taken = []
    windows = overlapping_windows((taken.append(item) or item for item in range(11)), 4, 3)
    assert next(windows) == (0, [0, 1, 2, 3])
    assert taken == [0, 1, 2, 3]
    assert list(windows) == [(3, [3, 4, 5, 6]), (6, [6, 7, 8, 9]), (9, [9, 10])]
    assert list(overlapping_windows([1, 2], 4, 3)) == [(0, [1, 2])]
    assert list(overlapping_windows([], 4, 3)) == []
