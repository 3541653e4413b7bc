"""`moseg eval`, `ablate`, `plan` and `datasets` on Hopkins155 and MTPV62: groups of sequences, and missing labels."""

import json

import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy.io import loadmat, savemat

from moseg.schemas.recipes import leaf_recipe
from moseg.schemas.sequence_groups import SequenceGroup
from moseg.store import open_store
from moseg.tasks.metrics import clustering_error
from moseg.workflows.datasets import DATASETS
from moseg.workflows.datasets.labelled_tracks import LabelledTracks
from moseg.workflows.graph import TrajectoryLeaves
from moseg.workflows.reports.published_groups import PUBLISHED_GROUPS

pytestmark = pytest.mark.usefixtures("in_empty_folder")

FAST = ("--set", "hypotheses.num_hypotheses=100", "--motions", "gt", "--quiet")
SEQUENCES = ("1R2RC_g12", "cars4", "dancing")
BOAT, ARM = "MTPV_data_Boat", "Hopkins50_arm"


@pytest.fixture(scope="module")
def hopkins(write_clip, tmp_path_factory):
    """Root of three made-up sequences in the layout of Hopkins155: everything is visible."""
    root = tmp_path_factory.mktemp("hopkins155")
    for seed, name in enumerate(SEQUENCES):
        data = loadmat(write_clip(root / "made" / f"{seed}.mat", seed, hidden=0))["Data"][0, 0]
        (root / name).mkdir()
        savemat(root / name / f"{name}_truth.mat", {"y": data["ySparse"], "s": data["GtLabel"]})
    return root


@pytest.fixture(scope="module")
def mtpv(write_clip, tmp_path_factory):
    """Root of two made-up sequences in the layout of MTPV62: every fourth trajectory of one has no label."""
    root = tmp_path_factory.mktemp("mtpv62")
    for seed, (name, hidden) in enumerate(((BOAT, 0.3), (ARM, 0))):
        path = root / f"{name}_Tracks" / f"{name}_Tracks.mat"
        data = loadmat(write_clip(path, seed, hidden=hidden))["Data"][0, 0]
        fields = {field: data[field] for field in data.dtype.names}
        if hidden:
            fields["GtLabel"][::4] = 0
        else:
            del fields["visibleSparse"]
        savemat(path, {"Data": fields})
    return root


def _run(moseg, command, dataset, root, *options):
    ran = moseg(command, "--dataset", dataset, "--root", root, *FAST, "--json", "report.json", *options)
    assert (ran.code, ran.err) == (0, "")
    with open("report.json", encoding="utf-8") as file:
        return json.load(file), ran.out


def test_errors_are_reported_by_group_with_published_ones(moseg, hopkins):
    report, out = _run(moseg, "eval", "hopkins155", hopkins)
    (row,) = report["rows"]
    errors = {name: score["error"] for name, score in row["sequences"].items()}
    assert set(errors) == set(SEQUENCES)
    members = {
        "two motions, checkerboard": (["1R2RC_g12"], 78),
        "two motions, traffic": (["cars4"], 31),
        "two motions": (["1R2RC_g12", "cars4"], 120),
        "checkerboard": (["1R2RC_g12"], 104),
        "traffic": (["cars4"], 38),
        "two and three motions": (["1R2RC_g12", "cars4"], 155),
    }
    assert list(row["groups"]) == list(members)
    for name, (sequences, num_published) in members.items():
        group = row["groups"][name]
        assert group["error"] == pytest.approx(np.mean([errors[each] for each in sequences]))
        assert (group["num_sequences"], group["num_published"]) == (len(sequences), num_published)
    assert row["mean"]["error"] == pytest.approx(np.mean(list(errors.values())))
    assert "3 of the 156 clips ran; not on disk: 1R2RC, 1R2RC_g13" in out
    assert "2 of 155" in out and "not measured here" in out and "RSIM*" in out
    assert "0.78 / 0.00" in out and "Xu, Cheong, Li" not in out


def test_the_page_has_published_rows_below_the_measured_ones(moseg, hopkins, pages):
    options = ("--sequences", "cars4", "--report", "run.html")
    report, out = _run(moseg, "ablate", "hopkins155", hopkins, *options)
    assert moseg("report").code == 0
    at_once, logged = pages
    assert at_once.scores == logged.scores
    by_group = [table for table in logged.scores if "by group" in table.title]
    published = [table for table in logged.scores if table.is_published]
    assert [table.columns for table in by_group] == [table.columns for table in published]
    # Variants with the same errors share a row.
    shown = {variant: figures for names, figures in by_group[0].rows for variant in names.split(", ")}
    assert shown.keys() == {row["variant"] for row in report["rows"]}
    for row in report["rows"]:
        assert shown[row["variant"]] == tuple(group["error"] for group in row["groups"].values())
    methods = PUBLISHED_GROUPS["hopkins155"].methods
    assert [name for name, _ in published[0].rows] == list(methods)
    assert dict(published[0].rows)["RSIM*"][1] == 0.78 and dict(published[1].rows)["RSIM*"][1] == 0.0
    assert "fused" in out and "1 of 31" in out


def test_a_trajectory_without_a_label_is_neither_scored_nor_a_motion(moseg, mtpv):
    report, _ = _run(moseg, "eval", "mtpv62", mtpv, "--store", "store", "--set", "hypotheses.gaps=1")
    (row,) = report["rows"]
    score = row["sequences"][BOAT]
    assert (score["num_motions"], score["num_motions_true"]) == (2, 2)
    assert list(row["groups"]) == ["complete data", "missing data", "all"]
    store = open_store("store")
    stored = (store.read(ref, "labels") for ref in store.refs("trajectory_labels"))
    (labels,) = [labels for labels in stored if (labels == 0).any()]
    assert np.count_nonzero(labels == 0) == 17
    found = [store.read(ref, "motion") for ref in store.refs("trajectory_clustering")]
    errors = [clustering_error(motion[labels > 0], labels[labels > 0]) for motion in found]
    assert len(found) == 2 and score["error"] in [pytest.approx(error) for error in errors]
    # As if 0 were a motion, a quarter of the trajectories would be wrong.
    assert score["error"] < 15 < clustering_error(found[0], labels)


def test_hidden_points_stay_hidden_and_others_are_visible(moseg, mtpv):
    _run(moseg, "eval", "mtpv62", mtpv, "--store", "store")
    store = open_store("store")
    shares = sorted(store.read(ref, "visible").mean() for ref in store.refs("trajectories"))
    assert 0.5 < shares[0] < 0.8 and shares[1] == 1


def test_the_log_of_a_run_without_groups_is_read():
    refs = [leaf_recipe(kind, "1" * 64).ref for kind in ("trajectories", "trajectory_labels")]
    fields = {"name": "arm", "trajectories": refs[0], "labels": refs[1], "num_motions": 2}
    assert TypeAdapter(TrajectoryLeaves).validate_python(fields).groups == ()
    fields["groups"] = [["traffic", 5, 38]]
    assert TypeAdapter(TrajectoryLeaves).validate_python(fields).groups == (SequenceGroup("traffic", 5, 38),)


def test_a_plan_of_a_finished_run_computes_nothing(moseg, hopkins):
    _run(moseg, "eval", "hopkins155", hopkins, "--sequences", "cars4")
    options = FAST[:-1]
    ran = moseg("plan", "--dataset", "hopkins155", "--root", hopkins, "--sequences", "cars4", *options)
    assert ran.code == 0 and "0 artifacts to compute" in ran.out


@pytest.mark.parametrize("name", ["hopkins155", "hopkins12", "mtpv62"])
def test_a_data_set_that_is_absent_is_one_clear_line(moseg, name):
    ran = moseg("eval", "--dataset", name, "--root", "nowhere")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert name in line and ".mat" in line and "Get it: http" in line


def test_a_file_without_labels_is_named(moseg, tmp_path):
    (tmp_path / "arm").mkdir()
    savemat(tmp_path / "arm" / "arm_truth.mat", {"y": np.ones((3, 8, 5))})
    ran = moseg("eval", "--dataset", "hopkins155", "--root", tmp_path, "--quiet")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "arm_truth.mat; got no s; expected" in line


def test_the_sequences_on_disk_are_shown(moseg, hopkins):
    ran = moseg("datasets", "show", "hopkins155", "--root", hopkins)
    assert ran.code == 0
    assert "hopkins155: 3 sequences" in ran.out and "1R2RC_g12, cars4, dancing" in ran.out


@pytest.mark.parametrize(
    ("official", "says"),
    [
        (None, "2 clips ran\n"),
        (("a", "gone"), "1 of the 2 clips ran, and 1 that are not of the data set\n"),
    ],
)
def test_clips_of_no_official_list_run_and_are_counted_apart(moseg, write_clip, tmp_path, monkeypatch, official, says):
    layout = LabelledTracks("own", official, ("_own.mat",), tree="<clip>_own.mat", source="https://example.org")
    monkeypatch.setitem(DATASETS, "own", layout)
    for seed, name in enumerate("ab"):
        write_clip(tmp_path / "own" / f"{name}_own.mat", seed)
    words = ("--dataset", "own", "--root", tmp_path / "own", "--store", tmp_path / "store", "--sequences", "a,b")
    ran = moseg("eval", *words, "--variant", "affine")
    assert ran.code == 0, ran.err
    assert says in ran.out
