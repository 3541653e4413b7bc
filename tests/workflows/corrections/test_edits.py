"""Corrections of a segmentation: the same from the command line, a file and Python, and what each edit does."""

import json

import numpy as np
import pytest

from moseg.schemas.errors import InputError


def test_every_way_of_giving_the_same_corrections_has_the_same_bytes(
    segment, tmp_path, correct, read_masks, several_edits, several_options
):
    (tmp_path / "fixes.yaml").write_text(
        "version: 1\nedits:\n- split: {object: 2, frame: 5, into: 4}\n- rename: {object: 4, name: late}\n- drop: 1\n"
    )
    (tmp_path / "first.yaml").write_text("version: 1\nedits:\n- split: {object: 2, frame: 5, into: 4}\n")
    assert segment(*several_options, out=tmp_path / "options").code == 0
    assert segment("--corrections", tmp_path / "fixes.yaml", out=tmp_path / "file").code == 0
    assert segment("--corrections", tmp_path / "first.yaml", *several_options[2:], out=tmp_path / "both").code == 0
    for name, given in (
        ("mapping", {"edits": several_edits}),
        ("list", several_edits),
        ("path", tmp_path / "fixes.yaml"),
    ):
        correct(given).save(tmp_path / name)
    wanted = {path.name: path.read_bytes() for path in (tmp_path / "options" / "masks").iterdir()}
    for name in ("file", "both", "mapping", "list", "path"):
        assert {path.name: path.read_bytes() for path in (tmp_path / name / "masks").iterdir()} == wanted
        for file in ("motion.json", "corrections.yaml"):
            assert (tmp_path / name / file).read_bytes() == (tmp_path / "options" / file).read_bytes()
    assert sorted(np.unique(read_masks(tmp_path / "options"))) == [0, 2, 4]


def test_each_edit_does_what_it_says(correct):
    plain = correct().labels
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
        np.testing.assert_array_equal(correct(corrections).labels, wanted, err_msg=str(corrections))


def test_motions_count_what_was_dropped_and_names_are_in_the_summary(tmp_path, correct):
    result = correct([{"drop": 2}, {"rename": {"object": 1, "name": "<b>left</b>"}}])
    assert (result.num_motions, [each.identity for each in result.objects]) == (3, [1])
    assert result.objects[0].name == "<b>left</b>"
    assert "&lt;b&gt;left&lt;/b&gt;" in result._repr_html_() and "<b>left" not in result._repr_html_()
    result.save(tmp_path / "out")
    (found,) = json.loads((tmp_path / "out" / "motion.json").read_text())["objects"]
    assert (found["identity"], found["name"], found["tag"]) == (1, "<b>left</b>", None)
    static = correct([{"static": 2}])
    assert (static.num_motions, [each.motion for each in static.objects]) == (2, [1])


def test_an_object_that_a_correction_made_has_figures_of_its_masks_and_no_support(correct, several_edits):
    found = {each.identity: each for each in correct(several_edits[:1]).objects}
    assert set(found) == {1, 2, 4}
    assert found[4].first_frame == 5 and found[4].sure > 0.9 and found[4].moving_frames
    assert found[4].static_support == {} and found[4].score is None
    assert found[2].score > 0.9


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


def test_python_names_the_argument_that_keeps_corrections_beside_a_result(tmp_path, correct):
    correct([{"drop": 1}]).save(tmp_path / "out")
    with pytest.raises(
        InputError, match=r"corrections would be lost .* expected corrections .* another folder"
    ) as lost:
        correct([{"drop": 2}]).save(tmp_path / "out")
    assert "--" not in str(lost.value)
