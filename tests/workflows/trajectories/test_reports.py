"""Reports on labelled trajectories."""

import json

import numpy as np
import pytest

from moseg.store import open_store
from moseg.tasks.clustering.spectral import normalise_affinity

pytestmark = pytest.mark.usefixtures("in_empty_folder")

FAST = ("--set", "hypotheses.num_hypotheses=50", "--quiet")


@pytest.fixture
def evaluate(moseg, clips):
    """Evaluates the clips and reports on that, at once and from the log; returns the JSON."""

    def call(command, *options):
        outputs = ("--json", "report.json", "--report", "run.html")
        ran = moseg(command, "--dataset", "kt3dmoseg", "--root", clips, *FAST, *outputs, *options)
        assert (ran.code, ran.err) == (0, "") and ran.out.splitlines()[-1].startswith("report: run.html (")
        assert moseg("report").code == 0
        with open("report.json", encoding="utf-8") as file:
            return json.load(file)

    return call


def test_an_ablation_shows_errors_and_kernels_of_every_model(evaluate, pages):
    # Eigenvalues are those of the trajectories that are clustered: here all of them.
    every = ("--set", "trajectory_clustering.outliers.min_affinity=0")
    report = evaluate("ablate", "--motions", "gt", "--sequences", "Seq005_Clip01", *every)
    at_once, logged = pages
    assert at_once.title == logged.title == "kt3dmoseg: fused, trajs, homography, affine"
    assert at_once.scores == logged.scores and at_once.notes == logged.notes
    means, *tables, published = logged.scores
    assert published.is_published
    # Variants with the same errors share a row and a table.
    shown = {
        variant: (figures, table)
        for (names, figures), table in zip(means.rows, tables, strict=True)
        for variant in names.split(", ")
    }
    assert shown.keys() == {row["variant"] for row in report["rows"]}
    for row in report["rows"]:
        figures, table = shown[row["variant"]]
        assert figures == tuple(row["mean"][name] for name in row["mean"])
        errors = {name: score["error"] for name, score in row["sequences"].items()}
        assert {name: values[0] for name, values in table.rows if name in errors} == errors
    for made in pages:
        assert [clip.name for clip in made.sequences] == ["Seq005_Clip01"]
        for clip in made.sequences:
            assert clip.num_frames == 6 and clip.layers and clip.missing == ()
            fused, *single = clip.variants
            assert [matrix.title for matrix in fused.matrices] == [
                "kernel, affine",
                "kernel, homography",
                "kernel, fundamental",
                "fused kernel",
            ]
            assert [len(panel.matrices) for panel in single] == [1, 1, 1]
            assert all("ground truth" in panel.eigenvalues.how for panel in clip.variants)
            spectrum = np.sort(np.linalg.eigvalsh(normalise_affinity(fused.matrices[-1].values)))[::-1]
            assert spectrum == pytest.approx(fused.eigenvalues.eigenvalues, abs=1e-5)


def test_figures_over_seeds_come_with_pictures_of_the_first(evaluate, pages):
    evaluate("eval", "--seeds", "2", "--sequences", "Seq028_clip03")
    at_once, logged = pages
    assert at_once.scores == logged.scores and at_once.scores[0].columns[-1] == "spread of error"
    assert at_once.notes == logged.notes and any("seed 0" in note for note in logged.notes)
    for one, other in zip(*(made.sequences[0].variants[0].matrices for made in pages), strict=True):
        assert np.array_equal(one.values, other.values)


def test_what_was_collected_is_left_out_and_named(evaluate, moseg, pages):
    evaluate("eval")
    store = open_store(".moseg/store")
    for ref in [*list(store.refs("kernel"))[:1], *list(store.refs("score"))[:1]]:
        store.remove(ref)
    assert moseg("report").code == 0
    left = pages[-1]
    assert any(note.startswith("1 of 2 scores are not in the store") for note in left.notes)
    assert len(left.scores[0].rows) == len(pages[0].scores[0].rows) - 1
    missing = [text for clip in left.sequences for text in clip.variants[0].missing]
    assert len(missing) == 1 and "): kernel, " in missing[0]
