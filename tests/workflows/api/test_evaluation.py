"""`moseg.evaluate`, `moseg.ablate` and `moseg.score` give what the commands write as JSON, from the same store."""

import json

import cv2
import pytest

import moseg

CONFIG = {"sections.length": 4, "sections.overlap": 2}


def _written(report):
    said = json.loads(report.model_dump_json(exclude_none=True))
    return {name: said[name] for name in said if name not in ("store", "seconds")}


def _expected(report):
    return {name: report[name] for name in report if name not in ("store", "seconds")}


@pytest.fixture
def command(request):
    """Runs a `moseg` command; the package has the fixture's own name here."""
    return request.getfixturevalue("moseg")


@pytest.fixture
def saved_masks(squares, tmp_path):
    """Folder of masks that are the ground truth itself."""
    folder = tmp_path / "predictions" / "squares"
    folder.mkdir(parents=True)
    for path in sorted((squares / "squares" / "masks").iterdir()):
        cv2.imwrite(str(folder / path.name), cv2.imread(str(path), 0))
    return folder.parent


def test_scores_are_those_of_the_command_line_and_are_not_computed_again(evaluated):
    report = moseg.evaluate("folder", CONFIG, root=evaluated.root, store=evaluated.store, progress=False)
    assert isinstance(report, moseg.EvaluationReport)
    assert _written(report) == _expected(evaluated.report)
    assert report.store.computed == 0 < report.store.reused
    assert report.notes == (
        "proposals auto, flow dis, tracks lucas-kanade",
        "no depth given: fused ran without it (oc-depth with constant inverse depth)",
    )


def test_a_report_says_what_differs_from_the_defaults(evaluated_copy):
    own = CONFIG | {"affinity.scale": 0.7}
    options = {"root": evaluated_copy.root, "store": evaluated_copy.store, "progress": False}
    report = moseg.evaluate("folder", own, motions=2, **options)
    assert report.settings.config == own | {"clustering.motions": 2}
    assert report.settings.version == moseg.__version__


def test_a_folder_stands_for_the_data_set_of_folders(evaluated):
    options = {"store": evaluated.store, "progress": False, "sequences": "squares", "variants": ["fused"]}
    report = moseg.evaluate(evaluated.root, CONFIG, **options)
    assert _written(report) == _expected(evaluated.report)


def test_ablations_have_a_row_for_each_variant_and_write_a_page(evaluated_copy, tmp_path, capfd):
    options = {"store": evaluated_copy.store, "report": tmp_path / "page.html", "progress": False}
    report = moseg.ablate(evaluated_copy.root, CONFIG, **options)
    assert [row.variant for row in report.rows] == ["fused", "oc-depth", "oc", "trajs", "base"]
    assert evaluated_copy.report["rows"][0]["mean"]["F"] == report.rows[0].mean.F
    assert "oc-depth" in (tmp_path / "page.html").read_text(encoding="utf-8")
    assert capfd.readouterr() == ("", "")


def test_the_ground_truth_gives_the_number_of_motions(evaluated_copy):
    options = {"config": CONFIG | {"affinity.method": "ork"}, "store": evaluated_copy.store, "progress": False}
    report = moseg.evaluate(evaluated_copy.root, variants="oc", **options)
    assert "give it by motions" in report.notes[-1] and "--" not in report.notes[-1]
    report = moseg.evaluate(evaluated_copy.root, variants="oc", motions="gt", **options)
    assert not any("motions" in note for note in report.notes)


def test_given_cues_are_read_from_their_folders(squares, tmp_path):
    masks = squares / "squares" / "masks"
    options = {"variants": "base", "store": tmp_path / "store", "progress": False}
    report = moseg.evaluate(squares, proposals=masks, **options)
    assert report.rows[0].mean.F == 100


def test_saved_masks_are_scored_as_by_the_command(squares, saved_masks, tmp_path, command):
    path = tmp_path / "scores.json"
    options = ("--dataset", "folder", "--root", squares, "--json", path, "--quiet")
    assert command("score", "--predictions", saved_masks, *options).code == 0
    report = moseg.score(saved_masks, squares, name="predictions", progress=False)
    assert _written(report) == _expected(json.loads(path.read_text()))
    assert report.rows[0].mean.F == 100 and report.matching == {"squares": "name"} and report.notes == ()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"dataset": "davis17"}, "unknown data set 'davis17': did you mean 'davis16'"),
        ({"dataset": 3}, "in dataset; got 3"),
        ({"dataset": "davis16"}, "davis16"),
        ({"variants": "homography"}, "in variants; got 'homography'; expected fused or oc-depth"),
        ({"variants": "oc_depth"}, "in variants: did you mean 'oc-depth'"),
        ({"variants": 3}, "in variants; got 3"),
        ({"variants": []}, "in variants"),
        ({"sequences": []}, "in sequences"),
        ({"sequences": "occlusions"}, "did you mean 'occlusion'"),
        ({"list_file": "nowhere.txt"}, "nowhere.txt"),
        ({"views": "affine"}, "an option of labelled trajectories in views; got data set synthetic"),
        ({"seed": -1}, "in seed; got -1; expected 0 or more"),
        ({"seeds": 0}, "in seeds; got 0; expected 1 or more"),
        ({"motions": "some"}, "clustering.motions"),
        (
            {"sensitivity": 2, "config": {"proposal_source": "saliency"}},
            "in sensitivity; got proposals saliency; expected proposal_source=motion-prompts or proposal_source=auto or"
            " proposal_source=tracks",
        ),
        ({"config": {"flow.method": "folder"}}, "in flow; got folder by config; expected flow=PATH"),
        ({"depth": "nowhere"}, "in depth=nowhere"),
        ({"scheduler": "tcp://"}, "in scheduler tcp://"),
        ({"scheduler": "tcp://127.0.0.1:1", "tls_ca": "gone.pem"}, "tls_ca"),
        ({"batch": 0}, "in batch"),
        ({"report": 3}, "in report; got 3"),
    ],
)
@pytest.mark.parametrize("call", ["evaluate", "ablate"])
def test_bad_input_is_one_line_in_terms_of_the_arguments(in_empty_folder, call, arguments, says):
    if call == "ablate" and "variants" in arguments:
        pytest.skip("ablate has no variants to choose")
    with pytest.raises(moseg.InputError, match=says) as raised:
        getattr(moseg, call)(**{"sequences": "occlusion"} | arguments, progress=False)
    assert "\n" not in str(raised.value) and "--" not in str(raised.value)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"predictions": 3}, "in predictions; got 3"),
        ({"predictions": "nowhere"}, "nowhere"),
        ({"format": "voc"}, "voc"),
        ({"name": 3}, "in name; got 3"),
        ({"dataset": "davis17"}, "unknown data set"),
    ],
)
def test_bad_masks_are_one_line_in_terms_of_the_arguments(in_empty_folder, saved_masks, arguments, says):
    with pytest.raises(moseg.InputError, match=says) as raised:
        moseg.score(**{"predictions": saved_masks} | arguments, progress=False)
    assert "\n" not in str(raised.value) and "--" not in str(raised.value)
