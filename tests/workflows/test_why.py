"""`moseg store why` follows inputs down to the parameter that made a miss."""

import pytest


@pytest.fixture
def why(evaluated_copy, moseg):
    """Evaluates with another setting; returns the answer for the new artifact of a task."""
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


@pytest.mark.parametrize("task", ["proposals", "flow_residual", "score"])
def test_a_parameter_of_the_first_stages_is_named_from_every_task_above_it(why, task):
    answer = why(task, "saliency.floor=0.35")
    assert "  params.floor: 0.35 here, 0.3 there" in answer.splitlines()
