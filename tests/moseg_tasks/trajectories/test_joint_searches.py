"""Laws of searches that advance together."""

import numpy as np

from moseg.tasks.trajectories.groups import groups_of
from moseg.tasks.trajectories.joint_searches import Needed, run_together


def _search(name, num_steps):
    for step in range(num_steps):
        yield Needed(costs=[f"{name}{step}"])
    return name


def test_each_step_prepares_what_all_searches_need():
    prepared = []
    found = run_together([_search("a", 1), _search("b", 3), _search("c", 0)], lambda needed: prepared.append(needed))
    assert found == ["a", "b", "c"]
    assert [list(needed.costs) for needed in prepared] == [["a0", "b0"], ["b1"], ["b2"]]
    assert all(not needed.codes for needed in prepared)


def test_what_a_search_needs_is_prepared_before_it_goes_on():
    prepared = set()

    def search(name):
        yield Needed(codes=[name])
        return name in prepared

    assert run_together([search("a"), search("b")], lambda needed: prepared.update(needed.codes)) == [True, True]


def test_groups_are_those_of_the_labels_in_use():
    assert groups_of(np.array([3, 0, 3])).tolist() == [[False, True, False], [True, False, True]]
