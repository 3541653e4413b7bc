"""Doubts about a result: one line an object."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.presets import QUALITIES
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.exports import summarise_sequence
from moseg.workflows.exports.doubts import Advice, advise

NUM_FRAMES = 60
NAMES = {1: 1, 2: 1, 3: 1, 4: 1, 5: 1}


def volume(heights, left=20, identity=1):
    """Return masks of an object 10 px wide and as high as `heights` says."""
    labels = np.zeros((len(heights), 40, 80), np.uint16)
    for frame, height in zip(labels, heights, strict=True):
        frame[5 : 5 + height, left : left + 10] = identity
    return labels


def look_at(labels, moves=None, confidences=None, **given):
    return summarise_sequence("clip", labels, 24.0, 2, NAMES, moves=moves, confidences=confidences, **given).look_at


def known(sure=1.0, complete=1.0, frames=range(NUM_FRAMES)):
    """Return confidences that are 1 but in some frames."""
    values = np.ones((NUM_FRAMES, 2, 6))
    values[list(frames), 0], values[list(frames), 1] = sure, complete
    return [(sure, complete) for sure, complete in values]


def moving(rests=()):
    return [np.array([-1] + [0 if frame in rests else 1] * 5, np.int8) for frame in range(NUM_FRAMES)]


def test_an_object_that_is_whole_and_moves_gives_no_doubt():
    assert look_at(volume([20] * NUM_FRAMES), moving(), known()) == ()


@pytest.mark.parametrize(
    ("rests", "what"), [((), "a part of it may have stopped"), (range(40, 60), "it may have stop")]
)
def test_an_object_that_loses_half_its_area_may_have_stopped(rests, what):
    (line,) = look_at(volume([20] * 40 + [9] * 20), moving(rests), known())
    assert line.startswith("object 1 loses half its area from frame 40 (6.2 to 2.8 % of the frame)")
    assert what in line and "frames 40 to 59" in line and "paint what is missing" in line


def growing(frames=range(40, 44), factor=9 / 20):
    """Return growths by which an object becomes so many times as large in some frames."""
    values = np.full((NUM_FRAMES, 6), np.nan)
    values[list(frames), 1] = np.log(factor) / len(frames)
    return list(values)


def test_an_object_that_goes_away_has_not_stopped():
    labels = volume([20] * 40 + [17, 14, 11] + [9] * 17)
    assert look_at(labels, moving(), known(), growths=growing()) == ()
    assert look_at(labels, moving(), known(), growths=[None] * 30 + growing()[30:]) == ()
    (line,) = look_at(labels, moving(), known(), growths=[None] * NUM_FRAMES)
    assert line.startswith("object 1 loses half its area from frame 43 (6.2 to 2.8 % of the frame)")


def test_growth_is_that_of_the_frames_in_which_an_object_is_seen():
    labels = volume([20] * 40 + [17, 14, 11] + [9] * 17)
    labels[:10] = 0
    assert look_at(labels, moving(), known(), growths=growing()) == ()


def test_an_object_that_goes_away_and_loses_more_may_have_stopped():
    labels = volume([20] * 40 + [9] * 12 + [4] * 8)
    (line,) = look_at(labels, moving(), known(), growths=growing())
    assert line.startswith("object 1 loses half its area from frame 52 (6.2 to 1.2 % of the frame)")


def test_an_object_that_grows_or_leaves_the_frame_has_not_stopped():
    assert look_at(volume([9] * 40 + [20] * 20), moving(), known()) == ()
    leaving = volume([20] * 40 + [9] * 20)
    leaving[40:, :, 70:80] = leaving[40:, :, 20:30]
    leaving[40:, :, 20:30] = 0
    assert look_at(leaving, moving(), known()) == ()


def test_an_incomplete_mask_and_a_doubtful_one_are_told_with_their_frames():
    whole = volume([20] * NUM_FRAMES)
    advice = advise(PipelineConfig(proposal_source="tracks"))
    (line,) = look_at(whole, moving(), known(complete=0.5, frames=range(10, 20)), advice=advice)
    assert line == (
        "object 1 is probably incomplete in frames 10 to 19: about 50 % of it is covered; try --quality best"
    )
    (line,) = look_at(whole, moving(), known(sure=0.4, frames=range(30, 60)), advice=advice)
    assert line == "object 1 is doubtful in frames 30 to 59: about 40 % of its mask moves; try --sensitivity 0.5"
    assert look_at(whole, moving(), known(sure=0.4, frames=range(30, 33))) == ()


def _choice(proposals="saliency", shows_depth=False):
    figures = {"moving": 1, "gain": 0.3, "inside": 1, "wander_deg": 0}
    return StretchChoice(
        first_frame=0, last_frame=59, proposals=proposals, reason="", shows_depth=shows_depth, **figures
    )


@pytest.mark.parametrize(
    ("config", "choices", "advice"),
    [
        ({}, [_choice()], Advice(too_small="try --quality best")),
        ({}, [_choice(), _choice("tracks")], Advice("try --quality best", "try --sensitivity 0.5")),
        ({}, [_choice(shows_depth=True)], Advice("try --quality best", "try --sensitivity 0.5")),
        (QUALITIES["best"], [_choice()], Advice()),
        ({"flow": {"method": "raft"}, "proposal_source": "detections"}, [], Advice()),
        ({"flow": {"method": "raft"}}, [_choice()], Advice(too_small="try --quality best")),
        (
            {"track_objects": {"sensitivity": 0.5}, "proposal_source": "tracks"},
            [],
            Advice("try --quality best", "try --sensitivity 0.25"),
        ),
    ],
)
def test_only_options_that_change_something_are_advised(config, choices, advice):
    assert advise(PipelineConfig.model_validate(config), choices) == advice


def test_what_the_user_drew_is_mended_by_the_brush_and_by_no_option():
    whole = volume([20] * NUM_FRAMES)
    for confidences, advice in (
        (known(sure=0.4), "erase what does not belong to it"),
        (known(complete=0.4), "paint what is missing"),
    ):
        (line,) = look_at(whole, moving(), confidences, drawn={1})
        assert line.endswith(f"; {advice}") and "--" not in line
    (line,) = look_at(volume([20] * 40 + [9] * 20), moving(), known(), drawn={1})
    assert line.endswith("paint what is missing") and "--" not in line


def test_a_doubt_has_the_name_that_the_user_gave():
    (line,) = look_at(volume([20] * NUM_FRAMES), moving(range(43, 60)), known(), given_names={1: "bear"})
    assert line == "object 1 (bear) stops: it rests in frames 43 to 59"


def test_an_object_that_stops_is_said_to_have_stopped():
    assert look_at(volume([20] * NUM_FRAMES), moving(range(43, 60)), known()) == (
        "object 1 stops: it rests in frames 43 to 59",
    )


def test_what_is_not_known_gives_no_doubt():
    assert look_at(volume([20] * NUM_FRAMES)) == ()


def test_of_many_objects_the_largest_are_told_and_the_others_counted():
    labels = sum(volume([20 - identity] * NUM_FRAMES, 12 * identity, identity) for identity in NAMES)
    *lines, last = look_at(labels, moving(), known(complete=0.5))
    assert [line[:8] for line in lines] == ["object 1", "object 2", "object 3"]
    assert last == "2 more objects; see per_frame in motion.json"
