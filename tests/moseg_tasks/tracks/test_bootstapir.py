from io import BytesIO

import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import BootsTapirParams, TrackParams
from moseg.tasks.networks.bootstapir import BootsTapir, BootsTapirConfig, Trajectories, build_bootstapir
from moseg.tasks.networks.checkpoint import Checkpoint, unwrap_state
from moseg.tasks.tracks.bootstapir import track_points_bootstapir
from moseg.workflows.weights.tiny.bootstapir import CONFIG, make_bootstapir

PARAMS = TrackParams(points_per_object=20, background_points=40)
SIZE = (120, 180)
"""Height and width of `drift`'s frames, px; the network sees them as squares."""
SMALL = BootsTapirParams(side=256)
SCALE = np.array([256 / 180, 256 / 120])


def never(points):
    return torch.zeros(points.shape[:2], dtype=torch.bool)


def always(points):
    return torch.ones(points.shape[:2], dtype=torch.bool)


class Guide(BootsTapir):
    """Moves every point by a known step a frame, px of its own image; remembers what it was asked."""

    def __init__(self, step=(0.0, 0.0), hidden=never, doubted=never):
        super().__init__(BootsTapirConfig(**CONFIG))
        self.step, self.hidden, self.doubted = torch.tensor(step), hidden, doubted
        self.num_encoded, self.passes = 0, []

    def encode(self, images):
        self.num_encoded += len(images)
        return super().encode(images)

    def forward(self, grids, points, frame, appearances, iterations):
        self.passes.append((points, frame, appearances))
        times = torch.arange(len(grids[0].levels[0]))[:, None] - frame
        moved = points[:, None] + times * self.step
        logits = (torch.where(there(moved), 5.0, -5.0) for there in (self.hidden, self.doubted))
        return Trajectories(moved, *logits)


@pytest.fixture(scope="module")
def tiny():
    files, config = make_bootstapir(seed=0)
    content = torch.load(BytesIO(files["model.pth"]), weights_only=True)
    return build_bootstapir(Checkpoint("tiny", unwrap_state(content, "tiny"), config=config))


def track(model, frames, masks, params=PARAMS, network_params=SMALL, seed=0):
    return track_points_bootstapir(model, iter(frames), masks, params, network_params, np.random.default_rng(seed))


def background(num_frames):
    return np.zeros((num_frames, *SIZE), np.uint16)


def still(square, num_frames, **where):
    return np.repeat(square(60, 40, **where)[None], num_frames, axis=0)


@pytest.mark.parametrize("side", [256, 320])
def test_points_are_at_the_networks_positions_in_frame_pixels(drift, side):
    tracks = track(Guide(step=(1.5, -0.5)), drift(12), background(12), network_params=BootsTapirParams(side=side))
    both = tracks.visible[:, :-1] & tracks.visible[:, 1:]
    steps = np.diff(tracks.points, axis=1)[both]
    assert len(steps) > 200
    expected = np.array([1.5 * 180, -0.5 * 120]) / side
    np.testing.assert_allclose(steps, np.broadcast_to(expected, steps.shape), atol=2e-4)


def test_points_start_where_they_were_sampled(drift):
    model = Guide()
    tracks = track(model, drift(8), background(8))
    assert (tracks.points[:, 0] == np.floor(tracks.points[:, 0])).all()
    asked = model.passes[0][0].numpy()
    np.testing.assert_allclose(asked, (tracks.points[:, 0] + 0.5) * SCALE - 0.5, atol=1e-4)


def test_a_point_is_the_same_before_and_after_an_occlusion(drift):
    """Frames 4 to 6 hide the right half: the tracks there go on, and no others take their place."""

    def hidden(points):
        gone = torch.zeros(points.shape[:2], dtype=torch.bool)
        gone[:, 4:7] = points[:, 4:7, 0] > 128
        return gone

    tracks = track(Guide(hidden=hidden), drift(8), background(8))
    right = tracks.points[:, 0, 0] > 89.5
    assert 5 < right.sum() < 35 and len(right) == 40
    assert not tracks.visible[right, 4:7].any() and (tracks.points[right, 4:7] == 0).all()
    assert tracks.visible[right, :4].all() and tracks.visible[right, 7:].all()
    assert tracks.visible[~right].all()
    np.testing.assert_allclose(tracks.points[:, 7], tracks.points[:, 0], atol=1e-4)


def test_a_point_behind_another_object_is_hidden_and_resumes_after_it(drift, square):
    """The network misses the occlusion; the masks do not."""
    masks = still(square, 9)
    masks[3:6, :, 80:] = 2
    tracks = track(Guide(), drift(9), masks)
    behind = (tracks.object == 1) & tracks.visible[:, 0] & (tracks.points[:, 0, 0] > 79.5)
    assert 3 < behind.sum() < 20
    expected = np.ones(9, bool)
    expected[3:6] = False
    np.testing.assert_array_equal(tracks.visible[behind], np.broadcast_to(expected, (behind.sum(), 9)))


def test_new_points_take_the_place_of_hidden_ones_which_come_back_beside_them(drift):
    def hidden(points):
        gone = torch.zeros(points.shape[:2], dtype=torch.bool)
        gone[:, 6:10] = points[:, 6:10, 0] > 128
        return gone

    # Points sampled where the network hides them are seen in the frame in which they were sampled.
    tracks = track(Guide(hidden=hidden), drift(12), background(12))
    assert tracks.visible[:, 8].sum() == 40
    new = ~tracks.visible[:40, 8]
    assert len(tracks.object) == 40 + new.sum() and 5 < new.sum() < 35
    assert tracks.visible[:, 11].sum() == len(tracks.object)


def test_new_points_are_followed_back_to_the_first_frame(drift, square):
    masks = background(10)
    masks[5:] = square(60, 40, label=3)
    masks[2] = square(60, 40, label=3)
    tracks = track(Guide(), drift(10), masks)
    entered = tracks.object == 3
    assert entered.sum() == 20
    expected = [False, False, True, False, False, *[True] * 5]
    np.testing.assert_array_equal(tracks.visible[entered], np.broadcast_to(expected, (20, 10)))


@pytest.mark.parametrize(("every", "checks"), [(8, {0, 8}), (100, {0}), (4, {0, 4, 8, 12})])
def test_points_are_sampled_at_the_checks(drift, every, checks):
    params = PARAMS.model_copy(update={"resample_every": every})
    # Points leave on the right, so that each check has some to replace.
    model = Guide(step=(6.0, 0.0))
    tracks = track(model, drift(15), background(15), params)
    assert {frame for _, frame, _ in model.passes} == checks
    for check in checks:
        assert tracks.visible[:, check].sum() >= 40


def test_each_object_gets_its_quota_and_the_background_its_own(drift, square):
    masks = still(square, 8, label=5)
    tracks = track(Guide(), drift(8), masks)
    assert (tracks.object == 0).sum() == 40 and (tracks.object == 5).sum() == 20
    x, y = tracks.points[:, 0].astype(int).T
    np.testing.assert_array_equal(masks[0][y, x], tracks.object)


def test_visible_points_are_inside_the_border_and_on_their_object(drift, square):
    masks = still(square, 12)
    tracks = track(Guide(step=(2.0, 1.0)), drift(14), masks)
    x, y = np.moveaxis(tracks.points[tracks.visible], -1, 0)
    assert x.min() >= 6 and y.min() >= 6 and x.max() <= 179 - 6 and y.max() <= 119 - 6
    for mask, points, visible in zip(masks, *(np.swapaxes(a, 0, 1) for a in tracks[:2]), strict=False):
        column, row = np.floor(points[visible] + 0.5).astype(int).T
        np.testing.assert_array_equal(mask[row, column], tracks.object[visible])
    assert (tracks.points[~tracks.visible] == 0).all()


def test_frames_beyond_the_masks_extend_tracks_and_start_none(drift):
    model = Guide(step=(1.0, 0.0))
    tracks = track(model, drift(20), background(7))
    assert tracks.points.shape[1] == 20
    assert {frame for _, frame, _ in model.passes} == {0}
    assert tracks.visible[:, 19].sum() > 20


def test_the_least_visibility_decides_over_both_logits(drift):
    seen, unseen = (float(torch.sigmoid(torch.tensor(logit))) for logit in (5.0, -5.0))
    probability = seen * unseen
    for model in (Guide(hidden=always), Guide(doubted=always)):
        lax, strict = (
            track(model, drift(3), background(3), network_params=BootsTapirParams(side=256, min_visibility=limit))
            for limit in (0.9 * probability, 1.1 * probability)
        )
        assert lax.visible.all() and not strict.visible[:, 1:].any()
        # Where a point was sampled, it is known to be.
        assert strict.visible[:, 0].all()


def test_each_frame_is_encoded_once_and_passes_are_bounded(drift):
    model = Guide()
    track(model, drift(18), background(18), network_params=BootsTapirParams(side=256, points_per_pass=7))
    assert model.num_encoded == 18
    assert max(len(points) for points, _, _ in model.passes) == 7


def test_passes_do_not_change_the_tracks(tiny, drift, square):
    masks = still(square, 5)
    together, few = (
        track(tiny, drift(5), masks, network_params=BootsTapirParams(side=256, points_per_pass=n)) for n in (256, 7)
    )
    np.testing.assert_array_equal(few.visible, together.visible)
    np.testing.assert_allclose(few.points, together.points, atol=1e-3)


@pytest.mark.parametrize("num_frames", [1, 2, 9])
def test_sections_of_any_length(drift, num_frames):
    tracks = track(Guide(), drift(num_frames), background(num_frames))
    assert tracks.points.shape == (40, num_frames, 2)
    assert tracks.visible.all()
    assert tracks.points.dtype == np.float32 and tracks.visible.dtype == bool and tracks.object.dtype == np.uint16


def test_no_points_to_track(drift):
    nothing = track(Guide(), [], background(0))
    assert nothing.points.shape == (0, 0, 2) and nothing.object.shape == (0,)
    assert track(Guide(), drift(3), background(0)).points.shape == (0, 3, 2)
    everywhere = PARAMS.model_copy(update={"border": 60})
    assert track(Guide(), drift(3), background(3), everywhere).points.shape == (0, 3, 2)


def test_equal_generators_give_equal_bytes_and_others_do_not(tiny, drift, square):
    frames, masks = drift(4), still(square, 4)
    for array in [*frames, masks]:
        array.setflags(write=False)
    first, again, other = (track(tiny, frames, masks, seed=seed) for seed in (0, 0, 1))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(first, again, strict=True))
    assert first.points.tobytes() != other.points.tobytes()


def test_half_precision_gives_finite_tracks_in_full_precision(tiny, drift, square):
    with torch.autocast("cpu", dtype=torch.bfloat16):
        tracks = track(tiny, drift(4), still(square, 4))
    assert tracks.points.dtype == np.float32 and np.isfinite(tracks.points).all()
    assert tracks.visible[:, 1:].any()


def test_the_tiny_network_finds_most_points_again_near_where_they_are(tiny, drift):
    step = np.array([1.25, -0.75])
    tracks = track(tiny, drift(5, step), background(5))
    at = tracks.points[:, :1] + step * np.arange(5)[None, :, None]
    off = np.linalg.norm(tracks.points - at, axis=-1)[tracks.visible & tracks.visible[:, :1]]
    assert tracks.visible.mean() > 0.8
    assert np.median(off) < 6 and off.max() > 0.1


def test_a_tiny_checkpoint_is_small_and_depends_only_on_its_seed():
    state = torch.random.get_rng_state()
    first, again, other = make_bootstapir(0), make_bootstapir(0), make_bootstapir(1)
    assert torch.equal(state, torch.random.get_rng_state())
    assert first.files == again.files and first.files != other.files
    assert list(first.files) == ["model.pth"] and len(first.files["model.pth"]) < 500_000


def test_wrong_frames_and_masks_are_refused(drift):
    with pytest.raises(InputError, match="fewer frames than masks"):
        track(Guide(), drift(2), background(3))
    with pytest.raises(InputError, match=r"mask of frame 0; got \(60, 90\); expected \(120, 180\)"):
        track(Guide(), drift(2), np.zeros((2, 60, 90), np.uint16))
    with pytest.raises(InputError, match=r"frame 1; got uint8 \(60, 180, 3\); expected uint8 \(120, 180, 3\)"):
        track(Guide(), [drift(1)[0], drift(1)[0][:60]], background(1))
    with pytest.raises(InputError, match=r"not an RGB frame in frame 0; got float64 \(120, 180\)"):
        track(Guide(), [np.zeros(SIZE)], background(1))
