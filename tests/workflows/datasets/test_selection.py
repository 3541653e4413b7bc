import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.tasks.synthetic import SCENES
from moseg.workflows.datasets import open_dataset


@pytest.fixture
def davis16(tmp_path, write_sequence):
    """Return a root with two sequences of the official list and one outside it."""
    for name in ("dog", "cows", "bear"):
        trees = [tmp_path / tree / "480p" / name for tree in ("JPEGImages", "Annotations")]
        write_sequence(*trees, {0: 255}, num_frames=1)
    return str(tmp_path)


@pytest.fixture
def ytvos(tmp_path, write_sequence):
    for name in ("aa", "bb", "cc"):
        write_sequence(tmp_path / "JPEGImages" / name, tmp_path / "Annotations" / name, {0: 1}, num_frames=1)
    return tmp_path


def test_the_official_list_is_the_default_and_what_is_absent_is_named(davis16):
    dataset = open_dataset("davis16", davis16, max_side=100)
    assert dataset.names == ("cows", "dog")
    assert len(dataset.absent) == 18
    assert "blackswan" in dataset.absent
    assert "bear" not in dataset.names + dataset.absent


def test_sequences_outside_the_list_can_be_named(davis16):
    dataset = open_dataset("davis16", davis16, ("bear", "dog", "bear"), max_side=100)
    assert (dataset.names, dataset.absent) == (("bear", "dog"), ())


def test_a_named_sequence_of_the_list_may_be_absent(davis16):
    dataset = open_dataset("davis16", davis16, ("dog", "libby"), max_side=100)
    assert (dataset.names, dataset.absent) == (("dog",), ("libby",))


def test_letter_case_does_not_matter(davis16):
    assert open_dataset("davis16", davis16, ("Dog",), max_side=100).names == ("dog",)


def test_an_unknown_sequence_gets_the_nearest_name(davis16):
    with pytest.raises(InputError, match=r"unknown sequence of davis16 'dgo': did you mean 'dog'\?"):
        open_dataset("davis16", davis16, ("dgo",), max_side=100)
    with pytest.raises(InputError, match="did you mean 'dog'"):
        open_dataset("davis16", davis16, max_side=100).sequence("dgo")
    with pytest.raises(InputError, match="got 'zzzzzz'; expected one of"):
        open_dataset("davis16", davis16, ("zzzzzz",), max_side=100)


def test_an_unknown_data_set_gets_the_nearest_name():
    with pytest.raises(InputError, match=r"unknown data set 'davis-17': did you mean 'davis16'\?"):
        open_dataset("davis-17", max_side=100)


def test_nothing_left_to_run_is_an_error(davis16):
    with pytest.raises(MissingInputError, match=r"no sequence of davis16 .* 2 absent: libby, goat"):
        open_dataset("davis16", davis16, ("libby", "goat"), max_side=100)


def test_youtube_vos_needs_its_list(ytvos):
    with pytest.raises(MissingInputError, match=r"no list of sequences; expected .*moving_val\.txt"):
        open_dataset("ytvos-moving", str(ytvos), max_side=100)
    assert open_dataset("ytvos-moving", str(ytvos), ("bb",), max_side=100).names == ("bb",)
    (ytvos / "moving_val.txt").write_text("\ufeff# Dave et al.\nbb\n\naa  # a bird\nzz\nbb\n", encoding="utf-8")
    dataset = open_dataset("ytvos-moving", str(ytvos), max_side=100)
    assert (dataset.names, dataset.absent) == (("bb", "aa"), ("zz",))


def test_a_given_list_replaces_any_other(ytvos, davis16):
    path = ytvos / "mine.txt"
    path.write_text("cc\n")
    (ytvos / "moving_val.txt").write_text("aa\n")
    assert open_dataset("ytvos-moving", str(ytvos), None, str(path), max_side=100).names == ("cc",)
    path.write_text("bear\ndog")
    assert open_dataset("davis16", davis16, None, str(path), max_side=100).names == ("bear", "dog")


@pytest.mark.parametrize(("content", "what"), [(b"# none\n\n", "empty"), (b"\xff\xfe\x00a", "not text")])
def test_a_list_without_names_is_refused(ytvos, content, what):
    (ytvos / "moving_val.txt").write_bytes(content)
    with pytest.raises(InputError, match=what):
        open_dataset("ytvos-moving", str(ytvos), max_side=100)


def test_a_missing_list_is_named(ytvos):
    with pytest.raises(MissingInputError, match=r"gone\.txt"):
        open_dataset("ytvos-moving", str(ytvos), None, str(ytvos / "gone.txt"), max_side=100)


def test_all_scenes_are_the_default_of_synthetic():
    dataset = open_dataset("synthetic", max_side=100)
    assert dataset.names == tuple(SCENES)
    assert dataset.absent == ()
    assert dataset.root is None
