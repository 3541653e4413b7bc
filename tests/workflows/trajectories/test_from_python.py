"""`moseg.evaluate` and `moseg.ablate` on labelled trajectories."""

import json

import pytest

import moseg


def test_errors_are_those_of_the_command_line(clips, tmp_path, request):
    path, store = tmp_path / "report.json", tmp_path / "store"
    options = ("--root", clips, "--seeds", 2, "--motions", "gt", "--json", path, "--store", store, "--quiet")
    assert request.getfixturevalue("moseg")("eval", "--dataset", "kt3dmoseg", *options).code == 0
    report = moseg.evaluate("kt3dmoseg", root=clips, seeds=2, motions="gt", store=store, progress=False)
    assert isinstance(report, moseg.TrajectoryReport)
    written = json.loads(report.model_dump_json(exclude_none=True))
    assert written["rows"] == json.loads(path.read_text())["rows"]
    assert report.store.computed == 0
    assert report.notes[-3:] == (
        "number of motions: given (gt)",
        "views of fused: affine, homography, fundamental",
        "mean over seeds 0, 1",
    )
    rows = moseg.ablate("kt3dmoseg", root=clips, seed=1, store=store, progress=False).rows
    assert [row.variant for row in rows] == ["fused", "trajs", "homography", "affine"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"preset": "paper"}, "an option for images in preset; got data set kt3dmoseg"),
        ({"flow": "there"}, "an option for images in flow"),
        ({"config": {"max_side": 300}}, "a parameter for images in max_side"),
        ({"config": moseg.PipelineConfig(max_side=300)}, "a parameter for images in max_side"),
        ({"seed": 1, "seeds": 2}, "two choices in seed; got seeds 2 too"),
        ({"views": ["affine", "affine"]}, "not point models in views; got affine,affine"),
        ({"views": []}, "not point models in views; got ; expected different ones"),
        ({"views": ["homografy"]}, "separated by commas; did you mean 'homography'?"),
        ({"variants": "oc"}, "in variants; got 'oc'"),
    ],
)
def test_what_needs_images_is_one_line_in_terms_of_the_arguments(clips, in_empty_folder, arguments, says):
    with pytest.raises(moseg.InputError, match=says) as raised:
        moseg.evaluate("kt3dmoseg", root=clips, progress=False, **arguments)
    assert "\n" not in str(raised.value) and "--" not in str(raised.value)
