import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets import DATASETS, describe_datasets, open_dataset

ON_DISK = [name for name, layout in DATASETS.items() if layout.needs_root]


@pytest.fixture
def data(tmp_path, write_sequence, monkeypatch):
    """Return a folder of data sets with one sequence of davis16 and an empty davis-moving."""
    for tree in ("JPEGImages", "Annotations"):
        write_sequence(tmp_path / "davis16" / tree / "480p" / "dog", None, {}, num_frames=1)
    (tmp_path / "davis-moving").mkdir()
    monkeypatch.setenv("MOSEG_DATA", str(tmp_path))
    return tmp_path


def test_the_environment_gives_the_root(data):
    assert open_dataset("davis16", max_side=100).root == str(data / "davis16")


def test_a_given_root_is_used_rather_than_the_environment_s(data, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    with pytest.raises(MissingInputError, match=f"{other}"):
        open_dataset("davis16", str(other), max_side=100)


def test_a_relative_root_does_not_depend_on_the_working_folder(data, monkeypatch):
    monkeypatch.chdir(data)
    assert open_dataset("davis16", "davis16", max_side=100).root == str(data / "davis16")


@pytest.mark.parametrize("name", ON_DISK)
def test_a_missing_data_set_names_its_download(tmp_path, monkeypatch, name):
    monkeypatch.delenv("MOSEG_DATA", raising=False)
    for root in (None, str(tmp_path / "gone")):
        with pytest.raises(MissingInputError) as caught:
            open_dataset(name, root, max_side=100)
        message = str(caught.value)
        assert DATASETS[name].source in message
        assert DATASETS[name].tree in message
        assert "\n" not in message


@pytest.mark.parametrize("name", ON_DISK)
def test_a_folder_of_another_layout_says_which_is_expected(tmp_path, name):
    with pytest.raises(MissingInputError, match="expected"):
        open_dataset(name, str(tmp_path), max_side=100)


def test_scenes_take_no_root(tmp_path):
    with pytest.raises(InputError, match="no files"):
        open_dataset("synthetic", str(tmp_path), max_side=100)


def test_the_overview_lists_present_and_missing_data_sets(data):
    rows = {row.name: row for row in describe_datasets({"MOSEG_DATA": str(data)})}
    assert list(rows) == list(DATASETS)
    assert rows["synthetic"].is_present
    assert rows["davis16"].is_present
    assert rows["davis16"].names == ("dog",)
    assert len(rows["davis16"].absent) == 19
    assert not rows["davis-moving"].is_present
    assert "JPEGImages" in rows["davis-moving"].problem
    assert rows["folder"].problem == f"no folder {data / 'folder'}"
    assert all(row.source and row.tree and row.ground_truth for row in rows.values())


def test_the_overview_works_without_any_data():
    present = [row.name for row in describe_datasets({}) if row.is_present]
    assert present == ["synthetic", "still"]
