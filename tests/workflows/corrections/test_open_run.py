"""A run that stays open, as the view page has it: the labels of the command line after every change."""

import shutil

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.config.corrections_file import read_corrections, spell_corrections


def test_an_open_run_has_the_labels_of_the_command_line_after_every_change(
    segment, frames, tmp_path, read_masks, several_edits, opened
):
    changes = [
        [],
        [{"drop": 1}],
        [{"drop": 1}, {"keep": 1}],
        [{"merge": [2, 1]}],
        several_edits,
        {"settings": {"clustering.motions": 2}},
        {"settings": {"clustering.motions": 2}, "edits": [{"moving": 1}, {"moving": 2}]},
        {"settings": {"affinity.scale": 0.9}, "edits": [{"static": 2}]},
        {"settings": {"components.min_area": 0.02}},
        {"settings": {"moving_objects.min_area": 0.054}},
        {"settings": {"moving_objects.min_area": 0.5}, "edits": [{"keep": 2}]},
        [],
    ]
    with opened() as video:
        before = None
        for index, change in enumerate(changes):
            done = video.apply(change)
            labels = np.stack([video.labels(frame) for frame in range(video.num_frames)])
            (tmp_path / "fixes.yaml").write_text(spell_corrections(read_corrections(change)))
            assert segment("--corrections", tmp_path / "fixes.yaml", out=tmp_path / f"out{index}").code == 0
            np.testing.assert_array_equal(labels, read_masks(tmp_path / f"out{index}"))
            if before is not None:
                differ = [frame for frame in range(len(labels)) if (labels[frame] != before[frame]).any()]
                assert set(differ) <= set(done.frames)
            before = labels


def test_trials_of_an_open_run_leave_no_pins(store, opened):
    def count_pins():
        return len(list((store / "pins").iterdir()))

    with opened() as video:
        video.apply([])
        before = count_pins()
        for scale in (0.31, 0.32, 0.33):
            assert video.apply({"settings": {"affinity.scale": scale}}).num_computed == 3
        # The session's own lease, which ends with it.
        assert count_pins() <= before + 1
        video.judge()
    assert count_pins() == before + 1


def test_changes_of_how_strokes_are_carried_do_not_read_the_video_again(frames, tmp_path, opened):
    shutil.copytree(frames, tmp_path / "clip")
    stroke = {"object": 2, "frame": 1, "strokes": [{"radius": 6, "points": [[20, 20]]}]}
    edits = [{"paint": stroke}]
    with opened(tmp_path / "clip") as video:
        video.apply(edits)
        shutil.rmtree(tmp_path / "clip")
        for name, value in (("carrying.reach", 3), ("growing.max_still_area", 0.2), ("affinity.scale", 0.34)):
            video.apply({"settings": {name: value}, "edits": edits})


def test_areas_of_masks_are_those_of_the_labels(store, config, opened):
    stroke = {"object": 2, "frame": 1, "strokes": [{"radius": 6, "points": [[20, 20]]}]}
    cases = (
        [],
        [{"split": {"object": 2, "frame": 3, "into": 5}}, {"drop": 1}],
        [{"paint": stroke}],
        [{"erase": stroke}],
    )
    with opened() as video:
        for edits in cases:
            video.apply(edits)
            for frame in range(video.num_frames):
                section, row = divmod(frame, config["sections.length"])
                masks = video.store.read(video.run.graph.objects.proposals(section), "masks")[row]
                areas = video.run.live.areas(frame, np.bincount(masks.ravel()))
                counted = np.bincount(video.labels(frame).ravel())
                assert np.trim_zeros(areas, "b").tolist() == counted.tolist(), (edits, frame)


def test_what_was_in_force_stays_after_corrections_that_cannot_be_applied(opened):
    with opened() as video:
        video.apply([{"drop": 1}])
        for wrong in ([{"drop": 7}], {"settings": {"max_side": 64}}, {"video": "ab"}):
            with pytest.raises(InputError):
                video.apply(wrong)
        assert [edit.model_dump() for edit in video.corrections.edits] == [{"drop": 1}]
        assert sorted(np.unique(video.labels(0))) == [0, 2]


def test_an_open_run_reads_frames_again_that_were_lost(store, tmp_path, correct, opened):
    """A run that is open for hours outlives a store that was tidied by hand."""
    copy = tmp_path / "store"
    shutil.copytree(store, copy)
    paint = [{"paint": {"object": 9, "frame": 5, "strokes": [{"radius": 4, "points": [[20, 20]]}]}}]
    with opened(store=copy) as video:
        video.apply([])
        shutil.rmtree(copy / "objects" / "frame")
        video.apply(paint)
        np.testing.assert_array_equal(video.labels(5), correct(paint).labels[5])
        shutil.rmtree(copy / "objects" / "frame")
        shutil.rmtree(copy / "objects" / "saliency")
        assert set(video.judge().motions) == {1, 2, 9}


def test_an_open_run_saves_what_the_command_line_writes(segment, tmp_path, several_edits, several_options, opened):
    assert segment(*several_options, out=tmp_path / "command").code == 0
    with opened() as video:
        video.apply(several_edits)
        summary, paths = video.save(tmp_path / "open")
    assert [each.name for each in summary.objects] == [None, "late"]
    assert {path.name for path in paths} == {"masks", "motion.json", "corrections.yaml"}
    for path in (tmp_path / "open").rglob("*.*"):
        assert path.read_bytes() == (tmp_path / "command" / path.relative_to(tmp_path / "open")).read_bytes()
