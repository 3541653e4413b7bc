"""`moseg store why` follows inputs down to the parameter that caused a miss."""

import pytest


@pytest.fixture
def why(evaluated_copy, moseg):
    """Return a function that evaluates with another setting and returns the answer for a task's new artifact."""
    store = ("--store", evaluated_copy.store)

    def ask(task, setting):
        before = moseg("store", "ls", "--task", task, *store).out.split()
        assert moseg(*evaluated_copy.arguments, *store, "--set", setting).code == 0
        new = set(moseg("store", "ls", "--task", task, *store).out.split()) - set(before)
        ran = moseg("store", "why", sorted(new)[0], *store)
        assert (ran.code, ran.err) == (0, "")
        return ran.out

    return ask


@pytest.mark.parametrize("task", ["affinity", "clustering", "segmentation", "score"])
def test_a_parameter_of_the_affinity_is_named_from_every_task_above_it(why, task):
    assert why(task, "affinity.scale=0.8").splitlines()[-1] == "  params.affinity.scale: 0.8 here, 0.5 there"


@pytest.mark.parametrize("task", ["proposals", "flow_residual", "segmentation", "score"])
def test_a_parameter_of_the_first_stages_is_named_from_every_task_above_it(why, task):
    """The section number, in which another section of the run differs as little, is not named."""
    answer = why(task, "saliency.floor=0.35")
    assert answer.splitlines()[-1] == "  params.floor: 0.35 here, 0.3 there"


def test_an_artifact_is_compared_with_that_of_the_same_sequence(write_squares, moseg, tmp_path):
    for seed, name in enumerate(("a", "b")):
        write_squares(tmp_path / "data" / name, num_frames=4, seed=seed)
    store = ("--store", tmp_path / "store")
    evaluate = ("eval", "--dataset", "folder", "--root", tmp_path / "data", "--quiet", *store)
    listing = ("store", "ls", "--task", "clustering", *store)
    assert moseg(*evaluate).code == 0
    before = moseg(*listing).out.split()
    assert moseg(*evaluate, "--set", "affinity.scale=0.8").code == 0
    for new in set(moseg(*listing).out.split()) - set(before):
        answer = moseg("store", "why", new, *store).out
        assert answer.splitlines()[-1] == "  params.affinity.scale: 0.8 here, 0.5 there"
