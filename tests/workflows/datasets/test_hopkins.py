"""Hopkins155, Hopkins12 and MTPV62: official lists, groups that papers report, and layouts on disk."""

import os
import pickle
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets import DATASETS, open_dataset
from moseg.workflows.reports.published_groups import PUBLISHED_GROUPS

REPOSITORY = Path(__file__).parents[3]
DATA = Path(os.environ.get("MOSEG_TEST_DATA", REPOSITORY.parent / "shared" / "data"))
NAMES = ("hopkins155", "hopkins12", "mtpv62")


def groups_of(name):
    return {group.name: set(group.sequences) for group in DATASETS[name].groups}


def write_variables(path, labels=(1, 2, 2), **variables):
    path.parent.mkdir(parents=True, exist_ok=True)
    savemat(path, {"y": np.ones((3, len(labels), 4)), "s": np.array(labels)[:, None], **variables})


def write_struct(path, labels=(1, 2, 2)):
    path.parent.mkdir(parents=True, exist_ok=True)
    savemat(path, {"Data": {"ySparse": np.ones((3, len(labels), 4)), "GtLabel": np.array(labels)[:, None]}})


def open_tracks(name, root, *sequences):
    return open_dataset(name, str(root), sequences or None, max_side=1280)


def test_the_groups_have_their_published_sizes():
    assert {name: len(members) for name, members in groups_of("hopkins155").items()} == {
        "two motions, checkerboard": 78,
        "two motions, traffic": 31,
        "two motions, articulated": 11,
        "two motions": 120,
        "three motions, checkerboard": 26,
        "three motions, traffic": 7,
        "three motions, articulated": 2,
        "three motions": 35,
        "checkerboard": 104,
        "traffic": 38,
        "articulated": 13,
        "two and three motions": 155,
    }
    assert {name: len(members) for name, members in groups_of("hopkins12").items()} == {
        "two motions": 9,
        "three motions": 3,
        "all": 12,
    }
    assert {name: len(members) for name, members in groups_of("mtpv62").items()} == {
        "complete data": 50,
        "missing data": 12,
        "all": 62,
    }


@pytest.mark.parametrize("name", NAMES)
def test_groups_are_of_the_official_list(name):
    official, groups = set(DATASETS[name].official), groups_of(name)
    assert set().union(*groups.values()) == official - {"dancing"}
    for kind in (("two motions", "three motions"), ("checkerboard", "traffic", "articulated")):
        members = [groups[part] for part in kind if part in groups]
        assert sum(map(len, members)) in (0, len(set().union(*groups.values())))


def test_a_sequence_of_three_motions_has_three_parts_of_two():
    groups = groups_of("hopkins155")
    for whole in groups["three motions"]:
        assert {f"{whole}_g12", f"{whole}_g13", f"{whole}_g23"} <= groups["two motions"]
    in_parts = {name for name in groups["two motions"] if name[-4:] in ("_g12", "_g13", "_g23")}
    assert len(in_parts) == 3 * len(groups["three motions"])


@pytest.mark.parametrize(
    ("sequence", "group"),
    [
        ("three-cars", "three motions, checkerboard"),
        ("1RT2TC_g13", "two motions, checkerboard"),
        ("cars10", "three motions, traffic"),
        ("cars10_g23", "two motions, traffic"),
        ("kanatani2", "two motions, traffic"),
        ("kanatani3", "two motions, articulated"),
        ("two_cranes", "three motions, articulated"),
        ("arm", "two motions, articulated"),
    ],
)
def test_a_sequence_is_in_its_published_group(sequence, group):
    number, category = group.split(", ")
    found = [name for name, members in groups_of("hopkins155").items() if sequence in members]
    assert found == [group, number, category, "two and three motions"]


def test_the_first_fifty_of_mtpv62_are_whole_sequences_of_hopkins155():
    groups = groups_of("hopkins155")
    whole = {name for name in groups["two and three motions"] if name[-4:] not in ("_g12", "_g13", "_g23")}
    assert groups_of("mtpv62")["complete data"] == {f"Hopkins50_{name}" for name in whole}


@pytest.mark.parametrize("name", NAMES)
def test_published_rows_are_those_of_the_groups(name):
    assert list(PUBLISHED_GROUPS[name].rows) == [group.name for group in DATASETS[name].groups]


@pytest.mark.parametrize(
    ("name", "whole", "parts"),
    [
        ("hopkins155", "two motions", "two motions, checkerboard; two motions, traffic; two motions, articulated"),
        (
            "hopkins155",
            "three motions",
            "three motions, checkerboard; three motions, traffic; three motions, articulated",
        ),
        ("hopkins155", "two and three motions", "two motions; three motions"),
        ("hopkins155", "two and three motions", "checkerboard; traffic; articulated"),
        ("hopkins12", "all", "two motions; three motions"),
        ("mtpv62", "all", "complete data; missing data"),
    ],
)
def test_published_means_add_up(name, whole, parts):
    published, sizes = PUBLISHED_GROUPS[name], {key: len(members) for key, members in groups_of(name).items()}
    for place, method in enumerate(published.methods):
        errors = {part: published.rows[part][place] for part in (whole, *parts.split("; "))}
        if None in errors.values():
            assert method == "SCC"
            continue
        mean = sum(sizes[part] * errors[part][0] for part in parts.split("; ")) / sizes[whole]
        assert mean == pytest.approx(errors[whole][0], abs=0.011)


def test_hopkins155_has_a_folder_for_each_sequence(tmp_path):
    for name in ("1R2RC", "cars10_g23", "dancing"):
        write_variables(tmp_path / name / f"{name}_truth.mat")
    write_variables(tmp_path / "arm_truth.mat")
    write_variables(tmp_path / "._arm_truth.mat")
    (tmp_path / "head").mkdir()
    (tmp_path / "notes.mat").write_bytes(b"")
    dataset = open_tracks("hopkins155", tmp_path)
    assert dataset.names == ("1R2RC", "arm", "cars10_g23", "dancing")
    assert len(dataset.absent) == 152 and "head" in dataset.absent
    groups = [group.name for group in dataset.trajectories("1R2RC").groups]
    assert groups == ["three motions, checkerboard", "three motions", "checkerboard", "two and three motions"]
    assert dataset.trajectories("dancing").groups == ()


@pytest.mark.parametrize("folder", ["", "oc1R2RC_Tracks", "oc1R2RC"])
def test_structs_lie_in_the_root_or_in_a_folder_of_their_name(tmp_path, folder):
    write_struct(tmp_path / folder / "oc1R2RC_Tracks.mat", labels=(1, 0, 2))
    dataset = open_tracks("hopkins12", tmp_path)
    assert dataset.names == ("oc1R2RC",)
    source = dataset.trajectories("oc1R2RC")
    assert source.labels.read().tolist() == [1, 0, 2]
    assert pickle.loads(pickle.dumps(source)) == source


def test_hopkins12_is_read_from_its_own_archive_too(tmp_path):
    visible = np.array([[1, 1, 0, 0], [1, 1, 1, 1], [0, 1, 1, 1]])
    write_variables(tmp_path / "oc1R2RC" / "oc1R2RC_truth.mat", m=visible)
    source = open_tracks("hopkins12", tmp_path).trajectories("oc1R2RC")
    points, seen = source.trajectories.read()
    np.testing.assert_array_equal(seen, visible)
    assert (points[~seen] == 0).all()


@pytest.mark.parametrize("name", NAMES)
def test_a_root_without_sequences_names_the_download(tmp_path, name):
    (tmp_path / "arm").mkdir()
    with pytest.raises(MissingInputError, match=r"\.mat.*Get it: http"):
        open_tracks(name, tmp_path)


def test_a_sequence_that_vanished_is_named(tmp_path):
    write_struct(tmp_path / "MTPV_data_Boat_Tracks.mat")
    dataset = open_tracks("mtpv62", tmp_path)
    (tmp_path / "MTPV_data_Boat_Tracks.mat").unlink()
    with pytest.raises(MissingInputError, match="MTPV_data_Boat has no trajectories"):
        dataset.trajectories("MTPV_data_Boat")


def test_a_misspelt_sequence_is_answered_with_a_close_name(tmp_path):
    write_variables(tmp_path / "arm" / "arm_truth.mat")
    with pytest.raises(InputError, match="two_cranes_g12"):
        open_tracks("hopkins155", tmp_path, "two_crane_g12")


@pytest.mark.parametrize("name", NAMES)
def test_real_sequences_have_the_motions_of_their_group(name):
    if not (DATA / name).is_dir():
        pytest.skip(f"no real sequences of {name}: set MOSEG_TEST_DATA to the folder of the data sets")
    dataset = open_tracks(name, DATA / name)
    assert set(dataset.names) <= set(dataset.layout.official)
    for sequence in dataset.names:
        source = dataset.trajectories(sequence)
        labels = source.labels.read()
        points, visible = source.trajectories.read()
        groups = [group.name for group in source.groups]
        if name != "mtpv62":
            number = 5 if sequence == "dancing" else 3 if "three motions" in groups else 2
            assert np.unique(labels).tolist() == list(range(1, number + 1))
        # Points may lie somewhat outside frames of at most 1280 px.
        assert points.shape[:2] == visible.shape and np.abs(points).max() < 1400
        # Hopkins155's other coordinates are normalised: they span 2.
        assert np.ptp(points[visible], axis=0).max() > 100
        assert visible.all() == ("missing data" not in groups)
        assert (labels == 0).any() == ("missing data" in groups)
