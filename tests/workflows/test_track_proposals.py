"""Proposals from dense tracks: windows of sections, recipes, and whole runs."""

import json
import re
import shutil
from functools import cache
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.store import open_store
from moseg.tasks.object_points import ObjectPoints
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.inputs import ArtifactView, Inputs
from moseg.workflows.stages.registry import find_stage

FOUND = {"track_objects", "object_points", "proposals", "linking", "tracks"}
DRAWN = FOUND - {"track_objects", "object_points"}
CANDIDATES = {"moving_tracks", "track_groups"}
SURFACES = {"track_surfaces"}
END = {"fundamental", "fundamental_residual", "flow_model", "flow_residual", "affinity"}
LAST = {"clustering", "segmentation", "score"}
END |= {"rigid_support", *LAST}
GROUPING = PipelineConfig().track_groups.clustering
ALL_KEPT = GROUPING.outliers.model_copy(update={"min_affinity": 0.0})


def _refs(task, count):
    return tuple(f"{task}/{digest_bytes('test', f'{task} {number}'.encode())}" for number in range(count))


def _graph(num_frames=30, *, leaves=None, **changes):
    values = {"proposal_source": "tracks", "sections": {"length": 8}, "track_window": {"min_frames": 10}}
    config = PipelineConfig.model_validate(values | changes)
    given = {"annotation": _refs("annotation", 1)[0], **(leaves or {})}
    return SequenceGraph(
        SequenceLeaves(
            name="toy",
            shape=(48, 64),
            frames=_refs("frame", num_frames),
            motion_weights=_refs("motion_weights", 1)[0],
            **given,
        ),
        config,
    )


def _recipes(num_frames=30, variant=Variant.FUSED, **changes):
    graph = _graph(num_frames, **changes)
    graph.score(variant)
    return graph.recipes


def _tasks(refs):
    return {ref.partition("/")[0] for ref in refs}


@given(st.integers(2, 90), st.integers(1, 30), st.integers(1, 8), st.integers(2, 25))
def test_a_window_contains_its_section_and_is_no_shorter_than_the_video_allows(num_frames, length, overlap, min_frames):
    window = {"overlap": overlap, "min_frames": min_frames}
    objects = _graph(num_frames, sections={"length": length}, track_window=window).objects
    starts = range(0, num_frames, length)
    for index, start in enumerate(starts):
        first, last = objects.track_proposals.window(index)
        assert 0 <= first <= start < last <= num_frames
        assert last - first >= min(min_frames, last)
        assert objects.track_proposals.first_row(index) == start - first
        assert objects.labelled_until(index) == last
        if first < start:
            assert last - first == min_frames or first == 0
    for index, (_, start) in enumerate(pairwise(starts)):
        assert 1 <= objects.labelled_until(index) - start <= overlap


def test_objects_are_found_without_saliency():
    tasks = _tasks(_recipes())
    assert {"dense_tracks", "rigidity", *CANDIDATES, *SURFACES, *FOUND} <= tasks
    assert not tasks & {"saliency", "components", "background"}


def test_every_input_is_a_leaf_or_a_node():
    cues = {"depth": _refs("given_depth", 30), "tracks": _refs("given_tracks", 1)[0]}
    flows = {name: _refs(f"given_{name}", 29) for name in ("flow_forward", "flow_backward")}
    methods = {"depth": {"method": "folder"}, "flow": {"method": "folder"}}
    recipes = _recipes(leaves=cues | flows, **methods)
    leaves = {*_refs("frame", 30), *_refs("annotation", 1), *cues["depth"], *flows["flow_forward"]}
    leaves |= set(flows["flow_backward"])
    read = {ref for recipe in recipes.values() for ref in recipe.input_refs()}
    assert read <= recipes.keys() | leaves
    assert set(flows["flow_backward"]) <= read
    rigidity = [recipe for recipe in recipes.values() if recipe.task == "rigidity"]
    assert all(len(recipe.inputs["depth"]) == len(recipe.inputs["frames"]) for recipe in rigidity)


@pytest.mark.parametrize(
    ("changes", "moved"),
    [
        ({"track_masks": {"radius": 20.0}}, DRAWN | END),
        ({"object_points": {"max_motions": 1}}, DRAWN | {"object_points"} | END),
        ({"track_objects": {"min_score": 300.0}}, FOUND | END),
        ({"track_objects": {"sensitivity": 2.0}}, FOUND | END),
        ({"track_groups": {"max_static": 100}}, {"track_groups"} | FOUND | END),
        ({"track_groups": {"seed": 1}}, {"track_groups"} | FOUND | END),
        ({"track_groups": {"num_samples": 1}}, {"track_groups"} | FOUND | END),
        ({"track_groups": {"kernel": {"window": 0.2}}}, {"track_groups"} | FOUND | END),
        ({"track_groups": {"kernel": {"max_tracks": 100}}}, set()),
        ({"track_groups": {"clustering": GROUPING.model_copy(update={"num_more": 0})}}, set()),
        ({"track_groups": {"clustering": GROUPING.model_copy(update={"outliers": ALL_KEPT})}}, set()),
        ({"track_field": {"coupling": 1.0}}, CANDIDATES | FOUND | END),
        ({"track_candidates": {"radius": 20.0}}, CANDIDATES | FOUND | END),
        ({"rigidity": {"noise": 0.4}}, {"rigidity"} | CANDIDATES | SURFACES | FOUND | END),
        ({"track_surfaces": {"agreement": 0.1}}, SURFACES | FOUND | END),
        ({"track_surfaces": {"max_candidates": 4}}, DRAWN | END),
        ({"track_surfaces": {"mask_radius": 20.0}}, DRAWN | END),
        ({"track_objects": {"min_surface": 0.5}}, FOUND | END),
        ({"rigid_support": {"use": "never"}}, LAST),
        ({"rigid_support": {"max_test": 0.9}}, set()),
        ({"saliency": {"floor": 0.4}}, set()),
        ({"sections": {"length": 8, "overlap": 3}}, set()),
    ],
)
def test_an_option_changes_the_keys_of_the_stages_that_read_it_and_no_others(changes, moved):
    assert _tasks(_recipes(**changes).keys() - _recipes().keys()) == moved


def test_more_frames_do_not_change_the_objects_of_sections_before_them():
    short, long = ([_graph(count).objects.proposals(index) for index in range(2)] for count in (30, 50))
    assert short == long


def test_static_candidates_of_a_video_are_bounded():
    recipes = _recipes(8 * 12, track_surfaces={"max_candidates": 4, "halved_after": 3})
    numbers = [recipe.params["max_static"] for recipe in recipes.values() if recipe.task == "proposals"]
    assert sorted(numbers, reverse=True) == [4] * 3 + [2] * 3 + [1] * 3 + [0] * 3


def test_sections_at_the_end_share_their_window():
    proposed = _graph(26, track_window={"min_frames": 20}).objects.track_proposals
    assert proposed.window(2) == proposed.window(3)
    assert proposed.objects(2) == proposed.objects(3)


@pytest.fixture(scope="module")
def evaluated_tracks(squares, tmp_path_factory):
    """Return the store of an evaluation of squares by tracks, in sections of four frames."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("tracks")
    arguments = ("eval", "--dataset", "folder", "--root", str(squares), "--quiet", "--section-length", "4")
    # The squares move in a plane: what is found does not matter here, but that something is.
    arguments += ("--proposals", "tracks", "--set", "track_objects.min_score=20", "--set", "track_objects.min_test=0")
    report = folder / "report.html"
    assert run([*arguments, "--store", str(folder / "store"), "--report", str(report)]) == 0
    return open_store(str(folder / "store"), create=False), report.read_text(encoding="utf-8")


def test_points_of_objects_vote_for_masks(squares, tmp_path, monkeypatch):
    from moseg.workflows.cli.app import run

    place = 4

    def follow_objects(read_frame, points, visible, objects, params):
        assert read_frame(visible.shape[1] - 1).dtype == np.uint8
        beside = np.stack(np.meshgrid(np.arange(-2, 3), np.arange(-2, 3)), axis=-1).reshape(-1, 1, 2)
        followed = np.repeat(place + beside, visible.shape[1], axis=1).astype(np.float32)
        numbers = np.full(len(followed), objects.max(initial=0), objects.dtype)
        return ObjectPoints(followed, np.ones(followed.shape[:2], bool), numbers)

    monkeypatch.setattr("moseg.tasks.object_points.follow_objects", follow_objects)
    arguments = ("eval", "--dataset", "folder", "--root", str(squares), "--quiet", "--section-length", "4")
    arguments += ("--proposals", "tracks", "--set", "track_objects.min_score=20", "--set", "track_objects.min_test=0")
    assert run([*arguments, "--workers", "0", "--store", str(tmp_path / "store")]) == 0
    store = open_store(str(tmp_path / "store"), create=False)
    found = [store.read(ref, "masks") for ref in store.refs("proposals")]
    moving = [store.attributes(ref)["is_moving"] for ref in store.refs("proposals")]
    assert any(any(each) for each in moving)
    for masks, is_moving in zip(found, moving, strict=True):
        assert (masks[:, place, place] > 0).all() == any(is_moving)


def test_static_candidates_are_looked_for_among_the_tracks_that_the_section_shows(squares, tmp_path, monkeypatch):
    """The window of the last section begins before it."""
    from moseg.tasks import track_objects
    from moseg.workflows.cli.app import run

    given, chosen = [], track_objects.static_candidates

    def static_candidates(objects, is_moving, surface, max_candidates):
        given.append((objects > 0) | (surface > 0))
        return chosen(objects, is_moving, surface, max_candidates)

    monkeypatch.setattr(track_objects, "static_candidates", static_candidates)
    arguments = ("eval", "--dataset", "folder", "--root", str(squares), "--quiet", "--section-length", "4")
    arguments += ("--proposals", "tracks", "--set", "dense_tracks.min_frames=2", "--workers", "0")
    assert run([*arguments, "--store", str(tmp_path / "store")]) == 0
    store = open_store(str(tmp_path / "store"), create=False)
    recipes = [store.manifest(ref).recipe for ref in store.refs("proposals")]
    seen = []
    for recipe in recipes:
        visible = store.read(recipe.inputs["dense_tracks"], "visible")
        start = recipe.params["start"]
        seen.append(visible[:, start : start + len(recipe.inputs["frames"])].any(axis=1))
    assert any(not each.all() for each in seen)
    # Sections are neither stored nor computed in their order, and may have equally many tracks.
    assert any(
        all(len(each) == len(shown) and not (each & ~shown).any() for each, shown in zip(given, order, strict=True))
        for order in permutations(seen)
    )
    assert any(each.any() for each in given)


def test_proposals_are_objects_and_surfaces_that_have_pixels(evaluated_tracks):
    store, _ = evaluated_tracks
    refs = list(store.refs("proposals"))
    assert len(refs) == 3
    for ref in refs:
        found = store.manifest(ref).recipe.inputs["track_objects"]
        masks, scores = store.read(ref, "masks"), store.read(ref, "scores")
        attributes = store.attributes(ref)
        assert np.unique(masks).tolist() == list(range(len(scores) + 1))
        assert len(scores) == len(attributes["candidates"]) == len(attributes["is_moving"]) > 0
        moving = store.read(found, "is_moving")
        # Objects of tracks, and after them surfaces, which have no score and do not move.
        numbers = {number: index for index, number in enumerate(attributes["candidates"])}
        judged = [(number, numbers[number]) for number in numbers if number <= len(moving)]
        assert judged
        for number, index in judged:
            assert scores[index] == store.read(found, "scores")[number - 1]
            assert attributes["is_moving"][index] == moving[number - 1]
        assert not scores[len(judged) :].any() and not any(attributes["is_moving"][len(judged) :])
        assert len(store.attributes(found)["test"]) == len(store.read(found, "scores"))


def test_objects_are_groups_of_the_candidates_tracks(evaluated_tracks):
    store, _ = evaluated_tracks
    for ref in store.refs("track_objects"):
        inputs = store.manifest(ref).recipe.inputs
        state, candidate = (store.read(inputs["moving_tracks"], name) for name in ("state", "candidate"))
        found = store.read(ref, "object")
        assert found.shape == candidate.shape == state.shape
        assert not candidate[state <= 0].any()
        assert not found[candidate == 0].any()
        num_objects = len(store.read(ref, "is_moving"))
        attributes = store.attributes(ref)
        assert attributes.pop("own_vehicle") == 0
        assert {len(values) for values in attributes.values()} == {num_objects}
        assert found.max(initial=0) == num_objects


def test_surfaces_do_not_bring_tracks_of_the_cameras_vehicle_back(evaluated_tracks, monkeypatch):
    from moseg.tasks import track_objects

    store, _ = evaluated_tracks
    recipe = store.manifest(next(iter(store.refs("track_objects")))).recipe
    given, array = [], ArtifactView.array

    def without_own_vehicle(groups, points, *more):
        return groups._replace(group=np.where(np.arange(len(points)) % 2, -1, groups.group))

    def regroup_candidates(points, *more):
        return track_objects.RegroupedTracks(np.zeros(len(points), int), np.array([False]))

    judge = track_objects.judge_objects
    monkeypatch.setattr(track_objects, "without_own_vehicle", without_own_vehicle)
    monkeypatch.setattr(track_objects, "regroup_candidates", regroup_candidates)
    monkeypatch.setattr(track_objects, "judge_objects", lambda *args: given.append(args) or judge(*args))
    monkeypatch.setattr(ArtifactView, "array", lambda view, name: array(view, name) + (name == "surface"))
    output = find_stage("track_objects").tasks[0].run(recipe.params, Inputs(store, recipe), None)
    (groups, _, surface, *_), number = given[0], output.attributes["own_vehicle"]
    assert number == np.count_nonzero(groups.group < 0) > 0
    np.testing.assert_array_equal(surface == 0, groups.group < 0)


def test_a_report_shows_the_dense_tracks(evaluated_tracks):
    _, page = evaluated_tracks
    assert "dense tracks" in page
    assert "too little evidence" in page


def test_two_frames_of_nothing_give_no_object(moseg, write_image, tmp_path):
    for number in range(2):
        write_image(tmp_path / "video" / f"{number}.png", np.full((64, 64, 3), 90, np.uint8))
    options = ("--proposals", "tracks", "--out", tmp_path / "out", "--store", tmp_path / "store", "--quiet")
    ran = moseg("segment", tmp_path / "video", *options)
    assert ran.code == 0
    assert "0 moving objects" in ran.out


@pytest.fixture(scope="module")
def evaluate_drive(tmp_path_factory):
    """Return a function that evaluates a drive past walls towards a car; it returns Fu, the store and the report."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("drive")

    @cache
    def call(variant, *options):
        store, page = folder / ("changed" if options else "store"), folder / "page.html"
        if options and not store.exists():
            # The cues are those of the run before, which the caller has made.
            shutil.copytree(folder / "store", store)
        data = ("eval", "--dataset", "synthetic", "--sequences", "forward-drive-epipolar-car", "--proposals", "tracks")
        given = ("--variant", variant, "--store", store, "--report", page, "--json", folder / "scores.json", "--quiet")
        assert run([str(each) for each in (*data, *given, *options)]) == 0
        (row,) = json.loads((folder / "scores.json").read_text())["rows"]
        return row["mean"]["F"], open_store(str(store), create=False), page.read_text(encoding="utf-8")

    return call


def test_a_car_that_comes_along_its_epipolar_line_is_found_among_static_surfaces(evaluate_drive):
    score, store, _ = evaluate_drive("fused")
    assert score > 50
    (ref,) = store.refs("proposals")
    attributes, scores = store.attributes(ref), store.read(ref, "scores")
    assert attributes["is_moving"] == [True, False, False, False, False]
    assert (scores > 0).tolist() == attributes["is_moving"]
    (ref,) = store.refs("rigid_support")
    assert store.read(ref, "support").tolist() == [1, 0, 1, 1, 1, 1]


def test_samples_of_tracks_are_grouped_one_by_one(evaluate_drive):
    _, store, _ = evaluate_drive("fused")
    (ref,) = store.refs("track_groups")
    candidate = store.read(store.manifest(ref).recipe.inputs["moving_tracks"], "candidate")
    sample, track, is_candidate, motion = (
        store.read(ref, name) for name in ("sample", "track", "is_candidate", "motion")
    )
    assert sample.shape == track.shape == is_candidate.shape == motion.shape
    assert np.unique(sample).tolist() == list(range(5))
    np.testing.assert_array_equal(candidate[track] > 0, is_candidate)
    for number in range(5):
        drawn = track[sample == number]
        assert len(np.unique(drawn)) == len(drawn)
        assert np.unique(motion[sample == number]).tolist() == list(range(motion[sample == number].max() + 1))


def test_base_takes_all_surfaces_as_moving_and_without_them_equals_fused(evaluate_drive):
    fused, base = evaluate_drive("fused")[0], evaluate_drive("base")[0]
    assert base < fused / 2
    without = ("--set", "track_surfaces.max_candidates=0")
    assert evaluate_drive("base", *without)[0] == evaluate_drive("fused", *without)[0] > 50


def test_a_report_of_dense_tracks_names_the_objects_that_are_drawn_in_colour(evaluate_drive):
    _, _, page = evaluate_drive("fused")
    layer = re.search(r'"layer-name">dense tracks<.*?class="legend">(.*?)</div>', page, re.DOTALL)
    assert re.findall(r"</svg>([^<]*)<", layer[1]) == ["object 1, motion 1", "too little evidence"]
