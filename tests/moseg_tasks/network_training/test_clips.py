"""Evidence of clips, and the losses that it gives."""

import numpy as np
import pytest
import torch

from moseg.schemas.parameters import ClipParams, SaliencyParams, VideoTrainingParams
from moseg.tasks.motion_network import CHANNELS
from moseg.tasks.network_training.clip_loss import clip_losses, track_logits, weighted_sum
from moseg.tasks.network_training.clips import CuedFrame, choose_middles, make_clip, window
from moseg.tasks.network_training.paths import follow_points

SHAPE, NUM_FRAMES, MIDDLE = (96, 160), 9, 4
PAN, OWN, SPIN = np.array([1.5, 0.5]), np.array([0.5, -2.0]), 0.12
PLANE_RANK = 3
PARAMS = ClipParams(reach=4, shown=2, spacing=5)


def _disc(frame):
    """Return where the disc lies, and what it adds to the background's flow: it moves by `OWN` and spins.

    It covers less than the share of points that a homography may leave to a fundamental matrix.
    """
    x, y = np.array([60.0, 40.0]) + (PAN + OWN) * (frame - MIDDLE)
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    spin = SPIN * np.stack([y - rows, columns - x], axis=-1)
    return np.hypot(columns - x, rows - y) < 14, OWN, spin


@pytest.fixture(scope="module")
def frames():
    """Return frames with the flow of the background, which pans, and of a disc in front of it."""
    rng, found = np.random.default_rng(0), []
    for frame in range(NUM_FRAMES):
        where, own, spin = _disc(frame)
        residuals = [where[..., None] * sign * (own + spin) + rng.normal(0, 0.03, (*SHAPE, 2)) for sign in (-1, 1)]
        flows = [sign * PAN + residual for sign, residual in zip((-1, 1), residuals, strict=True)]
        image = rng.uniform(0, 255, (*SHAPE, 3)).astype(np.float32)
        found.append(CuedFrame(image, np.float32(flows), np.float32(residuals)))
    return found


@pytest.fixture(scope="module")
def clip(frames):
    return make_clip(frames, MIDDLE, True, True, PARAMS, SaliencyParams())


@pytest.fixture(scope="module")
def in_disc(frames):
    """Return which tracks lie on the disc in the middle frame."""
    places = follow_points([frame.flows for frame in frames], MIDDLE, 5, 1.0).points[:, MIDDLE].astype(int)
    return _disc(MIDDLE)[0][places[:, 1], places[:, 0]]


def test_points_follow_their_surface(frames, in_disc):
    paths = follow_points([frame.flows for frame in frames], MIDDLE, 5, 1.0)
    error = np.linalg.norm(np.diff(paths.points, axis=1) - PAN, axis=2).max(axis=1)
    whole = paths.visible.all(axis=1)
    assert (whole & ~in_disc).sum() > 200 and (error[whole & ~in_disc] < 0.3).mean() > 0.97
    assert (whole & in_disc).sum() > 10 and (error[whole & in_disc] > 0.5).all()


def test_what_fits_both_views_is_static_and_the_coherent_rest_moves(clip, in_disc):
    assert (clip.static[~in_disc] > 0.5).mean() > 0.8 and clip.static[in_disc].max() < 0.5
    # Those beside static ones are left open.
    assert (clip.moving[in_disc] > 0.5).mean() > 0.15 and clip.moving[~in_disc].max() < 0.5


def test_pairs_across_the_border_are_apart(clip, in_disc):
    same = in_disc[clip.pairs[:, 0]] == in_disc[clip.pairs[:, 1]]
    assert clip.alike[same].mean() > 0.7 > 0.2 > clip.alike[~same].mean()
    assert clip.apart[~same].mean() > 10 * clip.apart[same].mean()


def _losses(clip, is_moving, shape=(32, 48)):
    """Return the losses of a network that says of every track what `is_moving` says; frames are one track a pixel."""
    num_tracks = len(clip.static)
    columns = np.linspace(-1 + 1 / num_tracks, 1 - 1 / num_tracks, num_tracks, dtype=np.float32)
    places = np.zeros((num_tracks, 1, 2), np.float32)
    places[:, 0, 0] = columns
    logit = torch.from_numpy(np.where(is_moving, 4.0, -4.0).astype(np.float32))[None, None]
    spread = clip._replace(places=places, seen=np.ones((num_tracks, 1), bool))
    return clip_losses(logit, logit, spread, PLANE_RANK)


def test_the_truth_has_the_least_loss(clip, in_disc):
    true = _losses(clip, in_disc)
    for wrong in (
        np.zeros_like(in_disc),
        np.ones_like(in_disc),
        ~in_disc,
        np.roll(in_disc, len(in_disc) // 2),
    ):
        others = _losses(clip, wrong)
        assert true.targets < others.targets
        assert weighted_sum(true, VideoTrainingParams()) < weighted_sum(others, VideoTrainingParams())


def test_two_motions_have_a_lower_rank_apart_than_together(clip, in_disc):
    random = np.random.default_rng(0).permutation(in_disc)
    apart, mixed, together = (_losses(clip, each).low_rank for each in (in_disc, random, np.zeros_like(in_disc)))
    assert apart < 0.5 * mixed and mixed <= together <= 1.001


def test_logits_are_read_at_the_tracks():
    logit = torch.arange(12.0).reshape(1, 3, 4)
    places = torch.tensor([[[-0.75, -2 / 3]], [[0.75, 2 / 3]]])
    torch.testing.assert_close(
        track_logits(logit, places, torch.ones(2, 1, dtype=torch.bool)), torch.tensor([0.0, 11.0])
    )


def test_clips_cover_the_video_and_are_no_more_than_asked():
    assert choose_middles(24, ClipParams()) == [4, 12, 20]
    assert choose_middles(3, ClipParams()) == [1]
    assert len(choose_middles(5000, ClipParams())) == ClipParams().max_clips
    assert window(4, 24, ClipParams()) == range(15)


def test_a_clip_shows_three_frames(clip):
    assert clip.channels.shape == (3, len(CHANNELS), *SHAPE)
    assert np.isfinite(clip.channels.astype(float)).all()
    assert clip.places.shape[1] == clip.seen.shape[1] == 3
