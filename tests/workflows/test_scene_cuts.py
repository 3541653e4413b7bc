"""Cuts of a video: their recipes, and what a run says of them."""

import json
import shutil

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.digests import digest_bytes
from moseg.workflows.exports.scene_cuts import describe_cuts
from moseg.workflows.graph import SequenceGraph, SequenceLeaves

LENGTH, WINDOW = 8, 2
PARAMS = {"stretch_length": LENGTH, "window": WINDOW}


def _cuts(names, **changes):
    """Return the cuts of a video of these frames, with their recipes."""
    frames = tuple(f"frame/{digest_bytes('test', str(name).encode())}" for name in names)
    config = PipelineConfig.model_validate({"scene_cuts": PARAMS | changes})
    graph = SequenceGraph(SequenceLeaves("toy", (48, 64), frames), config)
    return frames, [(each, graph.recipes[each.ref]) for each in graph.scene_cuts()]


def test_every_frame_is_judged_once_with_a_window_on_either_side():
    frames, cuts = _cuts(range(30))
    judged = []
    for each, recipe in cuts:
        first, last = recipe.params["first"], recipe.params["last"]
        assert recipe.inputs["frames"] == frames[each.first : each.first + len(recipe.inputs["frames"])]
        judged += range(each.first + first, each.first + last)
    assert judged == [*range(30)]


def test_the_place_of_a_stretch_is_in_no_key():
    (_, before), (_, after) = _cuts(range(40)), _cuts([*range(100, 108), *range(40)])
    assert {each.ref for each, _ in before[1:]} <= {each.ref for each, _ in after}


def test_nothing_is_searched_in_two_frames_or_where_that_is_switched_off():
    assert not _cuts(range(2))[1] and not _cuts(range(30), max_consistent=0)[1]


def test_many_cuts_are_counted():
    assert not describe_cuts(())
    assert describe_cuts([4])[0].startswith("cut before frame 4: objects are not followed over it")
    (line,) = describe_cuts(range(1, 20))
    assert line.startswith("cuts before frames 1, 2, 3, 4, 5, 6, 7, 8 and 11 more: ")


def test_cuts_between_scenes_that_were_segmented_apart_are_named_first():
    apart, other = describe_cuts((1, 4, 9), apart=(4, 9))
    assert apart.startswith("cuts before frames 4, 9: the scenes are segmented apart")
    assert other.startswith("cut before frame 1: objects are not followed over it")


def test_a_run_says_where_the_scene_changes(moseg, write_squares, tmp_path):
    """The shot of other squares begins with frame 6, and is found again from the store."""
    first, second = (write_squares(tmp_path / str(seed), num_frames=6, seed=seed) / "frames" for seed in (0, 7))
    joined = tmp_path / "joined"
    shutil.copytree(first, joined)
    for number, path in enumerate(sorted(second.iterdir())):
        shutil.copy(path, joined / f"{6 + number:05}{path.suffix}")

    def look_at(video):
        out = tmp_path / "out"
        ran = moseg("segment", video, "--out", out, "--store", tmp_path / "store", "--quiet")
        assert ran.code == 0, ran.err
        return json.loads((out / "motion.json").read_text())["look_at"]

    for _ in range(2):
        assert any(line.startswith("cut before frame 6: ") for line in look_at(joined))
    assert not any("cut" in line for line in look_at(first))
