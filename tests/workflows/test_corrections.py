"""Corrections of a segmentation: the same from the command line, a file and Python, cached, and refused in one line."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.store import open_store
from moseg.workflows.api import segment_video
from moseg.workflows.api.open_run import open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.corrections_file import read_corrections, spell_corrections
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.exports import OverlayStyle
from moseg.workflows.reports.from_log import report_run

CONFIG = {"sections.length": 4, "sections.overlap": 2}
SETTINGS = [word for name, value in CONFIG.items() for word in ("--set", f"{name}={value}")]
EDITS = [{"split": {"object": 2, "frame": 5, "into": 4}}, {"rename": {"object": 4, "name": "late"}}, {"drop": 1}]
OPTIONS = ["--split", "2@5:4", "--rename", "4=late", "--drop", "1"]


@pytest.fixture(scope="module")
def frames(squares):
    return squares / "squares" / "frames"


@pytest.fixture(scope="module")
def store(tmp_path_factory, frames):
    """Return a store that has the squares' result, with its cues."""
    folder = tmp_path_factory.mktemp("corrections") / "store"
    segment_video(frames, CONFIG, store=folder, progress=False, keep_cues=True)
    return folder


@pytest.fixture
def segment(moseg, frames, store, in_empty_folder):
    """Return a function that runs `moseg segment` on the squares with options."""

    def call(*options, out="out", video=frames):
        return moseg("segment", video, "--out", out, "--store", store, "--quiet", "--keep-cues", *SETTINGS, *options)

    return call


def _masks(folder):
    return np.stack([np.asarray(Image.open(path)) for path in sorted((folder / "masks").iterdir())])


def _video(frames, store, corrections):
    return segment_video(frames, CONFIG, store=store, progress=False, keep_cues=True, corrections=corrections)


@pytest.fixture
def labels(frames, store):
    """Return a function from corrections to labels, frame by frame."""
    return lambda corrections=None: _video(frames, store, corrections).labels


def test_every_way_of_giving_the_same_corrections_has_the_same_bytes(segment, frames, store, tmp_path):
    (tmp_path / "fixes.yaml").write_text(
        "version: 1\nedits:\n- split: {object: 2, frame: 5, into: 4}\n- rename: {object: 4, name: late}\n- drop: 1\n"
    )
    (tmp_path / "first.yaml").write_text("version: 1\nedits:\n- split: {object: 2, frame: 5, into: 4}\n")
    assert segment(*OPTIONS, out=tmp_path / "options").code == 0
    assert segment("--corrections", tmp_path / "fixes.yaml", out=tmp_path / "file").code == 0
    assert segment("--corrections", tmp_path / "first.yaml", *OPTIONS[2:], out=tmp_path / "both").code == 0
    for name, given in (("mapping", {"edits": EDITS}), ("list", EDITS), ("path", tmp_path / "fixes.yaml")):
        _video(frames, store, given).save(tmp_path / name)
    wanted = {path.name: path.read_bytes() for path in (tmp_path / "options" / "masks").iterdir()}
    for name in ("file", "both", "mapping", "list", "path"):
        assert {path.name: path.read_bytes() for path in (tmp_path / name / "masks").iterdir()} == wanted
        for file in ("motion.json", "corrections.yaml"):
            assert (tmp_path / name / file).read_bytes() == (tmp_path / "options" / file).read_bytes()
    assert sorted(np.unique(_masks(tmp_path / "options"))) == [0, 2, 4]


def test_an_open_run_has_the_labels_of_the_command_line_after_every_change(segment, frames, store, tmp_path):
    changes = [
        [],
        [{"drop": 1}],
        [{"drop": 1}, {"keep": 1}],
        [{"merge": [2, 1]}],
        EDITS,
        {"settings": {"clustering.motions": 2}},
        {"settings": {"clustering.motions": 2}, "edits": [{"moving": 1}, {"moving": 2}]},
        {"settings": {"affinity.scale": 0.9}, "edits": [{"static": 2}]},
        {"settings": {"components.min_area": 0.02}},
        {"settings": {"moving_objects.min_area": 0.054}},
        {"settings": {"moving_objects.min_area": 0.5}, "edits": [{"keep": 2}]},
        [],
    ]
    with open_run(frames, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        before = None
        for index, change in enumerate(changes):
            done = video.apply(change)
            labels = np.stack([video.labels(frame) for frame in range(video.num_frames)])
            (tmp_path / "fixes.yaml").write_text(spell_corrections(read_corrections(change)))
            assert segment("--corrections", tmp_path / "fixes.yaml", out=tmp_path / f"out{index}").code == 0
            np.testing.assert_array_equal(labels, _masks(tmp_path / f"out{index}"))
            if before is not None:
                differ = [frame for frame in range(len(labels)) if (labels[frame] != before[frame]).any()]
                assert set(differ) <= set(done.frames)
            before = labels


def test_each_edit_does_what_it_says(labels):
    plain = labels()
    first, second = plain == 1, plain == 2
    assert first.any() and second.any()
    late = np.arange(len(plain))[:, None, None] >= 5
    between = float(np.mean([each.mean(axis=(1, 2)).max() for each in (first, second)]))
    cases = [
        ([{"drop": 1}], np.where(second, 2, 0)),
        ([{"static": 2}], np.where(first, 1, 0)),
        ([{"drop": 1}, {"keep": 1}], plain),
        ([{"merge": [2, 1]}], np.where(first | second, 2, 0)),
        # The merged object is in the result if one of its parts is.
        ([{"static": 2}, {"merge": [2, 1]}], np.where(first | second, 2, 0)),
        ([{"static": 2}, {"drop": 1}, {"merge": [2, 1]}], np.zeros_like(plain)),
        ([{"split": {"object": 2, "frame": 5}}], np.where(second & late, 3, plain)),
        ([{"split": {"object": 2, "frame": 5, "into": 9}}, {"merge": [1, 9]}], np.where(second & late, 1, plain)),
        ([{"rename": {"object": 1, "name": "left"}}], plain),
        ({"settings": {"clustering.motions": 1}}, np.zeros_like(plain)),
        ({"settings": {"moving_objects.min_area": between}}, np.where(first, 1, 0)),
        ({"settings": {"moving_objects.min_area": 0.5}}, np.zeros_like(plain)),
        ({"settings": {"clustering.motions": 1}, "edits": [{"keep": 2}]}, np.where(second, 2, 0)),
    ]
    for corrections, wanted in cases:
        np.testing.assert_array_equal(labels(corrections), wanted, err_msg=str(corrections))


def test_motions_count_what_was_dropped_and_names_are_in_the_summary(frames, store, tmp_path):
    result = _video(frames, store, [{"drop": 2}, {"rename": {"object": 1, "name": "<b>left</b>"}}])
    assert (result.num_motions, [each.identity for each in result.objects]) == (3, [1])
    assert result.objects[0].name == "<b>left</b>"
    assert "&lt;b&gt;left&lt;/b&gt;" in result._repr_html_() and "<b>left" not in result._repr_html_()
    result.save(tmp_path / "out")
    (found,) = json.loads((tmp_path / "out" / "motion.json").read_text())["objects"]
    assert (found["identity"], found["name"], found["tag"]) == (1, "<b>left</b>", None)
    static = _video(frames, store, [{"static": 2}])
    assert (static.num_motions, [each.motion for each in static.objects]) == (2, [1])


def test_the_users_names_are_in_exports_and_doubts(moseg, frames, store, in_empty_folder):
    strokes = [{"radius": 6, "points": [[20, 20]]}]
    edits = [{"paint": {"object": 9, "frame": 5, "strokes": strokes}}, {"rename": {"object": 9, "name": "kite, red"}}]
    result = _video(frames, store, edits)
    result.save("out")
    # Nothing moves where it was painted, and no option changes that.
    (doubt,) = [line for line in result.look_at if line.startswith("object 9")]
    assert doubt.startswith("object 9 (kite, red) ") and "--" not in doubt
    assert moseg("export", "out", "--to", "coco").code == 0
    with open("out/coco.json") as file:
        assert {each["name"] for each in json.load(file)["categories"]} == {"kite, red", "moving object"}


def test_an_object_that_a_correction_made_has_figures_of_its_masks_and_no_support(frames, store):
    found = {each.identity: each for each in _video(frames, store, EDITS[:1]).objects}
    assert set(found) == {1, 2, 4}
    assert found[4].first_frame == 5 and found[4].sure > 0.9 and found[4].moving_frames
    assert found[4].static_support == {} and found[4].score is None
    assert found[2].score > 0.9


def test_the_same_corrections_are_found_in_the_store_and_none_recompute_nothing(frames, store):
    _video(frames, store, EDITS)
    assert _video(frames, store, EDITS).store_use.computed == 0
    assert _video(frames, store, None).store_use.computed == 0
    assert _video(frames, store, []).store_use.computed == 0
    assert _video(frames, store, [{"rename": {"object": 1, "name": "x"}}]).store_use.computed == 0
    # The objects; and labels, moves and confidences of three sections.
    more = _video(frames, store, [*EDITS, {"merge": [2, 4]}])
    assert more.store_use.computed <= 10


def test_what_is_left_out_needs_no_cues(frames, tmp_path):
    """They are not in the store after a run that does not keep them."""
    arguments = {"store": tmp_path / "store", "progress": False}
    plain = segment_video(frames, CONFIG, **arguments)
    for corrections in ([{"drop": 1}, {"rename": {"object": 2, "name": "x"}}], [{"static": 2}]):
        done = segment_video(frames, CONFIG, corrections=corrections, **arguments)
        assert done.store_use.computed == 4
        (left,) = done.objects
        before = next(each for each in plain.objects if each.identity == left.identity)
        assert (left.sure, left.moving_frames, left.score) == (before.sure, before.moving_frames, before.score)


def test_why_names_the_edit(frames, moseg, tmp_path):
    store = tmp_path / "store"
    listing = ("store", "ls", "--task", "segmentation", "--store", store)
    segment_video(frames, CONFIG, store=store, progress=False, keep_cues=True, corrections=[{"drop": 1}])
    before = set(moseg(*listing).out.split())
    segment_video(frames, CONFIG, store=store, progress=False, keep_cues=True, corrections=[{"drop": 2}])
    new = min(set(moseg(*listing).out.split()) - before)
    ran = moseg("store", "why", new, "--store", store)
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.splitlines()[-1] == "  params.steps[0].objects[0]: 2 here, 1 there"


WRONG = {
    "no such object in --drop 7; got 7; expected one of 1, 2": ["--drop", "7"],
    "no such object in --drop 1; got 1; expected one of 2": ["--merge", "2,1", "--drop", "1"],
    "no such frame in --split 2@50; got 50; expected 0 to 9": ["--split", "2@50"],
    "a number in use in --split 2@5:1; got 1; expected a number not in use, such as 3": ["--split", "2@5:1"],
    "not a correction in --split; got 2; expected OBJECT@FRAME, such as 2@31, or 2@31:7": ["--split", "2"],
    "not a correction in --merge; got 1,x; expected numbers of objects, separated by commas": ["--merge", "1,x"],
    "not a correction in --rename; got 1; expected OBJECT=NAME, such as 2=bear": ["--rename", "1"],
    "bad corrections in --merge 1; got [1]; expected at least 2": ["--merge", "1"],
    "bad corrections in --merge 1,1; got [1, 1]; expected objects that differ": ["--merge", "1,1"],
    "bad corrections in --split 0@5:3: object; got 0; expected": ["--split", "0@5:3"],
    "bad corrections in --split 2@0: frame; got 0; expected": ["--split", "2@0"],
    "bad corrections in --rename 2=: name; got ''; expected": ["--rename", "2="],
    "bad corrections in --drop 1,0; got 0; expected": ["--drop", "1,0"],
    "no such corrections file in none.yaml": ["--corrections", "none.yaml"],
}


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_option_is_one_line(segment, line):
    ran = segment(*WRONG[line])
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(f"moseg: {line}") and ran.err.count("\n") == 1, ran.err


FILES = {
    "no such object in fixes.yaml: edit 2 (drop); got 7; expected one of 1, 2": "edits:\n- keep: 1\n- drop: 7\n",
    "corrections of another video in fixes.yaml; got those of video abab": f"video: '{'ab' * 32}'\n",
    "an unknown kind of edit in fixes.yaml: edit 1; got 'dorp'; expected drop?": "edits:\n- dorp: 7\n",
    "bad parameter in fixes.yaml: clustering.threshold; got '7'": "settings: {clustering.threshold: 7}\n",
    "no ground truth of your own video in --motions; got gt": "settings: {clustering.motions: gt}\n",
}


@pytest.mark.parametrize("line", FILES)
def test_a_wrong_file_is_one_line(segment, in_empty_folder, line):
    with open("fixes.yaml", "w") as file:
        file.write("version: 1\n" + FILES[line])
    ran = segment("--corrections", "fixes.yaml")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(f"moseg: {line}") and ran.err.count("\n") == 1, ran.err


def test_several_videos_cannot_be_corrected_at_once(moseg, frames, in_empty_folder):
    ran = moseg("segment", frames, frames.parent / "masks", "--drop", "1")
    assert (ran.code, ran.err.count("\n")) == (2, 1)
    assert "corrections of several videos in --drop; got 2 videos; expected one video" in ran.err


def test_corrections_beside_a_result_are_never_lost(segment, tmp_path):
    out = tmp_path / "out"
    assert segment("--drop", "1", out=out).code == 0
    first = (out / "corrections.yaml").read_bytes()
    lost = segment("--drop", "2", out=out)
    assert (lost.code, lost.err.count("\n")) == (2, 1)
    assert f"corrections would be lost in {out}/corrections.yaml" in lost.err
    assert (out / "corrections.yaml").read_bytes() == first
    more = segment("--corrections", out / "corrections.yaml", "--rename", "2=x", out=out)
    assert more.code == 0
    second = (out / "corrections.yaml").read_text()
    assert second.startswith(first.decode()) and second.endswith("  - rename: {object: 2, name: x}\n")
    without = segment(out=out)
    assert without.code == 0
    assert (
        f"note: {out}/corrections.yaml is not in force: --corrections {out}/corrections.yaml applies it" in without.out
    )
    assert (out / "corrections.yaml").read_text() == second
    # Whoever gives the file without edits knows of it.
    (out / "corrections.yaml").write_text("version: 1\n")
    assert "note:" not in segment("--corrections", out / "corrections.yaml", out=out).out


def test_python_names_the_argument_that_keeps_corrections_beside_a_result(frames, store, tmp_path):
    _video(frames, store, [{"drop": 1}]).save(tmp_path / "out")
    with pytest.raises(
        InputError, match=r"corrections would be lost .* expected corrections .* another folder"
    ) as lost:
        _video(frames, store, [{"drop": 2}]).save(tmp_path / "out")
    assert "--" not in str(lost.value)


def test_trials_of_an_open_run_leave_no_pins(frames, store):
    def count_pins():
        return len(list((store / "pins").iterdir()))

    with open_run(frames, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        video.apply([])
        before = count_pins()
        for scale in (0.31, 0.32, 0.33):
            assert video.apply({"settings": {"affinity.scale": scale}}).num_computed == 3
        # The session's own lease, which ends with it.
        assert count_pins() <= before + 1
        video.judge()
    assert count_pins() == before + 1


def test_changes_of_how_strokes_are_carried_do_not_read_the_video_again(frames, store, tmp_path):
    shutil.copytree(frames, tmp_path / "clip")
    stroke = {"object": 2, "frame": 1, "strokes": [{"radius": 6, "points": [[20, 20]]}]}
    edits = [{"paint": stroke}]
    with open_run(tmp_path / "clip", RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        video.apply(edits)
        shutil.rmtree(tmp_path / "clip")
        for name, value in (("carrying.reach", 3), ("growing.max_still_area", 0.2), ("affinity.scale", 0.34)):
            video.apply({"settings": {name: value}, "edits": edits})


def test_an_overlay_has_the_users_names(frames, store):
    style = OverlayStyle(has_identities=True)
    plain, named = (_video(frames, store, edits) for edits in ([], [{"rename": {"object": 1, "name": "A"}}]))
    assert not np.array_equal(plain.overlay(0, style), named.overlay(0, style))
    np.testing.assert_array_equal(plain.overlay(0), named.overlay(0))


def test_areas_of_masks_are_those_of_the_labels(frames, store):
    settings = RunSettings(str(store), quiet=True)
    stroke = {"object": 2, "frame": 1, "strokes": [{"radius": 6, "points": [[20, 20]]}]}
    cases = (
        [],
        [{"split": {"object": 2, "frame": 3, "into": 5}}, {"drop": 1}],
        [{"paint": stroke}],
        [{"erase": stroke}],
    )
    with open_run(frames, settings, PipelineChoices(CONFIG)) as video:
        for edits in cases:
            video.apply(edits)
            for frame in range(video.num_frames):
                section, row = divmod(frame, CONFIG["sections.length"])
                masks = video.store.read(video.run.graph.objects.proposals(section), "masks")[row]
                areas = video.run.live.areas(frame, np.bincount(masks.ravel()))
                counted = np.bincount(video.labels(frame).ravel())
                assert np.trim_zeros(areas, "b").tolist() == counted.tolist(), (edits, frame)


def test_what_was_in_force_stays_after_corrections_that_cannot_be_applied(frames, store):
    with open_run(frames, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        video.apply([{"drop": 1}])
        for wrong in ([{"drop": 7}], {"settings": {"max_side": 64}}, {"video": "ab"}):
            with pytest.raises(InputError):
                video.apply(wrong)
        assert [edit.model_dump() for edit in video.corrections.edits] == [{"drop": 1}]
        assert sorted(np.unique(video.labels(0))) == [0, 2]


def test_an_open_run_reads_frames_again_that_were_lost(frames, store, tmp_path):
    """A run that is open for hours outlives a store that was tidied by hand."""
    copy = tmp_path / "store"
    shutil.copytree(store, copy)
    paint = [{"paint": {"object": 9, "frame": 5, "strokes": [{"radius": 4, "points": [[20, 20]]}]}}]
    with open_run(frames, RunSettings(str(copy), quiet=True), PipelineChoices(CONFIG)) as video:
        video.apply([])
        shutil.rmtree(copy / "objects" / "frame")
        video.apply(paint)
        np.testing.assert_array_equal(video.labels(5), _video(frames, store, paint).labels[5])
        shutil.rmtree(copy / "objects" / "frame")
        shutil.rmtree(copy / "objects" / "saliency")
        assert set(video.judge().motions) == {1, 2, 9}


def test_an_open_run_saves_what_the_command_line_writes(segment, frames, store, tmp_path):
    assert (
        segment(
            *OPTIONS,
            out=tmp_path / "command",
        ).code
        == 0
    )
    with open_run(frames, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG)) as video:
        video.apply(EDITS)
        summary, paths = video.save(tmp_path / "open")
    assert [each.name for each in summary.objects] == [None, "late"]
    assert {path.name for path in paths} == {"masks", "motion.json", "corrections.yaml"}
    for path in (tmp_path / "open").rglob("*.*"):
        assert path.read_bytes() == (tmp_path / "command" / path.relative_to(tmp_path / "open")).read_bytes()


def test_the_report_of_a_run_from_its_log_has_the_corrected_objects(frames, moseg, tmp_path):
    segment_video(
        frames, CONFIG, store=tmp_path / "store", progress=False, keep_cues=True, corrections=EDITS, name="corrected"
    )
    page = report_run(open_store(str(tmp_path / "store"), create=False), "latest")
    (panel,) = page.sequences
    assert [(row.identity, row.tag) for row in panel.objects] == [(2, None), (4, "late")]


def test_a_report_compares_objects_by_the_users_names(frames, tmp_path):
    segment_video(
        frames,
        CONFIG,
        store=tmp_path / "store",
        progress=False,
        keep_cues=True,
        corrections=[{"rename": {"object": 1, "name": "kite"}}],
    )
    page = report_run(open_store(str(tmp_path / "store"), create=False), "latest")
    (panel,) = page.sequences
    labels = {label for variant in panel.variants for matrix in variant.matrices for label in matrix.labels}
    assert labels == {"background", "1 kite", "2"}
