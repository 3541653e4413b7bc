"""The source of proposals that the camera's motion chooses: tracks for a drive ahead, saliency for all else."""

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams, SceneParallaxParams
from moseg.tasks.rigidity.explained_shares import ExplainedShares
from moseg.tasks.scene_parallax import PairEvidence, choose_source, follow_corners, measure_pairs
from moseg.tasks.synthetic import SCENES, render_scene

PARAMS = SceneParallaxParams()
AHEAD = np.array([0.0, 0.0, -1.0])


def _evidence(gain=0.5, heading=AHEAD, sees_epipole=True):
    return PairEvidence(10.0, ExplainedShares(0.9, 0.9 - gain), np.array(heading), sees_epipole)


def _turned(degrees):
    angle = np.radians(degrees)
    return [np.sin(angle), 0.0, -np.cos(angle)]


@pytest.mark.parametrize(
    ("name", "source", "reason"),
    [
        ("pan", "saliency", "one plane"),
        ("forward-drive-epipolar-car", "tracks", "drives"),
        ("static-camera", "saliency", "stands still"),
        ("zoom", "saliency", "one plane"),
        ("strong-parallax", "saliency", "does not move ahead"),
    ],
)
def test_scenes_with_known_cameras(name, source, reason):
    images = render_scene(SCENES[name].model_copy(update={"num_frames": 9})).images
    pairs = [follow_corners(images[first : first + 5], PARAMS) for first in (0, 2, 4)]
    evidence = measure_pairs(pairs, images.shape[1:3], PARAMS, RigidityParams())
    chosen = choose_source(evidence, len(pairs), PARAMS)
    assert chosen.proposals == source
    assert reason in chosen.reason


def test_a_track_is_where_its_corner_went():
    rng = np.random.default_rng(3)
    wide = np.repeat(rng.integers(0, 255, (30, 44, 1), np.uint8).repeat(4, 0).repeat(4, 1), 3, axis=2)
    points0, points1 = follow_corners([wide[:, 2 * step : 160 + 2 * step] for step in range(3)], PARAMS)
    assert len(points0) > 20
    np.testing.assert_allclose(np.median(points1 - points0, axis=0), [-4, 0], atol=0.1)


def test_frames_without_corners_are_no_evidence():
    pairs = [follow_corners([np.full((64, 96, 3), 90, np.uint8)] * 3, PARAMS)]
    assert measure_pairs(pairs, (64, 96), PARAMS, RigidityParams()) == []
    assert choose_source([], 1, PARAMS).proposals == "saliency"


@pytest.mark.parametrize(
    ("evidence", "num_pairs", "source"),
    [
        ([_evidence()] * 4, 4, "tracks"),
        ([_evidence()] * 2, 6, "saliency"),
        ([_evidence(gain=0.1)] * 4, 4, "saliency"),
        ([_evidence(sees_epipole=False)] * 4, 4, "saliency"),
        ([_evidence(heading=_turned(angle)) for angle in (-12, -5, 5, 12)], 4, "saliency"),
        # A mounted camera may look aside, and one bad fit decides nothing.
        ([_evidence(heading=_turned(angle)) for angle in (14, 15, 15, 80)], 4, "tracks"),
    ],
)
def test_what_the_choice_asks_for(evidence, num_pairs, source):
    assert choose_source(evidence, num_pairs, PARAMS).proposals == source


ASIDE = {"sees_epipole": False}


@pytest.mark.parametrize(
    ("evidence", "num_pairs", "shows"),
    [
        # Where the camera moves ahead, a little parallax shows depth.
        ([_evidence(gain=0.06)] * 4, 4, True),
        ([_evidence(gain=0.04)] * 4, 4, False),
        ([_evidence(gain=0.06)] * 2, 5, False),
        # Elsewhere it takes as much as tracks do.
        ([_evidence(gain=0.23, **ASIDE)] * 4, 4, True),
        ([_evidence(gain=0.21, **ASIDE)] * 4, 4, False),
        ([_evidence(gain=0.23, **ASIDE)] * 2, 5, False),
        ([_evidence(gain=0.21, heading=_turned(angle)) for angle in (-12, -5, 5, 12)], 4, False),
        ([_evidence(gain=0.23, heading=_turned(angle)) for angle in (-12, -5, 5, 12)], 4, True),
        ([], 4, False),
    ],
)
def test_where_depth_shows_by_parallax(evidence, num_pairs, shows):
    assert choose_source(evidence, num_pairs, PARAMS).shows_depth is shows


def test_each_gain_has_its_own_threshold():
    ahead, aside = [_evidence(gain=0.3)] * 4, [_evidence(gain=0.3, **ASIDE)] * 4
    few, many = PARAMS.model_copy(update={"min_ahead_gain": 0.4}), PARAMS.model_copy(update={"min_gain": 0.4})
    assert [choose_source(pairs, 4, few).shows_depth for pairs in (ahead, aside)] == [False, True]
    assert [choose_source(pairs, 4, many).shows_depth for pairs in (ahead, aside)] == [True, False]
    assert choose_source(ahead, 4, few).proposals == "tracks"
