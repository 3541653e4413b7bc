"""Corrections in force: their file, undo and redo, and changes from elsewhere."""

import os

import pytest

from moseg.schemas.errors import InputError, StoreError
from moseg.workflows.config.corrections_file import read_corrections
from moseg.workflows.view.correction_history import CorrectionHistory

VIDEO = "ab" * 32


@pytest.fixture
def history(tmp_path):
    return CorrectionHistory(tmp_path, VIDEO)


def _edits(history):
    return [edit.model_dump(mode="json", exclude_defaults=True) for edit in history.current.edits]


def test_each_edit_is_in_the_file_at_once(history):
    history.put(history.with_edit({"drop": 2}))
    history.put(history.with_edit({"merge": [3, 4]}))
    read = read_corrections(str(history.path))
    assert read == history.current and read.video == VIDEO
    assert _edits(history) == [{"drop": 2}, {"merge": [3, 4]}]


def test_undo_and_redo_rewrite_the_file(history):
    history.put(history.with_edit({"drop": 2}))
    first = history.path.read_bytes()
    history.put(history.with_edit({"keep": 2}))
    history.step(-1)
    assert history.path.read_bytes() == first and history.can_redo
    history.step(1)
    assert len(_edits(history)) == 2 and not history.can_redo
    history.step(-1)
    history.step(-1)
    # As after a segmentation without corrections.
    assert not history.path.exists() and not history.can_undo
    with pytest.raises(InputError, match="nothing to undo"):
        history.before()


def test_an_edit_after_undo_ends_what_could_be_done_again(history):
    history.put(history.with_edit({"drop": 2}))
    history.step(-1)
    history.put(history.with_edit({"drop": 3}))
    assert not history.can_redo and _edits(history) == [{"drop": 3}]


def test_a_gesture_is_one_step(history):
    for value in (0.4, 0.3, 0.2):
        history.put(history.with_setting("clustering.threshold", value), gesture=1)
    history.put(history.with_setting("clustering.threshold", 0.9), gesture=2)
    assert history.current.settings == {"clustering.threshold": 0.9}
    history.step(-1)
    assert history.current.settings == {"clustering.threshold": 0.2}
    history.step(-1)
    assert not history.current.settings


def test_a_setting_without_a_value_is_the_runs_own(history):
    history.put(history.with_setting("clustering.motions", 3))
    history.put(history.with_setting("clustering.motions", None))
    assert not history.current and not history.path.exists()


def test_a_new_session_undoes_what_the_file_has_from_the_last_edit_on(history, tmp_path):
    history.put(history.with_setting("clustering.motions", 3))
    history.put(history.with_edit({"drop": 2}))
    history.put(history.with_edit({"static": 1}))
    again = CorrectionHistory(tmp_path, VIDEO)
    again.step(-1)
    assert _edits(again) == [{"drop": 2}]
    again.step(-1)
    assert again.current.settings == {"clustering.motions": 3} and not again.current.edits
    again.step(-1)
    assert not again.can_undo


def test_a_change_of_the_file_by_another_program_is_seen(history):
    history.put(history.with_edit({"drop": 2}))
    assert not history.is_stale()
    history.path.write_text(history.path.read_text() + "  - drop: 3\n")
    assert history.is_stale()
    history.reload()
    assert _edits(history) == [{"drop": 2}, {"drop": 3}] and not history.is_stale()


def test_corrections_of_another_video_are_refused(history, tmp_path):
    history.put(history.with_edit({"drop": 2}))
    with pytest.raises(InputError, match="corrections of another video"):
        CorrectionHistory(tmp_path, "cd" * 32)


def test_what_cannot_be_written_changes_nothing(history, monkeypatch):
    history.put(history.with_edit({"drop": 2}))
    before = history.path.read_bytes()

    def refuse(*arguments):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(StoreError, match=r"cannot write in .*No space left on device"):
        history.put(history.with_edit({"drop": 3}))
    with pytest.raises(InputError, match="nothing to redo"):
        history.after()
    assert _edits(history) == [{"drop": 2}] and history.path.read_bytes() == before
    assert [path.name for path in history.path.parent.iterdir()] == [history.path.name]


@pytest.mark.parametrize("edit", [None, 3, "drop", {}, {"drop": -1}, {"fly": 2}, {"drop": 2, "keep": 3}])
def test_what_is_no_edit_is_refused(history, edit):
    with pytest.raises(InputError):
        history.with_edit(edit)
