"""Strokes and clicks in a run: what they reach, what they leave as it was, the same bytes however it is run."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.corrections import Corrections
from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import InputError
from moseg.workflows.api import segment_video
from moseg.workflows.api.open_run import open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.graph import SequenceGraph, SequenceLeaves

NUM_FRAMES = 12
CONFIG = {"sections.length": 4, "sections.overlap": 2, "carrying.reach": 2}
SPOT = {"radius": 5, "points": [[60, 20]]}


def _ref(task, text):
    return f"{task}/{digest_bytes('test', text.encode())}"


def _graph(edits=(), num_frames=NUM_FRAMES, **changes):
    config = PipelineConfig.model_validate(
        {"sections": {"length": 4, "overlap": 2}, "carrying": {"reach": 2}, "proposal_source": "saliency", **changes}
    )
    frames = tuple(_ref("frame", str(number)) for number in range(num_frames))
    weights = {"sam2.1-hiera-large": _ref("weights", "sam2")}
    given = Corrections.model_validate({"edits": list(edits)}).edits
    leaves = SequenceLeaves("toy", (48, 64), frames, motion_weights=_ref("motion_weights", ""), weights=weights)
    graph = SequenceGraph(leaves._replace(edits=given, frame_size=(96, 128)), config)
    graph.segmentations(Variant.FUSED)
    return graph


def _of(graph, task):
    return {ref: recipe for ref, recipe in graph.recipes.items() if recipe.task == task}


def paint(number, frame, kind="paint", **values):
    return {kind: {"object": number, "frame": frame, "strokes": [SPOT], **values}}


def add(number, frame, by="region"):
    return {"add": {"object": number, "frame": frame, "points": [[60, 20]], "by": by}}


def test_a_run_without_edits_has_no_recipe_of_them():
    tasks = {recipe.task for recipe in _graph().recipes.values()}
    assert not tasks & {"painted", "carried_mask", "tracked_mask", "grown_object", "corrected_objects"}


@pytest.mark.parametrize(
    ("frame", "reached"),
    [
        # The section of the frame, whole, and two frames before and after it.
        *((0, [4, 0, 0]), (1, [4, 0, 0]), (2, [4, 1, 0]), (4, [2, 4, 0]), (5, [1, 4, 0])),
        *((6, [0, 4, 1]), (9, [0, 1, 4]), (11, [0, 0, 4])),
    ],
)
def test_strokes_reach_their_section_and_the_frames_near_them(frame, reached):
    graph = _graph([paint(7, frame)])
    found = [0, 0, 0]
    for recipe in _of(graph, "carried_mask").values():
        numbers = [graph.leaves.frames.index(each) for each in recipe.inputs["frames"]]
        assert numbers == list(range(numbers[0], numbers[-1] + 1))
        found[numbers[0] // 4] = len(numbers)
    assert found == reached
    assert [graph.painted(index) is not None for index in range(3)] == [each > 0 for each in reached]


def test_a_mask_comes_into_the_next_section_along_the_flow_over_the_cut():
    graph = _graph([paint(7, 3)])
    (later,) = [recipe for recipe in _of(graph, "carried_mask").values() if recipe.params["method"] == "continued"]
    pairs = [(4 - 1, 4), (4, 5)]
    assert later.inputs["flow_forward"] == tuple(graph.frame_cues.flow(*pair) for pair in pairs)
    assert later.inputs["flow_backward"] == tuple(graph.frame_cues.flow(*pair[::-1]) for pair in pairs)


def test_a_stroke_changes_only_the_sections_that_it_reaches():
    before, after = _graph([paint(7, 0)]), _graph([paint(7, 0), paint(8, 11)])
    assert set(_of(before, "carried_mask")) < set(_of(after, "carried_mask"))
    assert before.painted(0) == after.painted(0)
    assert before.painted(2) is None and after.painted(2) is not None


def test_a_longer_video_keeps_the_keys_of_earlier_strokes():
    short, long = _graph([paint(7, 1)]), _graph([paint(7, 1)], num_frames=16)
    assert set(_of(short, "carried_mask")) == set(_of(long, "carried_mask"))
    assert short.painted(0) == long.painted(0)


def test_a_verdict_moves_no_key_of_strokes():
    edits = [paint(7, 1), add(8, 6)]
    before, after = _graph(edits), _graph([{"drop": 7}, *edits, {"rename": {"object": 8, "name": "kite"}}])
    for task in ("carried_mask", "grown_object", "painted"):
        assert set(_of(before, task)) == set(_of(after, task))


def test_what_sam2_tracks_reaches_the_whole_video():
    graph = _graph([add(7, 5, by="sam2")])
    assert {recipe.params["method"] for recipe in _of(graph, "tracked_mask").values()} == {"grown", "continued"}
    assert len(_of(graph, "tracked_mask")) == 3 and all(graph.painted(index) for index in range(3))
    assert not _of(graph, "carried_mask")
    assert "saliency" not in next(iter(_of(graph, "grown_object").values())).inputs


@pytest.fixture(scope="module")
def frames(tmp_path_factory, write_squares):
    return write_squares(tmp_path_factory.mktemp("video") / "clip", num_frames=NUM_FRAMES) / "frames"


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return tmp_path_factory.mktemp("painted") / "store"


@pytest.fixture(scope="module")
def run(frames, store):
    """Return a function from edits to a segmentation of the squares."""

    def call(edits=(), **options):
        options = {"store": store, **options}
        return segment_video(frames, CONFIG, corrections=list(edits), progress=False, keep_cues=True, **options)

    return call


@pytest.fixture(scope="module")
def plain(run):
    return run().labels


def _static(labels):
    """Return a point in the background of all frames, far from what moves."""
    from scipy.ndimage import distance_transform_edt

    distance = distance_transform_edt(np.pad(~labels.any(axis=0), 1))[1:-1, 1:-1]
    y, x = np.unravel_index(distance.argmax(), distance.shape)
    return int(x), int(y)


def test_paint_is_exact_in_its_frame_and_carried_to_others(run, plain):
    x, y = _static(plain)
    labels = run([{"paint": {"object": 9, "frame": 5, "strokes": [{"radius": 6, "points": [[x, y]]}]}}]).labels
    rows, columns = np.ogrid[: labels.shape[1], : labels.shape[2]]
    disc = (columns - x) ** 2 + (rows - y) ** 2 <= 36
    np.testing.assert_array_equal(labels[5] == 9, disc)
    painted = [(labels[frame] == 9).sum() / disc.sum() for frame in range(NUM_FRAMES)]
    # A section of 4..7, and two frames before and after frame 5: no seam at the cut between 3 and 4.
    assert all(0.5 < share < 1.5 for share in painted[3:8])
    assert not any(painted[:3]) and not any(painted[8:])
    np.testing.assert_array_equal(labels[8:], plain[8:])


@pytest.mark.parametrize("frame", [7, 8])
def test_a_section_of_one_frame_can_be_painted_and_reached(run, frame):
    x, y = _static(run(end=9).labels)
    spot = {"frame": frame, "strokes": [{"radius": 6, "points": [[x, y]]}]}
    labels = run([{"paint": {"object": 9, **spot}}], end=9).labels
    assert all((labels[each] == 9).any() for each in (6, 7, 8))


def test_what_was_erased_stays_erased_through_the_section(run, plain):
    inside = np.argwhere(plain[5] == 1)
    y, x = inside[len(inside) // 2].tolist()
    labels = run([{"erase": {"object": 1, "frame": 5, "strokes": [{"radius": 4, "points": [[x, y]]}]}}]).labels
    gone = [((plain[frame] == 1) & (labels[frame] != 1)).sum() for frame in range(NUM_FRAMES)]
    assert gone[5] > 20 and all(each > 0.4 * gone[5] for each in gone[4:8])
    assert set(np.unique(labels)) == set(np.unique(plain))


def test_a_click_brings_a_dropped_object_back(run, plain):
    inside = np.argwhere(plain[5] == 1)
    y, x = np.median(inside, axis=0).astype(int).tolist()
    labels = run([{"drop": 1}, {"add": {"object": 9, "frame": 5, "points": [[x, y]]}}]).labels
    found, wanted = labels[5] == 9, plain[5] == 1
    assert (found & wanted).sum() / (found | wanted).sum() > 0.6
    assert all((labels[frame] == 9).any() for frame in range(3, 8))


def test_later_strokes_override_earlier_ones(run, plain):
    x, y = _static(plain)
    spot = {"frame": 5, "strokes": [{"radius": 6, "points": [[x, y]]}]}
    both = run([{"paint": {"object": 8, **spot}}, {"paint": {"object": 9, **spot}}]).labels
    assert (both == 9).any() and not (both == 8).any()
    np.testing.assert_array_equal(run([{"paint": {"object": 9, **spot}}, {"erase": spot}]).labels, plain)


def test_erasing_an_object_follows_its_merges_and_splits(run, plain, frames, store):
    x, y = _static(plain)
    spot = {"frame": 5, "strokes": [{"radius": 6, "points": [[x, y]]}]}
    points = [np.argwhere(plain[5] == identity).mean(axis=0)[::-1].tolist() for identity in (1, 2)]
    erase = {"erase": {"object": 1, "frame": 5, "strokes": [{"radius": 6, "points": points}]}}
    paint, split = {"paint": {"object": 9, **spot}}, {"split": {"object": 9, "frame": 5}}
    into = {"split": {"object": 9, "frame": 5, "into": 12}}
    early = np.arange(NUM_FRAMES)[:, None, None] < 5
    erased, spots = run([erase]).labels, run([paint]).labels
    is_painted = spots == 9
    assert ((plain == 1) & (erased == 0))[5].any() and is_painted[4].any() and is_painted[6].any()
    cases = [
        ([erase, {"merge": [1, 2]}], np.where(erased == 2, 1, erased)),
        ([paint, split, {"erase": {"object": 10, **spot}}], np.where(is_painted & ~early, 0, spots)),
        ([paint, into, {"erase": {"object": 12, **spot}}], np.where(is_painted & ~early, 0, spots)),
        ([paint, into, {"erase": {"object": 9, **spot}}], np.where(is_painted, np.where(early, 0, 12), spots)),
    ]
    with open_run(frames, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        before = None
        for edits, wanted in cases:
            done = video.apply(edits)
            labels = np.stack([video.labels(frame) for frame in range(NUM_FRAMES)])
            np.testing.assert_array_equal(labels, wanted, err_msg=str(edits))
            np.testing.assert_array_equal(run(edits).labels, wanted, err_msg=str(edits))
            if before is not None:
                differ = {frame for frame in range(NUM_FRAMES) if (labels[frame] != before[frame]).any()}
                assert differ <= set(done.frames)
            before = labels


@pytest.mark.parametrize("later", [[], [{"merge": [9, 12]}]])
def test_a_split_before_a_stroke_that_erases_changes_its_frames(run, plain, frames, store, later):
    x, y = _static(plain)
    spot = {"frame": 5, "strokes": [{"radius": 6, "points": [[x, y]]}]}
    paint, erase = {"paint": {"object": 9, **spot}}, {"erase": {"object": 12, **spot}}
    with open_run(frames, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        found = []
        for frame in (5, 6):
            split = {"split": {"object": 9, "frame": frame, "into": 12}}
            done = video.apply([paint, split, erase, *later])
            found.append(np.stack([video.labels(each) for each in range(NUM_FRAMES)]))
    differ = {frame for frame in range(NUM_FRAMES) if (found[0][frame] != found[1][frame]).any()}
    assert differ == {5} and set(done.frames) == {5}


def test_workers_paint_the_same_bytes(run, plain, tmp_path):
    x, y = _static(plain)
    edits = [
        {"paint": {"object": 9, "frame": 5, "strokes": [{"radius": 6, "points": [[x, y]]}]}},
        {"add": {"object": 8, "frame": 2, "points": [[x, y]]}},
    ]
    wanted = run(edits).labels
    for workers in (1, 2):
        labels = run(edits, store=tmp_path / f"store{workers}", workers=workers).labels
        np.testing.assert_array_equal(labels, wanted)


@pytest.mark.parametrize(
    ("edit", "line"),
    [
        (paint(9, 40), "no such frame in corrections: edit 2 (paint); got 40; expected 0 to 11"),
        (
            {"paint": {"object": 9, "frame": 3, "strokes": [{"radius": 4, "points": [[-20, 2], [-9, 30]]}]}},
            "strokes outside the frame in corrections: edit 2 (paint); got -20, 2; expected a part within ",
        ),
        (
            {"add": {"object": 9, "frame": 3, "points": [[5000, 2]]}},
            "a point outside the frame in corrections: edit 2 (add); got 5000, 2; expected x from 0 to ",
        ),
        (
            {"add": {"object": 9, "frame": 99, "points": [[5, 2]]}},
            "no such frame in corrections: edit 2 (add); got 99; expected 0 to 11",
        ),
    ],
)
def test_what_cannot_be_painted_is_refused_in_one_line(run, edit, line):
    with pytest.raises(InputError) as refused:
        run([{"drop": 1}, edit])
    assert "\n" not in str(refused.value) and str(refused.value).startswith(line)


def test_a_click_by_sam2_without_weights_is_refused_in_one_line(run, monkeypatch, tmp_path):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "none"))
    with pytest.raises(InputError) as refused:
        run([{"add": {"object": 9, "frame": 3, "points": [[20, 20]], "by": "sam2"}}], offline=True)
    line = str(refused.value)
    assert "\n" not in line and "sam2.1-hiera-large" in line


def test_a_click_by_sam2_is_tracked_through_the_video(run, plain, monkeypatch, tmp_path):
    pytest.importorskip("transformers")
    from moseg.workflows.cli.app import run as command

    assert command(["weights", "tiny", str(tmp_path / "tiny")]) == 0
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "tiny"))
    x, y = _static(plain)
    edits = [{"add": {"object": 9, "frame": 5, "points": [[x, y]], "not_points": [[2, 2]], "by": "sam2"}}]
    first = run(edits, offline=True)
    assert (first.labels[5] == 9).any()
    reached = [frame for frame in range(NUM_FRAMES) if (first.labels[frame] == 9).any()]
    assert {4, 5, 6} <= set(reached)
    again = run(edits, offline=True)
    assert again.store_use.computed == 0
    np.testing.assert_array_equal(first.labels, again.labels)
